//! Texts among the parameters.

use serde::{Deserialize, Serialize};

/// Texts among the parameters.
#[derive(Clone, Serialize, Deserialize)]
pub struct Texts {
    /// Of the path.
    pub path: TextPath,
}

/// Texts of the path.
#[derive(Clone, Serialize, Deserialize)]
pub struct TextPath {
    /// CL file, in the folder `resources` of the FMU or with its whole path.
    pub file: String,
}

impl Texts {
    /// All empty; the start values are in the variable table of the FMU.
    pub const EMPTY: Self = Self { path: TextPath { file: String::new() } };
}
