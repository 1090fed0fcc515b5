//! Variable-speed deburring robot with repetitive control (Kimura, Mukai and Kobayashi), as an FMU.
//!
//! [`interface`] holds every variable, [`controller::Controller`] is the control law: plain Rust that knows nothing of FMI.
#![forbid(unsafe_code)]

pub mod bank;
mod check;
mod commission;
pub mod controller;
mod faults;
mod fingerprint;
pub mod interface;
pub mod learning;
mod load;
mod machine;
pub mod monitoring;
pub mod path;
mod reading;
mod registration;
mod run;
mod servo;

use fmi2_export::{Env, Error, Info, Model, export, package};

use bank::storage;
use controller::Controller;
use interface::Vars;
use learning::speeds::Speeds;
use path::path_file;

impl Model for Controller {
    // `longest_step` as measured: docs/communication-step.md
    const INFO: Info = Info { name: "VariableSpeedDeburring", state_version: 16, longest_step: 1.0, ..package!() };
    type Vars = Vars;

    fn calculate(vars: &mut Vars) {
        // what cannot be read is reported by `initialise`
        if let Ok(speeds) = Speeds::read(&vars.in_force.learn.speeds) {
            vars.in_force.learn.factors = speeds;
        }
    }

    fn numbers(vars: &Vars) -> String {
        faults::numbers(vars)
    }

    fn initialise(vars: &mut Vars, env: &mut Env) -> Result<Self, Error> {
        let (p, output) = (&vars.in_force, &mut vars.output);
        Speeds::read(&p.learn.speeds)?;
        let mut controller = Self::new(p, path_file::read(p, env.resources())?)?;
        let (path, bank) = controller.path_and_bank();
        output.path.length = path.length();
        output.bank = storage::start(p, env.resources(), path, bank)?;
        Ok(controller)
    }

    fn begin_long_step(&mut self) {
        self.begin_long_step();
    }

    fn sample(&mut self, vars: &mut Vars, env: &mut Env) -> Result<(), Error> {
        let before = vars.output.measured.valid;
        self.bring_into_force(&mut vars.in_force);
        self.tick(&vars.input, &vars.in_force, &mut vars.output);
        // a fault is reported with what counts from now on
        self.bring_into_force(&mut vars.in_force);
        if vars.output.measured.valid && !before {
            // a machine does not stop because a file cannot be written
            self.export(&vars.in_force).unwrap_or_else(|error| env.warn(error));
        }
        if self.take_export() {
            let bank = &mut vars.output.bank;
            let programmed = self.programmed_bank(&vars.in_force);
            let written = storage::export(&vars.in_force, self.path(), &programmed, bank);
            if written { env.event(&bank.message) } else { env.warn(&bank.message) }
        }
        Ok(())
    }
}

export!(Controller);
