//! The controller in closed loop with a slide: motion, control laws, faults, hostile inputs, saved states.

mod faults;
mod motion;
mod run;
mod state;
