//! What is told with a fault: what was judged, and its limit.

use control_blocks::DELAY_MAX;

use crate::check::check;
use crate::commission::response::GUIDES;
use crate::commission::values::{Values, acceptable};
use crate::interface::{Fault, Measured, Parameters, Vars};
use crate::monitoring::numbers::Numbers;

/// The numbers behind the fault, to be told after its meaning.
pub fn numbers(vars: &Vars) -> String {
    let (output, p) = (&vars.output, &vars.in_force);
    let (x, f, force, error) = (vars.input.position, vars.input.force, output.force, output.error);
    let n: Numbers = output.numbers;
    let place = format!("at `{:.3}` of the path", output.progress);
    let (position, raw) = (format!("`{} {} {} m`", x.x, x.y, x.z), format!("`{} {} {} N`", f.x, f.y, f.z));
    let row = p.limits.lost_samples;
    match output.fault {
        Fault::None | Fault::EmergencyStop => String::new(),
        Fault::ForceLimit => format!(" = `{} N` {place}: `{:.2} N`", p.limits.force, n.norm),
        Fault::SettleTimeout => {
            format!(" = `{} s`: `{:.2} N` of `{} N`", p.settle.time_max, force.measured, p.force.target)
        }
        Fault::LostContact => format!(" {place}: `{:.2} N` of `{} N`", force.measured, p.limits.lost_force),
        Fault::InvalidInput => {
            let (feed, force) = (vars.input.feed_override, vars.input.force_override);
            format!(" = `{row}`: `feed_override` = `{feed}`, `force_override` = `{force}`")
        }
        Fault::LostReading | Fault::ReadingJump => format!(" = `{row}`: position {position}"),
        Fault::LostForce | Fault::ForceJump => format!(" = `{row}` {place}: raw force {raw}"),
        Fault::InvalidPath => format!(
            " {place}: mean angle `{:.3} rad`, `limits.force_angle` = `{} rad`, with `{:.2} N` and a raw force of {raw}",
            n.angle, p.limits.force_angle, force.measured
        ),
        Fault::ApproachTimeout => format!(
            ": `{} m` down, or more than `{} m` below it, is `{:.6} m` below it, with `{:.2} N`",
            p.approach.travel_max, p.limits.approach_depth, error.normal, force.measured
        ),
        Fault::PositionError => format!(
            " = `{} m`: `{:.6} m` along, `{:.6} m` beside",
            p.limits.position_error, error.tangential, error.lateral
        ),
        Fault::Stroke => format!(": position {position}, `stroke` = `{} {} {} m`", p.stroke.x, p.stroke.y, p.stroke.z),
        Fault::TareRejected => format!(" = `{} N`: `{:.2} N`", p.limits.tare_force, n.zero),
        Fault::NotAtStart => format!(
            ": `{:.6} m` above it, `{:.6} m` beside, `limits.start_offset` = `{} m`",
            -error.normal,
            error.beside(),
            p.limits.start_offset
        ),
        Fault::SurfaceError => format!(" = `{} m` {place}: `{:.6} m`", p.limits.surface_error, n.surface),
        Fault::FrozenReading | Fault::FollowingError | Fault::DriveSign | Fault::WeakDrive => {
            let (e, limit) = (output.following, p.limits.following_error);
            let share = n.share.map_or(String::new(), |share| format!("; it does `{share:.2}` of what it is told"));
            format!(
                " {place}: `{:.6} {:.6} {:.6} m` from where the pulses bring it, limit `{limit} m`{share}",
                e.x, e.y, e.z
            )
        }
        Fault::FrozenForce => {
            format!(" {place}: raw force {raw}, `limits.still_time` = `{} s`", p.limits.still_time)
        }
        Fault::Saturation => format!(" = `{} N`: raw force {raw}", p.sensor_range),
        Fault::NoisyForce => format!(" = `{} N` {place}: `{:.3} N`", p.limits.force_noise, n.noise),
        Fault::Oscillation | Fault::ForceError => {
            let [mean, limit] = n.force_error;
            let (measured, target) = (force.measured, p.force.target);
            format!(" {place}: `{mean:.2} N`, limit `{limit:.2} N`, with `{measured:.2} N` of `{target} N`")
        }
        Fault::WrongStiffness => {
            format!(
                " = `{}`: `{:.0} N/m` for `{} N/m`",
                p.limits.stiffness_ratio, output.stiffness_estimate, p.stiffness_nominal
            )
        }
        Fault::UnstableLoop => format!(
            ": `impedance.gain` = `{}`, `impedance.damping` = `{} N.s/m`, `force.integral_time` = `{} s`",
            p.impedance.gain, p.impedance.damping, p.force.integral_time
        ),
        Fault::UnloadTimeout => format!(" = `{} s`: `{:.2} N`", p.settle.time_max, force.measured),
        Fault::NoSliding => format!(
            " {place}: `{:.4} m/s` of `{:.4} m/s` at K_v = `{:.4} m/s` for `{} samples`, with a friction of `{:.2} N`",
            output.sliding.speed,
            p.stick_slip.sliding,
            p.stick_slip.velocity + output.sliding.added,
            p.stick_slip.half_period,
            output.sliding.friction
        ),
        Fault::NoProgress => format!(" = `{:.1} s`: `{:.1} s` {place}", n.time_limit, n.time),
        Fault::CommissionRejected => commission_rejected(p, &output.measured),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
    }
}

/// What was measured, and what it must be; what was told is in force again.
fn commission_rejected(p: &Parameters, m: &Measured) -> String {
    let told = Values::of(p);
    if acceptable(p, &told, m) {
        let mut found = p.clone();
        told.derived(p, m).put(&mut found, [told, told]);
        if let Err(error) = check(&found) {
            return format!(": {}", error.of_derived());
        }
    }
    let most = p.commission.deviation_max;
    format!(
        ": stiffness `{:.0} +- {:.0} N/m`, across `{:.0} +- {:.0} N/m`, friction `{:.3} +- {:.3}`, drives `{:.3} +- {:.3}` times as \
         fast as told and `{:.3} +- {:.3}` fed forward, delay `{:.2} +- {:.2}` samples, sensor turned by `{:.3} +- {:.3} rad`; limits \
         half and twice `stiffness.nominal` = `{:.0} N/m` as told, half and twice as fast, `0` to `{DELAY_MAX}` samples, \
         `commission.deviation_max` = `{most}` of it, for drives beside `{}` and `{}` of their guides, and \
         `commission.delay_deviation_max` = `{}`",
        m.stiffness,
        m.stiffness_deviation,
        m.lateral_stiffness,
        m.lateral_stiffness_deviation,
        m.friction,
        m.friction_deviation,
        m.drive_gain,
        m.drive_gain_deviation,
        m.feedforward,
        m.feedforward_deviation,
        m.io_delay,
        m.io_delay_deviation,
        m.sensor_rotation,
        m.sensor_rotation_deviation,
        told.stiffness,
        GUIDES[0],
        GUIDES[1],
        p.commission.delay_deviation_max
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::ErrorOutput;

    #[test]
    fn a_fault_tells_what_was_judged_and_its_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.numbers = Numbers {
            share: Some(0.3),
            time: 28.4,
            time_limit: 28.3,
            norm: 24.68,
            zero: 2.345,
            angle: 0.7125,
            surface: 6.2e-4,
            noise: 0.4567,
            force_error: [1.234, 1.0],
        };
        (vars.output.measured.stiffness, vars.output.measured.stiffness_deviation) = (123_456.7, 1234.5);
        vars.output.error = ErrorOutput { tangential: 3e-3, lateral: -4e-3, normal: 2e-3 };
        for (fault, told) in [
            (Fault::WeakDrive, "; it does `0.30` of what it is told"),
            (Fault::DriveSign, "; it does `0.30` of what it is told"),
            (Fault::NoProgress, " = `28.3 s`: `28.4 s` at `0.000` of the path"),
            (Fault::ForceLimit, " = `25 N` at `0.000` of the path: `24.68 N`"),
            (Fault::TareRejected, " = `2 N`: `2.35 N`"),
            (Fault::InvalidPath, "mean angle `0.713 rad`, `limits.force_angle` = `0.6 rad`"),
            (Fault::SurfaceError, " = `0.0005 m` at `0.000` of the path: `0.000620 m`"),
            (Fault::NoisyForce, " = `0.35 N` at `0.000` of the path: `0.457 N`"),
            (Fault::ForceError, "`1.23 N`, limit `1.00 N`"),
            (Fault::LostForce, " = `5` at `0.000` of the path: raw force `0 0 0 N`"),
            (Fault::ReadingJump, " = `5`: position `0 0 0 m`"),
            (Fault::CommissionRejected, ": stiffness `123457 +- 1234 N/m`, across `0 +- 0 N/m`"),
            (Fault::LongStep, ": limit `0.001 s`"),
            (Fault::NotAtStart, ": `-0.002000 m` above it, `0.005000 m` beside"),
        ] {
            vars.output.fault = fault;
            assert!(numbers(&vars).contains(told), "{}", numbers(&vars));
        }
    }

    #[test]
    fn a_rejected_commission_tells_what_was_told_and_what_the_parameters_do_not_bear() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        let told = numbers(&vars);
        assert!(told.contains("half and twice `stiffness.nominal` = `178000 N/m` as told"), "{told}");
        let m = &mut vars.output.measured;
        (m.stiffness, m.lateral_stiffness, m.friction, m.drive_gain, m.io_delay) = (178e3, 200e3, 0.2, 0.6, 1.0);
        (m.sensor_direction_y, m.sensor_direction_z) = (1, 1);
        vars.in_force.position.gain.y = 50.0;
        let told = numbers(&vars);
        let limit = "parameter `position.gain.y` would be `50 1/s`, must be at most `drive.position_gain` = `48 1/s`";
        assert!(told.contains(limit), "{told}");
    }
}
