//! What the FMU tells: new states, and faults with their numbers.

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

/// The numbers behind a fault.
fn numbers(vars: &Vars) -> String {
    let Vars { input, output, parameters: p, .. } = vars;
    match output.fault {
        Fault::InvalidInput => format!(
            ": positions `{:?}`, `spindle_speed` = `{} rad/s`, `speed_override` = `{}`",
            input.positions(),
            input.spindle_speed,
            input.speed_override
        ),
        Fault::ControlError => {
            let axes = output.axes().into_iter().zip(p.axes()).enumerate();
            let strayed = axes.filter(|(_, (axis, limits))| axis.error.abs() > limits.error_max);
            let told = strayed.map(|(i, (axis, limits))| {
                format!(": `axis{}.error` = `{:.6}`, limit `{}`", i + 1, axis.error, limits.error_max)
            });
            told.collect::<String>() + "\nhint: is the drive on, and is `axisN.pulse` that of the encoder?"
        }
        Fault::PatternTooLarge => {
            format!(": limit `{} pulses`\nhint: a larger pulse, or a law that converges", p.learn.pulses_max)
        }
        Fault::BankEmpty => "\nhint: learn, name a `bank.import`, or switch `lookup.enable` off".to_owned(),
        Fault::SpindleSlow => format!(
            ": `spindle_speed` = `{:.1} rad/s`, limit `{:.1} rad/s`\nhint: start the tool before, or lower the taught speed",
            input.spindle_speed, p.spindle.speed_min
        ),
        Fault::None => String::new(),
    }
}

/// What the model description says about the item `number` of an enumeration.
fn meaning<E: Enumeration>(number: usize) -> &'static str {
    E::TYPE.items[number - 1].description
}
