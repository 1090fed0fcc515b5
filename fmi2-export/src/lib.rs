//! FMI 2.0 co-simulation export.
//!
//! One `const` table of [`Variable`]s per FMU gives get and set, start values, range checks,
//! `modelDescription.xml` and `documentation/index.html`. A wrong table does not compile.
//! A controller implements [`Model`] and calls [`export!`]; the shared library then exports the
//! whole C API of FMI 2.0.5 for co-simulation.
//!
//! ```
//! use fmi2_export::{Env, Error, Info, Model, Start, Variable, export, package, real, units};
//! use serde::{Deserialize, Serialize};
//!
//! #[derive(Clone, Serialize, Deserialize)]
//! struct Vars { position: f64, force: f64, stiffness: f64 }
//!
//! impl Start for Vars {
//!     const START: Self = Self { position: 0.0, force: 0.0, stiffness: 100.0 };
//! }
//!
//! struct Spring;
//!
//! impl Model for Spring {
//!     const INFO: Info = Info {
//!         name: "Spring", identifier: "spring", description: "A sampled spring",
//!         step_size: 1e-3, ..package!()
//!     };
//!     type Vars = Vars;
//!     type State = ();
//!     const VARIABLES: &'static [Variable<Vars>] = &[
//!         real!(Vars => position).input().unit(&units::METRE).display("mm").describe("Position"),
//!         real!(Vars => force).output().unit(&units::NEWTON).describe("Restoring force"),
//!         real!(Vars => stiffness).tunable().unit(&units::NEWTON_PER_METRE).range(0.0, 1e6).describe("Stiffness"),
//!     ];
//!     fn period(_: &Vars) -> f64 { 1e-3 }
//!     fn initialise(_: &mut Vars, _: &mut Env) -> Result<(), Error> { Ok(()) }
//!     fn tick(vars: &mut Vars, _: &mut (), _: &mut Env) -> Result<(), Error> {
//!         vars.force = -vars.stiffness * vars.position;
//!         Ok(())
//!     }
//! }
//!
//! export!(Spring);
//! # fn main() {}
//! ```
//!
//! All `unsafe` code is in [`c_api`] and `table::place`; every other module is safe Rust.
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
mod host;
mod instance;
mod model;
mod table;

pub use description::readme::{assert_readme, markdown};
pub use fmi2_export_macros::interface;
pub use model::{Env, Error, Info, Interface, Model, Start};
pub use serde;
#[doc(hidden)]
pub use table::check::variable as check_variable;
pub use table::enumeration::{EnumType, Enumeration, Item};
pub use table::units::{self, DisplayUnit, Unit};
pub use table::variable::Variable;

/// What the code that [`export!`] makes works with.
#[doc(hidden)]
pub mod __private {
    pub use crate::description::files::Files;
    pub use crate::export::Exported;
    pub use crate::table::guid::of as guid;
    pub use crate::table::index::{Entry, Index, computed, count, entries};

    /// Checks a model's table and facts; a wrong one does not compile.
    pub const fn check<M: crate::Model>() {
        crate::table::check::table(M::VARIABLES);
        crate::table::check::info(&M::INFO);
    }
}
