//! Position loop: its design for the nominal arm, its frequency response, and what is added to its torque.

pub mod design;
pub mod dry_friction;
pub mod flexure;
pub mod lead_lag;
pub mod loop_model;
pub mod loop_response;
pub mod margins;
pub mod nominal;
pub mod response;
pub mod response_file;
