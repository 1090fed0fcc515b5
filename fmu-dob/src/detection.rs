//! From the force to a contact: detectors, their thresholds, and the force guard.

pub mod ages;
pub mod contact;
pub mod detector;
pub mod glr;
pub mod guard;
pub mod innovation;
pub mod kalman;
pub mod monitor;
pub mod threshold;
pub mod touch;
pub mod transition;
