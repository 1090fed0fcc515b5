//! Centering of a ring on a rotating table by pushes of a slide with a probe (Mears et al., 2007), as an FMU.
//!
//! This file is the FMU. Its variables are in [`interface`]; [`controller::Controller`] is the controller in plain Rust,
//! independent of FMI.
#![forbid(unsafe_code)]

mod center;
mod check;
mod commission;
pub mod controller;
mod faults;
pub mod interface;
mod law;
mod limits;
mod machine;
mod monitoring;
mod motion;
mod paper;
mod predictive;
mod sensing;
mod sine_fit;

use fmi2_export::{Env, Error, Info, Model, export, package};

use controller::Controller;
use interface::Vars;

impl Model for Controller {
    // `longest_step` as measured: docs/communication-step.md
    const INFO: Info = Info { name: "RingCentering", state_version: 13, longest_step: 1.0, ..package!() };
    type Vars = Vars;

    fn numbers(vars: &Vars) -> String {
        faults::numbers(vars)
    }

    fn initialise(vars: &mut Vars, _: &mut Env) -> Result<Self, Error> {
        Ok(Self::new(&vars.in_force)?)
    }

    fn begin_long_step(&mut self) {
        self.begin_long_step();
    }

    fn sample(&mut self, vars: &mut Vars, env: &mut Env) -> Result<(), Error> {
        let before = self.commissioned();
        self.bring_into_force(&mut vars.in_force);
        self.tick(&vars.input, &vars.in_force, &mut vars.output);
        // a fault is logged with the values that are active from now on
        self.bring_into_force(&mut vars.in_force);
        if self.commissioned() && !before {
            // a file that cannot be written must not stop the machine
            self.export(&vars.in_force).unwrap_or_else(|error| env.warn(error));
        }
        Ok(())
    }
}

export!(Controller);
