//! Moves a slide to a target and holds its position, as an FMU.
//!
//! [`interface`] holds the variables; [`controller::Controller`] is the control law in pure Rust, without FMI.
#![forbid(unsafe_code)]

mod check;
pub mod controller;
mod faults;
pub mod interface;
mod machine;
mod motion;
mod reading;
mod servo;

use fmi2_export::{Env, Error, Info, Model, export, package};

use controller::Controller;
use interface::Vars;

impl Model for Controller {
    const INFO: Info = Info {
        name: "__Name__",
        // raise it when variables or saved state change their meaning
        state_version: 1,
        stop_time: 2.0,
        ..package!()
    };
    type Vars = Vars;

    fn numbers(vars: &Vars) -> String {
        faults::numbers(vars)
    }

    fn initialise(vars: &mut Vars, _: &mut Env) -> Result<Self, Error> {
        Ok(Self::new(&vars.in_force)?)
    }

    fn sample(&mut self, vars: &mut Vars, _: &mut Env) -> Result<(), Error> {
        self.tick(&vars.input, &vars.in_force, &mut vars.output);
        Ok(())
    }
}

export!(Controller);
