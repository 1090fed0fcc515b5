//! The smallest FMU: its output is its input, sampled once in a period.

use fmi2_export::{Env, Error, Info, Model, Start, Variable, export, package, real};
use serde::{Deserialize, Serialize};

#[derive(Clone, Serialize, Deserialize)]
struct Vars {
    u: f64,
    y: f64,
}

impl Start for Vars {
    const START: Self = Self { u: 0.0, y: 0.0 };
}

struct PassThrough;

impl Model for PassThrough {
    const INFO: Info = Info {
        name: "PassThrough",
        identifier: "pass_through",
        description: "Gives its sampled input back",
        ..package!()
    };
    type Vars = Vars;
    type State = ();
    const VARIABLES: &'static [Variable<Vars>] =
        &[real!(Vars => u).input().describe("Input"), real!(Vars => y).output().describe("Input at the last sample")];

    fn period(_: &Vars) -> f64 {
        1e-3
    }

    fn initialise(_: &mut Vars, _: &mut Env) -> Result<(), Error> {
        Ok(())
    }

    fn tick(vars: &mut Vars, _: &mut (), _: &mut Env) -> Result<(), Error> {
        vars.y = vars.u;
        Ok(())
    }
}

export!(PassThrough);
