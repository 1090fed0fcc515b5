//! Sensorless contact detection of a micro tool with a disturbance observer (Kakinuma and Nagakari, 2017), as an FMU.
//!
//! [`interface`] declares the variables; [`controller::Controller`] is the control law in plain Rust, independent of
//! FMI.
#![forbid(unsafe_code)]

mod calibration;
mod check;
mod commission;
pub mod controller;
mod detection;
mod faults;
mod force;
pub mod interface;
mod limits;
mod machine;
pub mod monitoring;
mod motion;
mod reading;
mod spans;

use controller::Controller;
use fmi2_export::{Env, Error, Info, Model, export, package};
use interface::Vars;

impl Model for Controller {
    // `longest_step` as measured: docs/communication-step.md
    const INFO: Info =
        Info { name: "DisturbanceObserverContactDetection", state_version: 17, longest_step: 1.0, ..package!() };
    type Vars = Vars;

    fn calculate(vars: &mut Vars) {
        vars.parameters.approach.depth_limit = motion::depth_limit::depth_limit(&vars.in_force);
    }

    fn numbers(vars: &Vars) -> String {
        faults::message::numbers(vars)
    }

    fn initialise(vars: &mut Vars, _: &mut Env) -> Result<Self, Error> {
        Ok(Self::new(&vars.in_force)?)
    }

    fn begin_long_step(&mut self) {
        self.begin_long_step();
    }

    fn sample(&mut self, vars: &mut Vars, env: &mut Env) -> Result<(), Error> {
        let before = [vars.output.measured.valid, vars.output.calibrated.valid];
        self.bring_into_force(&mut vars.in_force);
        self.tick(&vars.input, &vars.in_force, &mut vars.output);
        // a fault is reported with the parameters that are active from now on
        self.bring_into_force(&mut vars.in_force);
        // a machine does not stop because a file cannot be written
        if vars.output.measured.valid && !before[0] {
            self.export(&vars.in_force).unwrap_or_else(|error| env.warn(error));
        }
        if vars.output.calibrated.valid && !before[1] {
            self.export_bias(&vars.in_force).unwrap_or_else(|error| env.warn(error));
        }
        Ok(())
    }
}

export!(Controller);
