//! Motion of the slide: its setpoint, its profiles, and following of the surface.

mod follow;
mod profile;
mod setpoint;

pub use follow::Follower;
pub use profile::duration;
pub use setpoint::Motion;
