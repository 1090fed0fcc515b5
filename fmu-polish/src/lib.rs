//! Force and position control with stick-slip motion for polishing molds (Nagata and others, 2010), as an FMU.
//!
//! [`interface`] holds the variables of the FMU, [`controller::Controller`] the control law: plain Rust without FMI.
#![forbid(unsafe_code)]

pub mod axes;
mod check;
mod commission;
pub mod controller;
mod faults;
mod force;
pub mod interface;
mod machine;
mod monitoring;
mod motion;
pub mod path;
mod reading;

use fmi2_export::{Env, Error, Info, Model, export, package};

use controller::Controller;
use interface::Vars;

impl Model for Controller {
    // `longest_step` as measured: docs/communication-step.md
    const INFO: Info = Info { name: "StickSlipPolishing", state_version: 11, longest_step: 1.0, ..package!() };
    type Vars = Vars;

    fn numbers(vars: &Vars) -> String {
        faults::numbers(vars)
    }

    fn initialise(vars: &mut Vars, env: &mut Env) -> Result<Self, Error> {
        let points = path::cl_file::read(env.resources(), &vars.in_force)?;
        let controller = Self::new(&vars.in_force, &points)?;
        vars.output.path_length = controller.path().length();
        Ok(controller)
    }

    fn begin_long_step(&mut self) {
        self.begin_long_step();
    }

    fn sample(&mut self, vars: &mut Vars, env: &mut Env) -> Result<(), Error> {
        let (frozen, before) = (vars.output.ripple_stopped, vars.output.measured.valid);
        self.bring_into_force(&mut vars.in_force);
        self.tick(&vars.input, &vars.in_force, &mut vars.output);
        // a fault message uses the values that are valid from now on
        self.bring_into_force(&mut vars.in_force);
        if vars.output.measured.valid && !before {
            // a machine does not stop because a file cannot be written
            self.export(&vars.in_force).unwrap_or_else(|error| env.warn(error));
        }
        if vars.output.ripple_stopped && !frozen {
            env.warn(force::ripple::STOPPED);
        }
        Ok(())
    }
}

export!(Controller);
