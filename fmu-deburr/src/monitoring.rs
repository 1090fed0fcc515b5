//! Monitors of the machine: axes against the model of their loop, the flicker of their measurements, the delay of
//! their answers, the tool's speed and its measurement, the time of a task.

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
