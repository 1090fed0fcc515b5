//! Log messages of faults: the evaluated numbers and their limits.

use control_blocks::DELAY_MAX;

use crate::check::check;
use crate::commission::response::GUIDES;
use crate::commission::values::{Values, acceptable};
use crate::interface::{Fault, Measured, Parameters, Vars};
use crate::monitoring::numbers::Numbers;

/// The numbers of a fault, for the log message after its cause.
pub fn numbers(vars: &Vars) -> String {
    let (output, p) = (&vars.output, &vars.in_force);
    let (x, f, force, error) = (vars.input.position, vars.input.force, output.force, output.error);
    let n: Numbers = output.numbers;
    let location = format!("at `{:.3}` of the path", output.progress);
    let (position, raw) = (format!("`{} {} {} m`", x.x, x.y, x.z), format!("`{} {} {} N`", f.x, f.y, f.z));
    let lost = format!("`expert.limits.lost_samples` = `{}`", p.limits.lost_samples);
    let time_max = format!("`expert.settle.time_max` = `{} s`", p.settle.time_max);
    match output.fault {
        Fault::None | Fault::EmergencyStop => String::new(),
        Fault::ForceLimit => format!(" {location}: `{:.2} N`, `limits.force` = `{} N`", n.norm, p.limits.force),
        Fault::SettleTimeout => format!(": `{:.2} N` of `{} N`, {time_max}", force.measured, p.force.target),
        Fault::ContactLost => {
            format!(" {location}: `{:.2} N`, `expert.limits.lost_force` = `{} N`", force.measured, p.limits.lost_force)
        }
        Fault::InvalidInput => {
            let (feed, force) = (vars.input.feed_override, vars.input.force_override);
            format!(": `feed_override` = `{feed}`, `force_override` = `{force}`, {lost}")
        }
        Fault::PositionLost | Fault::PositionJump => format!(": position {position}, {lost}"),
        Fault::ForceLost | Fault::ForceJump => format!(" {location}: raw force {raw}, {lost}"),
        Fault::InvalidPath => format!(
            " {location}: mean angle `{:.3} rad`, `expert.limits.force_angle` = `{} rad`, with `{:.2} N` and a raw force of {raw}",
            n.angle, p.limits.force_angle, force.measured
        ),
        Fault::ApproachTimeout => format!(
            ": the tool is `{:.6} m` below the start of the path, `limits.approach_depth` = `{} m`, `approach.travel_max` = `{} m`, \
             with `{:.2} N`",
            error.normal, p.limits.approach_depth, p.approach.travel_max, force.measured
        ),
        Fault::PositionError => format!(
            ": `{:.6} m` along, `{:.6} m` across, `limits.position_error` = `{} m`",
            error.tangential, error.lateral, p.limits.position_error
        ),
        Fault::Stroke => format!(": position {position}, `stroke` = `{} {} {} m`", p.stroke.x, p.stroke.y, p.stroke.z),
        Fault::TareRejected => format!(": `{:.2} N`, `expert.limits.tare_force` = `{} N`", n.zero, p.limits.tare_force),
        Fault::NotAtStart => format!(
            ": `{:.6} m` above it, `{:.6} m` to the side, `expert.limits.start_offset` = `{} m`",
            -error.normal,
            error.in_plane(),
            p.limits.start_offset
        ),
        Fault::SurfaceError => {
            format!(" {location}: `{:.6} m`, `limits.surface_error` = `{} m`", n.surface, p.limits.surface_error)
        }
        Fault::PositionFrozen | Fault::FollowingError | Fault::DriveSign | Fault::WeakDrive => {
            let (e, limit) = (output.following, p.limits.following_error);
            let ratio =
                n.ratio.map_or(String::new(), |ratio| format!("; it moves `{ratio:.2}` of the commanded travel"));
            format!(
                " {location}: `{:.6} {:.6} {:.6} m` from the drive model, `expert.limits.following_error` = `{limit} m`{ratio}",
                e.x, e.y, e.z
            )
        }
        Fault::ForceFrozen => {
            format!(" {location}: raw force {raw}, `expert.limits.frozen_time` = `{} s`", p.limits.frozen_time)
        }
        Fault::Saturation => format!(": raw force {raw}, `sensor.range` = `{} N`", p.sensor_range),
        Fault::NoisyForce => {
            format!(" {location}: `{:.3} N`, `limits.force_noise` = `{} N`", n.noise, p.limits.force_noise)
        }
        Fault::Oscillation | Fault::ForceError => {
            let [mean, limit] = n.force_error;
            let (measured, target) = (force.measured, p.force.target);
            format!(" {location}: `{mean:.2} N` rms, limit `{limit:.2} N`, with `{measured:.2} N` of `{target} N`")
        }
        Fault::WrongStiffness => format!(
            ": `{:.0} N/m`, `stiffness.nominal` = `{} N/m`, `expert.limits.stiffness_ratio` = `{}`",
            output.stiffness_estimate, p.stiffness_nominal, p.limits.stiffness_ratio
        ),
        Fault::UnstableLoop => format!(
            ": `expert.impedance.gain` = `{}`, `impedance.damping` = `{} N.s/m`, `expert.force.integral_time` = `{} s`",
            p.impedance.gain, p.impedance.damping, p.force.integral_time
        ),
        Fault::UnloadTimeout => format!(": `{:.2} N`, {time_max}", force.measured),
        Fault::NoSliding => format!(
            " {location}: `{:.4} m/s`, `stick_slip.sliding` = `{:.4} m/s`, at K_v = `{:.4} m/s` for `{} samples`, with a friction of \
             `{:.2} N`",
            output.sliding.speed,
            p.stick_slip.sliding,
            p.stick_slip.velocity + output.sliding.added,
            p.stick_slip.half_period,
            output.sliding.friction
        ),
        Fault::NoProgress => format!(" {location}: `{:.1} s`, limit `{:.1} s`", n.time, n.time_limit),
        Fault::CommissionRejected => commission_rejected(p, &output.measured),
        Fault::LongStep => format!(": `sample_period` = `{} s`", p.sample_period),
    }
}

/// The measured values and their limits. The configured values are in use again.
fn commission_rejected(p: &Parameters, m: &Measured) -> String {
    let nominal = Values::of(p);
    if acceptable(p, &nominal, m) {
        let mut found = p.clone();
        nominal.derived(p, m).put(&mut found, [nominal, nominal]);
        if let Err(error) = check(&found) {
            return format!(": {}", error.of_derived());
        }
    }
    let maximum = p.commission.std_max;
    format!(
        ": stiffness `{:.0} +- {:.0} N/m`, lateral stiffness `{:.0} +- {:.0} N/m`, friction `{:.3} +- {:.3}`, drive gain \
         `{:.3} +- {:.3}`, feedforward `{:.3} +- {:.3}`, delay `{:.2} +- {:.2}` samples, mounting angle `{:.3} +- {:.3} rad`; limits: half \
         and twice `stiffness.nominal` = `{:.0} N/m`, drive gain `0.5` to `2`, delay `0` to `{DELAY_MAX}` samples, \
         `expert.commission.std_max` = `{maximum}`, in addition to `{}` and `{}` of the drive values for guide friction, \
         `expert.commission.delay_std_max` = `{}`",
        m.stiffness,
        m.stiffness_std,
        m.lateral_stiffness,
        m.lateral_stiffness_std,
        m.friction,
        m.friction_std,
        m.drive_gain,
        m.drive_gain_std,
        m.feedforward,
        m.feedforward_std,
        m.io_delay,
        m.io_delay_std,
        m.sensor_rotation,
        m.sensor_rotation_std,
        nominal.stiffness,
        GUIDES[0],
        GUIDES[1],
        p.commission.delay_std_max
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::ErrorOutput;

    #[test]
    fn a_fault_message_holds_the_evaluated_number_and_its_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.numbers = Numbers {
            ratio: Some(0.3),
            time: 28.4,
            time_limit: 28.3,
            norm: 24.68,
            zero: 2.345,
            angle: 0.7125,
            surface: 6.2e-4,
            noise: 0.4567,
            force_error: [1.234, 1.0],
        };
        (vars.output.measured.stiffness, vars.output.measured.stiffness_std) = (123_456.7, 1234.5);
        vars.output.error = ErrorOutput { tangential: 3e-3, lateral: -4e-3, normal: 2e-3 };
        for (fault, expected) in [
            (Fault::WeakDrive, "; it moves `0.30` of the commanded travel"),
            (Fault::DriveSign, "; it moves `0.30` of the commanded travel"),
            (Fault::NoProgress, " at `0.000` of the path: `28.4 s`, limit `28.3 s`"),
            (Fault::ForceLimit, " at `0.000` of the path: `24.68 N`, `limits.force` = `25 N`"),
            (Fault::TareRejected, ": `2.35 N`, `expert.limits.tare_force` = `2 N`"),
            (Fault::InvalidPath, "mean angle `0.713 rad`, `expert.limits.force_angle` = `0.6 rad`"),
            (Fault::SurfaceError, " at `0.000` of the path: `0.000620 m`, `limits.surface_error` = `0.0005 m`"),
            (Fault::NoisyForce, " at `0.000` of the path: `0.457 N`, `limits.force_noise` = `0.35 N`"),
            (Fault::ForceError, "`1.23 N` rms, limit `1.00 N`"),
            (Fault::ForceLost, " at `0.000` of the path: raw force `0 0 0 N`, `expert.limits.lost_samples` = `5`"),
            (Fault::PositionJump, ": position `0 0 0 m`, `expert.limits.lost_samples` = `5`"),
            (Fault::CommissionRejected, ": stiffness `123457 +- 1234 N/m`, lateral stiffness `0 +- 0 N/m`"),
            (Fault::LongStep, ": `sample_period` = `0.001 s`"),
            (Fault::NotAtStart, ": `-0.002000 m` above it, `0.005000 m` to the side"),
        ] {
            vars.output.fault = fault;
            assert!(numbers(&vars).contains(expected), "{}", numbers(&vars));
        }
    }

    #[test]
    fn a_rejected_commissioning_run_names_the_nominal_values_and_the_parameters_that_do_not_fit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        let text = numbers(&vars);
        assert!(text.contains("half and twice `stiffness.nominal` = `178000 N/m`"), "{text}");
        let m = &mut vars.output.measured;
        (m.stiffness, m.lateral_stiffness, m.friction, m.drive_gain, m.io_delay) = (178e3, 200e3, 0.2, 0.6, 1.0);
        (m.sensor_direction_y, m.sensor_direction_z) = (1, 1);
        vars.in_force.position.gain.y = 50.0;
        let text = numbers(&vars);
        let limit =
            "parameter `expert.position.gain.y` would be `50 1/s`, must be at most `drive.position_gain` = `48 1/s`";
        assert!(text.contains(limit), "{text}");
    }
}
