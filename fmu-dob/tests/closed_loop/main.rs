//! The controller in closed loop with a slide: tracking, detection, noise, faults, the published control law, state
//! bytes.

mod calibration;
mod commission;
mod cycles;
mod detection;
mod drive;
mod faults;
mod gaps;
mod guard;
mod hostile;
mod law;
mod motion;
mod noise;
mod readings;
mod run;
mod slide;
mod state;
