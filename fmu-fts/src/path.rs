//! Tool path: from the surface or a file to a table that is interpolated in every sample.

pub mod correction;
pub mod depth_table;
pub mod feasibility;
pub mod fourier;
pub(crate) mod hermite;
pub mod kinematics;
pub mod path_file;
pub mod path_table;
pub mod section;
pub mod surface;
pub mod toric;
