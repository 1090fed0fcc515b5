//! A spring whose force is computed once in a sample period.

use fmi2_export::{Env, Error, Info, Model, Start, Variable, export, real, units};
use serde::{Deserialize, Serialize};

#[derive(Clone, Serialize, Deserialize)]
struct Vars {
    position: f64,
    force: f64,
    stiffness: f64,
}

impl Start for Vars {
    const START: Self = Self { position: 0.0, force: 0.0, stiffness: 100.0 };
}

struct Spring;

impl Model for Spring {
    const INFO: Info = Info { name: "Spring", identifier: "spring", description: "A sampled spring", ..Info::DEFAULT };
    type Vars = Vars;
    type State = ();
    const VARIABLES: &'static [Variable<Vars>] = &[
        real!(Vars => position).input().unit(&units::METRE).display("mm").describe("Position"),
        real!(Vars => force).output().unit(&units::NEWTON).describe("Restoring force"),
        real!(Vars => stiffness).tunable().unit(&units::NEWTON_PER_METRE).range(0.0, 1e6).describe("Stiffness"),
    ];

    fn period(_: &Vars) -> f64 {
        1e-3
    }

    fn initialise(_: &mut Vars, _: &mut Env) -> Result<(), Error> {
        Ok(())
    }

    fn tick(vars: &mut Vars, _: &mut (), _: &mut Env) -> Result<(), Error> {
        vars.force = -vars.stiffness * vars.position;
        Ok(())
    }
}

export!(Spring);
