//! Monitors of the machine: axes compared with the model of their loop, flicker of their measurements, delay of their
//! response, speed of the tool and its measurement, time of a task.

pub mod axis;
pub mod budget;
pub mod delay;
pub mod finding;
pub mod flicker;
pub mod frozen_spindle;
pub mod numbers;
pub mod rest;
pub mod tool;
pub mod watch;
