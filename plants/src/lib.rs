//! Native half of the MuJoCo plants: what MJCF cannot say, one element per file.
//!
//! An [`Element`] is a small block of a block diagram: numbers in, numbers out, one call per plant step.
//! It knows neither MuJoCo nor Python. The `binding` module (feature `extension-module`) ties inputs and
//! outputs to places inside numpy arrays and holds all the unsafe code of the crate.

#![deny(unsafe_code)]

mod coloured_noise;
mod current_loop;
mod element;
mod flute;
mod harmonics;
mod integrator;
mod latch;
mod peak;
mod product;
mod rotation;
mod slew;
mod sum;
mod thrust;
mod turned_part;

#[cfg(feature = "extension-module")]
#[allow(unsafe_code)]
mod binding;
#[cfg(feature = "extension-module")]
mod module;

pub use coloured_noise::ColouredNoise;
pub use current_loop::CurrentLoop;
pub use element::{Element, Ports};
pub use flute::Flute;
pub use harmonics::Harmonics;
pub use integrator::Integrator;
pub use latch::Latch;
pub use peak::Peak;
pub use product::Product;
pub use rotation::Rotation;
pub use slew::Slew;
pub use sum::Sum;
pub use thrust::Thrust;
pub use turned_part::{Shapes, TurnedPart};
