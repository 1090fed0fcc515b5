//! Dry friction: of parts on a table, and of screws and guides.

mod bristle;
mod foot;
mod rolling_friction;
mod stribeck;

pub use bristle::Bristle;
pub use foot::Foot;
pub use rolling_friction::RollingFriction;
pub use stribeck::Stribeck;
