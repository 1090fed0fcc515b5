//! The path: as programmed, where the axes are on it, and the motions along it and to it.

pub(crate) mod displacement;
pub(crate) mod feasible;
pub(crate) mod feed;
pub(crate) mod geometry;
pub(crate) mod kinematics;
pub mod path_file;
pub(crate) mod programmed_path;
pub(crate) mod route;
pub(crate) mod touch;
pub(crate) mod transfer;

pub use feed::Point;
pub use geometry::{Block, Pose, Vector};
pub use kinematics::{AXES, Joints};
pub use programmed_path::{CORNER, ProgrammedPath};
pub use touch::Touch;
