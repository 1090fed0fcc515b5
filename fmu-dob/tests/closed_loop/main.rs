//! The controller in closed loop with a slide: tracking, detection, noise, faults, the paper's law, state bytes.

mod commission;
mod detection;
mod faults;
mod guard;
mod hostile;
mod law;
mod motion;
mod noise;
mod readings;
mod run;
mod slide;
mod state;
