//! Native half of the MuJoCo plants: what MJCF cannot say, one element per file.
//!
//! An [`Element`] is a small block of a block diagram: numbers in, numbers out, one call per plant step.
//! It knows neither MuJoCo nor Python. The `binding` module (feature `extension-module`) ties inputs and
//! outputs to places inside numpy arrays.

#![deny(unsafe_code)]

#[cfg(feature = "extension-module")]
#[allow(unsafe_code)]
mod binding;
mod circuit;
mod element;
pub mod elements;
#[allow(unsafe_code)]
mod place;
#[allow(unsafe_code)]
pub mod stepper;

pub use circuit::{Circuit, StepError};
pub use element::{Element, Ports};
pub use place::Place;
