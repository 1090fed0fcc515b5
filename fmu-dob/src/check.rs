//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{Parameter, ParameterError, check_all, check_commission_time, ticks};

use crate::calibration::series::RATIO;
use crate::commission::plan;
use crate::detection::detector::Detector;
use crate::detection::touch;
use crate::force::observer::forgetting;
use crate::interface::{DetectorKind, Parameters};
use crate::motion::stability::spectral_radius;
use crate::motion::travel::arming_travel;

/// Learning needs this many independent windows.
const LEARN_WINDOWS: usize = 5;

/// Checks all combinations; the first that fails is the error.
///
/// # Errors
/// When a parameter does not fit the others.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    check_all(p, &[direction, velocity_bandwidth, stability])?;
    check_derived(p)
}

/// All checks except those whose parameters a commissioning run cannot change: it knows the longest delay at which the
/// loop is stable.
///
/// # Errors
/// When a parameter does not fit the others.
pub fn check_derived(p: &Parameters) -> Result<(), ParameterError> {
    check_all(
        p,
        &[
            settle_time,
            learn_time,
            travel,
            retract,
            guard,
            readings,
            starting,
            learn_limit,
            second_touch,
            calibration_speeds,
            commission_travel,
            commission_force,
            commission_time,
        ],
    )
}

fn direction(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Set `1` if `position` increases towards the workpiece, `-1` if it decreases.";
    let direction = Parameter::new("approach.direction", p.approach.direction, "", hint);
    direction.must_be(p.approach.direction.abs() == 1, || "`1` or `-1`".into())
}

fn velocity_bandwidth(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Reduce `servo.bandwidth`: the delayed velocity makes the servo oscillate.";
    Parameter::new("expert.observer.velocity_bandwidth", p.observer.velocity_bandwidth, "rad/s", hint)
        .at_least(4.0 * p.servo.bandwidth, "four times `servo.bandwidth`")
}

fn settle_time(p: &Parameters) -> Result<(), ParameterError> {
    let (value, samples) = (p.learn.settle_time, Detector::settling(p));
    let minimum = samples as f64 * p.sample_period;
    let hint = "Reduce `expert.deviation.window` or `expert.slope.window`, or increase `learn.settle_time`.";
    let time = Parameter::new("learn.settle_time", value, "s", hint);
    time.must_be(ticks(value, p.sample_period) as usize >= samples, || {
        format!("at least `{minimum} s`, the `{samples}` samples that `detector` needs at constant speed")
    })
}

fn starting(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Increase `learn.settle_time` or `observer.bandwidth`: the acceleration disturbs the guard and the drive monitor.";
    Parameter::new("learn.settle_time", p.learn.settle_time, "s", hint)
        .at_least(2.0 * forgetting(p), "twice the `6 / observer.bandwidth` until it has no effect on the observer")
}

fn learn_limit(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Increase it: every approach would raise `LearnTimeout`.";
    let (limit, minimum) = (p.limits.learn_time, p.learn.time);
    Parameter::new("expert.limits.learn_time", limit, "s", hint)
        .must_be(limit == 0.0 || limit >= minimum, || format!("`0`, or at least `learn.time`, `{minimum} s`"))
}

fn second_touch(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Set `detector` = `Glr`, the only one with a likelihood ratio.";
    Parameter::new("touch.confirm", p.touch.confirm, "", hint)
        .must_be(!p.touch.confirm || p.detector == DetectorKind::Glr, || {
            "`false` with any other detector than `Glr`".into()
        })?;
    let hint = "Reduce it: two suspicions together must not be a contact yet.";
    let maximum = 0.5 * touch::EVIDENCE;
    Parameter::new("expert.touch.suspicion", p.touch.suspicion, "", hint).must_be(p.touch.suspicion <= maximum, || {
        format!("at most `{maximum}`, half of the ratio of a confirmed contact")
    })
}

fn calibration_speeds(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Increase the range of speeds: the parts of the bias cannot be distinguished otherwise.";
    Parameter::new("calibration.velocity_max", p.calibration.velocity_max, "m/s", hint)
        .at_least(RATIO * p.calibration.velocity_min, "three times `calibration.velocity_min`")
}

fn learn_time(p: &Parameters) -> Result<(), ParameterError> {
    let samples = LEARN_WINDOWS * Detector::window(p);
    let minimum = samples as f64 * p.sample_period;
    let time = Parameter::new(
        "learn.time",
        p.learn.time,
        "s",
        "Increase `learn.time`, or reduce `expert.slope.window` or `expert.glr.onsets`.",
    );
    time.must_be(ticks(p.learn.time, p.sample_period) as usize >= samples, || {
        format!("at least `{minimum} s`, `{LEARN_WINDOWS}` times the longest window")
    })
}

fn travel(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Increase `approach.travel_max`, or reduce `approach.velocity` or `learn.time`.";
    Parameter::new("approach.travel_max", p.approach.travel_max, "m", hint)
        .more_than(arming_travel(p, &p.approach), "the travel until the detector is armed")
}

fn retract(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Increase it, or set `0`: the next approach would touch before its detector is armed.";
    let minimum = arming_travel(p, &p.approach);
    let distance = Parameter::new("retract.distance", p.retract.distance, "m", hint);
    distance.must_be(p.retract.distance == 0.0 || p.retract.distance >= minimum, || {
        format!("`0`, or at least `{minimum} m`, the travel until the detector is armed")
    })
}

fn readings(p: &Parameters) -> Result<(), ParameterError> {
    let step = p.stage.encoder_resolution;
    let hint = "Increase it: the steps of the encoder would look like a fault.";
    Parameter::new("limits.jump", p.limits.jump, "m", hint)
        .at_least(4.0 * step, "four times `stage.encoder_resolution`")?;
    Parameter::new("limits.frozen", p.limits.frozen, "m", hint)
        .at_least(4.5 * step, "four and a half times `stage.encoder_resolution`")
}

fn stability(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Reduce `servo.bandwidth`, `observer.bandwidth`, `io_delay` or `sample_period`, or increase \
                `expert.observer.velocity_bandwidth`.";
    let radius = spectral_radius(p);
    let servo = Parameter::new("servo.bandwidth", p.servo.bandwidth, "rad/s", hint);
    servo.must_be(radius < 1.0, || {
        format!(
            "so low that the loop is stable with a drive 30 % stronger and one more sample of delay than configured: with \
             `observer.bandwidth` = `{} rad/s` its largest eigenvalue is `{radius}`, the limit `1`",
            p.observer.bandwidth
        )
    })
}

fn commission_travel(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "Increase `commission.travel`, or reduce `learn.time`.";
    let (value, minimum) = (p.commission.travel, plan::stroke(p));
    Parameter::new("commission.travel", value, "m", hint).must_be(value == 0.0 || value >= minimum, || {
        format!("`0`, or at least `{minimum} m`, the travel in which the noise of the approach is learned")
    })
}

fn commission_force(p: &Parameters) -> Result<(), ParameterError> {
    let (maximum, minimum) = (p.stage.force_constant * p.stage.current_max, p.guard_force);
    let hint = "A larger force saturates the current; a smaller one cannot compensate disturbances.";
    let force = Parameter::new("commission.force", plan::force(p), "N", hint);
    force.must_be((minimum..maximum).contains(&plan::force(p)), || {
        format!("`0`, or from `{minimum} N`, `guard.force`, to below `{maximum} N`, the largest force of the drive")
    })
}

fn commission_time(p: &Parameters) -> Result<(), ParameterError> {
    check_commission_time(p.commission.time, || plan::shortest_time(p))
}

fn guard(p: &Parameters) -> Result<(), ParameterError> {
    let maximum = p.stage.force_constant * p.stage.current_max;
    let force = Parameter::new(
        "guard.force",
        p.guard_force,
        "N",
        "Reduce it: the guard must trip before the current saturates.",
    );
    force.less_than(maximum, "the largest force of the drive")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::DetectorKind;
    use control_blocks::{Refusal, assert_refusals};

    const REFUSALS: &[Refusal<Parameters>] = &[
        (|p| p.approach.direction = 0, "approach.direction", "`0`", "`-1`"),
        (|p| p.servo.bandwidth = 1000.0, "expert.observer.velocity_bandwidth", "`3142 rad/s`", "`4000 rad/s`"),
        (|p| p.deviation_window = 0.5, "learn.settle_time", "`0.25 s`", "`0.53 s`"),
        (|p| p.calibration.velocity_min = 2e-4, "calibration.velocity_max", "`0.0003 m/s`", "`0.0006"),
        (|p| p.learn.time = 0.05, "learn.time", "`0.05 s`", "`0.15 s`"),
        (|p| p.approach.travel_max = 5e-5, "approach.travel_max", "`0.00005 m`", "armed"),
        (|p| p.retract.distance = 2e-5, "retract.distance", "`0.00002 m`", "`0.000075"),
        (|p| p.limits.jump = 3e-9, "limits.jump", "`0.000000003 m`", "`stage.encoder_resolution`"),
        (|p| p.stage.encoder_resolution = 2e-9, "limits.frozen", "`0.0000000075 m`", "`stage.encoder_resolution`"),
        // limit cycles that the ranges allow
        (|p| (p.servo.bandwidth, p.observer.bandwidth) = (785.0, 3000.0), "servo.bandwidth", "`785 rad/s`", "stable"),
        (
            |p| (p.sample_period, p.observer.velocity_bandwidth) = (1e-3, 800.0),
            "servo.bandwidth",
            "`188 rad/s`",
            "stable",
        ),
        (|p| p.observer.bandwidth = 40.0, "learn.settle_time", "`0.25 s`", "`0.3 s`"),
        (|p| p.limits.learn_time = 0.4, "expert.limits.learn_time", "`0.4 s`", "`0.5 s`"),
        (|p| p.commission.travel = 7e-5, "commission.travel", "`0.00007 m`", "`0.0000752"),
        (|p| p.commission.force = 100.0, "commission.force", "`100 N`", "`100 N`"),
        (|p| p.commission.force = 0.3, "commission.force", "`0.3 N`", "`guard.force`"),
        (|p| p.commission.time = 5.0, "expert.commission.time", "`5 s`", "`10.8"),
        (|p| p.touch.suspicion = 13.0, "expert.touch.suspicion", "`13`", "at most `12`"),
        (|p| p.guard_force = 100.0, "guard.force", "`100 N`", "`100 N`"),
    ];

    #[test]
    fn defaults_and_the_paper_fit_with_every_detector() {
        for p in [Parameters::START, Parameters::PAPER] {
            check(&p).unwrap();
            for &detector in DetectorKind::ALL {
                check(&Parameters { detector, ..p.clone() }).unwrap();
            }
        }
    }

    #[test]
    fn presets_fit_and_each_error_names_parameter_value_and_limit() {
        assert_refusals(check, &[Parameters::START, Parameters::PAPER], REFUSALS);
    }
}
