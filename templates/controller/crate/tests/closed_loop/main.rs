//! The controller in closed loop with a slide: motion, laws, faults, hostile inputs, state bytes.

mod faults;
mod motion;
mod run;
mod state;
