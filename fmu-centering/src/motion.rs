//! Motion of the slide - its setpoint, its profiles, following of the surface - and speed of the table.

mod follow;
mod profile;
mod setpoint;
mod table;

pub use follow::Follower;
pub use profile::duration;
pub use setpoint::Motion;
pub use table::{TOLERANCE, Table};
