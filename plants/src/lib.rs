//! Native half of the MuJoCo plants: what MJCF cannot say, one element per file.
//!
//! An [`Element`] is a small block of a block diagram: numbers in, numbers out, one call per plant step.
//! It knows neither MuJoCo nor Python. The `binding` module (feature `extension-module`) ties inputs and
//! outputs to places inside numpy arrays.

#![deny(unsafe_code)]

mod bristle;
mod burr;
mod circuit;
mod coloured_noise;
mod current_loop;
mod deburring;
mod edge;
mod element;
mod flute;
mod foot;
mod harmonics;
mod induction_spindle;
mod integrator;
mod latch;
mod limit;
mod lookup;
mod low_pass;
mod milling;
mod mold;
mod motion_board;
mod outline;
mod peak;
#[allow(unsafe_code)]
mod place;
mod product;
mod pulse_drive;
mod rolling_friction;
mod rotation;
mod rubbing;
mod slew;
#[allow(unsafe_code)]
pub mod stepper;
mod stribeck;
mod sum;
mod tangent_plane;
mod thrust;
mod tip;
mod turned_part;
mod turntable;
mod wear;
mod wrench;

#[cfg(feature = "extension-module")]
#[allow(unsafe_code)]
mod binding;
#[cfg(feature = "extension-module")]
mod module;
#[cfg(feature = "extension-module")]
#[allow(unsafe_code)]
mod stepper_binding;
#[cfg(feature = "extension-module")]
#[allow(unsafe_code)]
mod stepper_exports;
#[cfg(feature = "extension-module")]
mod stepper_rows;

pub use bristle::Bristle;
pub use burr::Burr;
pub use circuit::{Circuit, StepError};
pub use coloured_noise::ColouredNoise;
pub use current_loop::CurrentLoop;
pub use deburring::{Deburring, Reaction};
pub use edge::{Clearance, Edge};
pub use element::{Element, Ports};
pub use flute::Flute;
pub use foot::Foot;
pub use harmonics::Harmonics;
pub use induction_spindle::{InductionSpindle, Plate};
pub use integrator::Integrator;
pub use latch::Latch;
pub use limit::Limit;
pub use lookup::Lookup;
pub use low_pass::LowPass;
pub use milling::Milling;
pub use mold::{Dimple, Local, Mold, Step};
pub use motion_board::MotionBoard;
pub use outline::Outline;
pub use peak::Peak;
pub use place::Place;
pub use product::Product;
pub use pulse_drive::{DriveGains, PulseDrive};
pub use rolling_friction::RollingFriction;
pub use rotation::Rotation;
pub use rubbing::Rubbing;
pub use slew::Slew;
pub use stribeck::Stribeck;
pub use sum::Sum;
pub use tangent_plane::{Pose, TangentPlane};
pub use thrust::Thrust;
pub use tip::Tip;
pub use turned_part::{Shapes, TurnedPart};
pub use turntable::Turntable;
pub use wear::{Abrasion, HeightMap, Stroke};
pub use wrench::Wrench;
