//! Motors, amplifiers and axes with their own servo.

mod current_loop;
mod induction_spindle;
mod motion_board;
mod pulse_drive;
mod rotation;
mod thrust;

pub use current_loop::CurrentLoop;
pub use induction_spindle::{InductionSpindle, RatingPlate};
pub use motion_board::MotionBoard;
pub use pulse_drive::{DriveGains, PulseDrive};
pub use rotation::Rotation;
pub use thrust::Thrust;
