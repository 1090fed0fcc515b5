//! What the FMU tells: new states, faults with their numbers, a table that leaves out too much.

use fmi2_export::{Enumeration, Env};

use crate::Vars;
use crate::feasibility::available_torque;
use crate::machine::{Fault, State};
use crate::parameters::Parameters;
use crate::signals::{Input, Output};

/// A table that leaves out more is told to the user, m.
const TRUNCATION_MAX: f64 = 1e-7;

/// One log line for a table with too few harmonics.
pub fn warn_of_truncation(vars: &Vars, env: &Env) {
    let (truncation, harmonics) = (vars.output.path.truncation, vars.parameters.path.harmonics);
    if truncation > TRUNCATION_MAX {
        env.warn(format_args!(
            "`path.harmonics` = `{harmonics}` leave out up to `{truncation:.1e} m` of the depth\nhint: take more harmonics, \
             or end the cut at a smaller `surface.outer_radius`"
        ));
    }
}

/// One log line for a new state.
pub fn tell_state(vars: &Vars, env: &Env) {
    let (Output { state, fault, .. }, p) = (&vars.output, &vars.parameters);
    match state {
        State::Fault => {
            let reason = meaning::<Fault>(*fault as usize);
            env.warn(format_args!("fault `{fault:?}`: {reason}{}", numbers(&vars.output, &vars.input, p)));
        }
        _ => env.event(format_args!("state `{state:?}`: {}", meaning::<State>(*state as usize))),
    }
}

/// The numbers behind a fault.
fn numbers(output: &Output, input: &Input, p: &Parameters) -> String {
    match output.fault {
        Fault::FollowingError => format!(" = `{} m`", p.limit.following_error),
        Fault::Infeasible => format!(
            ": needed `{:.3} N.m` at `{:.2} rad/s`, available `{:.3} N.m`\nhint: turn slower, or end the cut at a smaller \
             `surface.outer_radius`",
            output.path.torque,
            output.spindle_speed,
            available_torque(p)
        ),
        Fault::OutsideTable => format!(": `slide_position` = `{} m`", input.slide_position),
        Fault::InvalidInput => format!(
            ": `arm_angle` = `{} rad`, `spindle_angle` = `{} rad`, `slide_position` = `{} m`, `hold_angle` = `{} rad`",
            input.arm_angle, input.spindle_angle, input.slide_position, input.hold_angle
        ),
        Fault::None => String::new(),
    }
}

/// What the model description says about the item `number` of an enumeration.
fn meaning<E: Enumeration>(number: usize) -> &'static str {
    E::TYPE.items[number - 1].description
}
