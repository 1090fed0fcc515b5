//! Native half of the MuJoCo plants: elements beyond MJCF, one per file.
//!
//! An [`Element`] is a small block of a block diagram: numbers in, numbers out, one call per plant step.
//! It knows neither MuJoCo nor Python. The module `python` (feature of the same name) connects inputs and outputs to
//! locations in numpy arrays.

#![deny(unsafe_code)]

mod circuit;
mod element;
pub mod elements;
#[allow(unsafe_code)]
mod place;
#[cfg(feature = "python")]
pub mod python;

pub use circuit::{Circuit, StepError};
pub use element::{Element, Ports};
pub use place::Place;
