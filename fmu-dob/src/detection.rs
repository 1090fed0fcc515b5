//! From the force to a contact: detectors, their thresholds, and the guard beside them.

pub mod ages;
pub mod contact;
pub mod cusum;
pub mod detector;
pub mod glr;
pub mod guard;
pub mod innovation;
pub mod kalman;
pub mod monitor;
pub mod threshold;
pub mod touch;
pub mod transition;
