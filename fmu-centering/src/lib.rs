//! Centring of a ring on a rotating table by pushes of a slide with a probe (Mears et al., 2007), as an FMU.
//!
//! This file is the FMU. Its variables are in [`interface`]; [`controller::Controller`] is the law, plain Rust that knows
//! nothing of FMI.
#![forbid(unsafe_code)]

mod centre;
mod check;
pub mod controller;
mod faults;
pub mod interface;
mod law;
mod limits;
mod machine;
mod motion;
mod paper;
mod predictive;
mod sensing;
mod sine_fit;

use control_blocks::ParameterError;
use fmi2_export::{Env, Error, Info, Model, export, package};

use controller::Controller;
use interface::Vars;

/// The FMU.
pub struct Centering;

impl Model for Centering {
    const INFO: Info = Info {
        name: "RingCentering",
        identifier: "fmu_centering",
        description: "Centres a ring on a rotating table by pushes of a slide with a probe (Mears et al., Design of \
                      a Flexible Centering Tooling System, 2007)",
        state_version: 2,
        stop_time: 60.0,
        step_size: 1e-3,
        ..package!()
    };
    type Vars = Vars;
    type State = Controller;
    const NUMBERS: fn(&Vars) -> String = faults::numbers;

    fn period(vars: &Vars) -> f64 {
        vars.parameters.sample_period
    }

    fn calculate(vars: &mut Vars) {
        vars.parameters.approach.look_ahead = limits::look_ahead(&vars.in_force);
    }

    fn initialise(vars: &mut Vars, _: &mut Env) -> Result<Controller, Error> {
        Controller::new(&vars.in_force).map_err(|error: ParameterError| error.to_string().into())
    }

    fn tick(vars: &mut Vars, controller: &mut Controller, _: &mut Env) -> Result<(), Error> {
        controller.tick(&vars.input, &vars.in_force, &mut vars.output);
        Ok(())
    }
}

export!(Centering);
