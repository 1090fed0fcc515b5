//! FMI 2.0 export, for co-simulation and model exchange.
//!
//! One declaration of the variables, a module of plain structs with the attribute [`interface`](macro@interface), generates
//! get and set, start values, range checks, `modelDescription.xml`, `documentation/index.html` and tables of Markdown pages.
//! A wrong declaration does not compile. A controller implements [`Model`] and calls [`export!`]; the shared library then
//! exports the whole C API of FMI 2.0.5, for co-simulation and for model exchange.
//!
//! ```
//! use fmi2_export::serde::{Deserialize, Serialize};
//! use fmi2_export::{Env, Error, Info, Model, export, package};
//! use variables::Vars;
//!
//! #[fmi2_export::interface]
//! mod variables {
//!     use fmi2_export::units::{METRE, NEWTON, NEWTON_PER_METRE};
//!
//!     #[inputs]
//!     pub struct Input {
//!         /// Position
//!         #[var(unit = METRE as "mm")]
//!         pub position: f64,
//!     }
//!
//!     #[outputs]
//!     pub struct Output {
//!         /// Restoring force
//!         #[var(unit = NEWTON)]
//!         pub force: f64,
//!     }
//!
//!     #[parameters]
//!     pub struct Parameters {
//!         /// Stiffness
//!         #[var(unit = NEWTON_PER_METRE, range = 0.0..=1e6, start = 100.0, tunable)]
//!         pub stiffness: f64,
//!     }
//! }
//!
//! #[derive(Clone, Serialize, Deserialize)]
//! #[serde(crate = "fmi2_export::serde")]
//! struct Spring;
//!
//! impl Model for Spring {
//!     const INFO: Info = Info { name: "Spring", description: "A sampled spring", ..package!() };
//!     type Vars = Vars;
//!
//!     fn initialise(_: &mut Vars, _: &mut Env) -> Result<Self, Error> {
//!         Ok(Self)
//!     }
//!
//!     fn sample(&mut self, vars: &mut Vars, _: &mut Env) -> Result<(), Error> {
//!         vars.output.force = -vars.parameters.stiffness * vars.input.position;
//!         Ok(())
//!     }
//! }
//!
//! export!(Spring);
//! # fn main() {}
//! ```
//!
//! The fields of the model are its state between samples, so it derives [`serde`]'s traits:
//! `#[serde(crate = "fmi2_export::serde")]` saves the dependency.
//!
//! All `unsafe` code is in [`c_api`], `table::place` and what [`export!`] and [`interface`](macro@interface) make;
//! every other module is safe Rust.
//!
//! Timing: the model ticks at `start + n * period`. A communication step `[t, t + h)` runs every
//! tick that lies in it, with the inputs set at `t`; outputs are held between ticks.
#![deny(unsafe_code)]

#[cfg(panic = "abort")]
compile_error!(
    "an FMU catches the panics of its model: with `panic = \"abort\"` one would end the importer\n\
     hint: remove `panic = \"abort\"` from the profile in `Cargo.toml`"
);

pub mod c_api;
mod description;
mod export;
mod exported;
mod host;
mod instance;
mod model;
mod table;

pub use description::pages::assert_pages;
pub use fmi2_export_macros::interface;
pub use model::{Env, Error, Info, Interface, Model, Report};
pub use serde;
#[doc(hidden)]
pub use table::check::variable as check_variable;
pub use table::enumeration::{EnumType, Enumeration, Item, Reaction};
pub use table::units::{self, DisplayUnit, Unit};
pub use table::variable::Variable;

/// Items that the code made by [`export!`] uses.
#[doc(hidden)]
pub mod __private {
    pub use crate::description::files::Files;
    pub use crate::exported::Exported;
    pub use crate::table::guid::of as guid;
    pub use crate::table::index::{Entry, Index, computed, count, entries, reference, runs, without_texts};
    pub use crate::table::place::Run;
    pub use crate::table::variable::HAS_FILES;

    /// Checks a model's table and facts; a wrong one does not compile.
    pub const fn check<M: crate::Model>() {
        crate::table::check::table(<M::Vars as crate::Interface>::TABLE);
        crate::table::check::info(&M::INFO);
    }
}
