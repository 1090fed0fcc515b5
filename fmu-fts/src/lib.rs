//! Rotary fast tool servo that turns toric lenses (Ludwick, Chargin, Calzaretta and Trumper, 1999), as an FMU.
//!
//! This file is the FMU: its facts and the calls into the control law. [`controller::Controller`] is the control law,
//! plain Rust that knows nothing of FMI; [`interface`] holds every variable.
#![forbid(unsafe_code)]

pub mod calibration;
mod check;
mod commission;
pub mod controller;
mod faults;
mod identify;
pub mod interface;
pub mod lists;
mod machine;
mod monitoring;
mod motion;
pub mod path;
mod reading;
pub mod servo;
pub mod texts;
pub mod tracking;

use fmi2_export::{Env, Error, Info, Model, export, package};

use controller::Controller;
use interface::Vars;
use texts::Tables;

impl Model for Controller {
    // `longest_step` as measured: docs/communication-step.md
    const INFO: Info = Info { name: "RotaryFastToolServo", state_version: 14, longest_step: 1.0, ..package!() };
    type Vars = Vars;

    fn calculate(vars: &mut Vars) {
        if vars.in_force.read_lists().is_ok() {
            vars.parameters.identify.duration = identify::experiment::duration(&vars.in_force);
        }
    }

    fn numbers(vars: &Vars) -> String {
        faults::numbers(vars)
    }

    fn initialise(vars: &mut Vars, env: &mut Env) -> Result<Self, Error> {
        vars.in_force.read_lists()?;
        let tables = Tables::read(&vars.in_force, env.resources())?;
        let controller = Self::new(&vars.in_force, &tables)?;
        vars.output.path_truncation = controller.truncation();
        faults::truncation(vars).into_iter().for_each(|warning| env.warn(warning));
        Ok(controller)
    }

    fn begin_long_step(&mut self) {
        self.begin_long_step();
    }

    fn sample(&mut self, vars: &mut Vars, env: &mut Env) -> Result<(), Error> {
        let before = vars.output.measured.valid;
        self.bring_into_force(&mut vars.in_force);
        self.tick(&vars.input, &vars.in_force, &mut vars.output);
        // a fault message shows the parameters that are active from now on
        self.bring_into_force(&mut vars.in_force);
        if vars.output.measured.valid && !before {
            // a machine does not stop because a file cannot be written
            self.export(&vars.in_force).unwrap_or_else(|error| env.warn(error));
        }
        if self.lens_fitted() {
            faults::form(vars, self.corrects(&vars.in_force)).into_iter().for_each(|warning| env.warn(warning));
        }
        Ok(())
    }
}

export!(Controller);
