//! Polishing: molds as surfaces, a ball that touches them, and its wear.

mod mold;
mod rubbing;
mod tangent_plane;
mod wear;

pub use mold::{Dimple, Local, Mold, Step};
pub use rubbing::Rubbing;
pub use tangent_plane::{Pose, TangentPlane};
pub use wear::{Abrasion, HeightMap, Stroke};
