//! Calibration of the contact bias: travel between first touch and detection as a function of the speed.

pub mod bias;
pub mod press;
pub mod run;
pub mod series;
pub mod spread;
