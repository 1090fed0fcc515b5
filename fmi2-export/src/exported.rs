//! A model as a library exports it: with the constants that are made of its table.

use crate::model::Model;
use crate::table::hash::GUID;
use crate::table::index::Index;

/// A model with the constants that [`export!`](crate::export) makes of its table; every library holds one.
pub trait Exported: Model {
    /// The value references.
    const INDEX: Index<Self::Vars>;
    /// GUID of the model description.
    const GUID: [u8; GUID];

    /// The GUID as a text.
    fn guid() -> &'static str {
        str::from_utf8(const { &Self::GUID }).expect("a GUID is hexadecimal")
    }
}
