//! A spring whose force is computed once per sample period.

use fmi2_export::serde::{Deserialize, Serialize};
use fmi2_export::{Env, Error, Info, Model, export, package};
use variables::Vars;

#[fmi2_export::interface]
mod variables {
    use fmi2_export::units::{METRE, NEWTON, NEWTON_PER_METRE};

    #[inputs]
    pub struct Input {
        /// Position
        #[var(unit = METRE as "mm")]
        pub position: f64,
    }

    #[outputs]
    pub struct Output {
        /// Restoring force
        #[var(unit = NEWTON)]
        pub force: f64,
    }

    #[parameters]
    pub struct Parameters {
        /// Stiffness
        #[var(unit = NEWTON_PER_METRE, range = 0.0..=1e6, start = 100.0, tunable)]
        pub stiffness: f64,
    }
}

#[derive(Clone, Serialize, Deserialize)]
#[serde(crate = "fmi2_export::serde")]
struct Spring;

impl Model for Spring {
    const INFO: Info = Info { name: "Spring", identifier: "spring", description: "A sampled spring", ..package!() };
    type Vars = Vars;

    fn initialise(_: &mut Vars, _: &mut Env) -> Result<Self, Error> {
        Ok(Self)
    }

    fn sample(&mut self, vars: &mut Vars, _: &mut Env) -> Result<(), Error> {
        vars.output.force = -vars.parameters.stiffness * vars.input.position;
        Ok(())
    }
}

export!(Spring);
