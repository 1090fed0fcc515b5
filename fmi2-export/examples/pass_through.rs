//! The smallest FMU: its output is its input, sampled once in a period.

use fmi2_export::serde::{Deserialize, Serialize};
use fmi2_export::{Env, Error, Info, Model, export, package};
use variables::Vars;

#[fmi2_export::interface]
mod variables {
    #[inputs]
    pub struct Input {
        /// Input
        pub u: f64,
    }

    #[outputs]
    pub struct Output {
        /// Input at the last sample
        pub y: f64,
    }
}

#[derive(Clone, Serialize, Deserialize)]
#[serde(crate = "fmi2_export::serde")]
struct PassThrough;

impl Model for PassThrough {
    const INFO: Info = Info { name: "PassThrough", description: "Gives its sampled input back", ..package!() };
    type Vars = Vars;

    fn initialise(_: &mut Vars, _: &mut Env) -> Result<Self, Error> {
        Ok(Self)
    }

    fn sample(&mut self, vars: &mut Vars, _: &mut Env) -> Result<(), Error> {
        vars.output.y = vars.input.u;
        Ok(())
    }
}

export!(PassThrough);
