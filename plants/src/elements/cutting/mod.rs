//! Cutting: edges of tools, burrs along edges, parts on a lathe.

mod burr;
mod chip;
mod deburring;
mod edge;
mod flute;
mod milling;
mod plunge;
mod touch_probe;
mod turned_part;

pub use burr::Burr;
pub use chip::Chip;
pub use deburring::{Deburring, Reaction};
pub use edge::{Clearance, Edge};
pub use flute::Flute;
pub use milling::Milling;
pub use plunge::Plunge;
pub use touch_probe::TouchProbe;
pub use turned_part::{Shapes, TurnedPart};
