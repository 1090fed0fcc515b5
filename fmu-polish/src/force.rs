//! The force: measured, watched, and controlled by everything that moves the tool along the normal.

pub mod contact;
pub mod harmonic;
pub mod impedance;
pub mod margin;
pub mod misalignment;
pub mod normal_motion;
pub mod orientation;
pub mod repetitive;
pub mod response;
pub mod ripple;
pub mod sensor;
pub mod stiffness;
pub mod turning;
