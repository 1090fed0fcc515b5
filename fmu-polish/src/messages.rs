//! What the FMU tells: new states, faults with their numbers, a cancellation that has ended.

use fmi2_export::{Enumeration, Env};

use crate::Vars;
use crate::machine::{Fault, State};

/// One log line for a new state.
pub fn tell_state(vars: &Vars, env: &Env) {
    let (state, fault) = (vars.output.state, vars.output.fault);
    match state {
        State::Fault => {
            let reason = meaning::<Fault>(fault as usize);
            env.warn(format_args!("fault `{fault:?}`: {reason}{}", numbers(vars)));
        }
        _ => env.event(format_args!("state `{state:?}`: {}", meaning::<State>(state as usize))),
    }
}

/// One log line when the cancellation of the ripple has ended itself.
pub fn tell_frozen(env: &Env) {
    env.warn(
        "a part of the ripple cancellation made it worse and has ended\nhint: make `drive` that of the machine, \
         or set `ripple.gain` = 0",
    );
}

/// The numbers behind a fault.
fn numbers(vars: &Vars) -> String {
    let (input, output, limits) = (&vars.input, &vars.output, &vars.parameters.limits);
    let (x, f) = (input.position, input.force);
    match output.fault {
        Fault::None | Fault::EmergencyStop => String::new(),
        Fault::ForceLimit => format!(
            " = `{} N`, it is `{:.2} N` at `{:.3}` of the path",
            limits.force, output.force.measured, output.progress
        ),
        Fault::SettleTimeout => {
            format!(" = `{} s`: error `{:.2} N`", vars.parameters.settle.time_max, output.force.error)
        }
        Fault::LostContact => format!(" at `{:.3}` of the path: `{:.2} N`", output.progress, output.force.measured),
        Fault::InvalidInput => format!(": position `{} {} {} m`, force `{} {} {} N`", x.x, x.y, x.z, f.x, f.y, f.z),
        Fault::InvalidPath => format!(
            " at `{:.3}` of the path, by more than `limits.force_angle` = `{} rad`",
            output.progress, limits.force_angle
        ),
        Fault::ApproachTimeout => format!(" = `{} m`", vars.parameters.approach.distance_max),
        Fault::PositionError => {
            format!(": `{:.6} m` along, `{:.6} m` beside", output.error.tangential, output.error.lateral)
        }
        Fault::Stroke => format!(": position `{} {} {} m`", x.x, x.y, x.z),
        Fault::TareRejected => format!(": raw force `{} {} {} N`\nhint: lift the tool before `enable`", f.x, f.y, f.z),
        Fault::NotAtStart => format!(
            ": `{:.6} m` above it, `{:.6} m` and `{:.6} m` beside\nhint: move there before `enable`",
            -output.error.normal, output.error.tangential, output.error.lateral
        ),
        Fault::SurfaceError => format!(" = `{} m` at `{:.3}` of the path", limits.surface_error, output.progress),
    }
}

/// What the model description says about the item `number` of an enumeration.
fn meaning<E: Enumeration>(number: usize) -> &'static str {
    E::TYPE.items[number - 1].description
}
