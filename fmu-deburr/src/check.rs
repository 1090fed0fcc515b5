//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{Parameter, ParameterError, check_all, check_commission_time};

use crate::commission::{plan, values};
use crate::interface::Parameters;
use crate::path::programmed_path::ProgrammedPath;
use crate::run::PREVIEW_MAX;

/// Checks all combinations; the first that fails is the error.
pub fn check(p: &Parameters, path: &ProgrammedPath) -> Result<(), ParameterError> {
    check_all(p, &[travel, bandwidth, lead_out, check_delay, commission_apply])?;
    speed_min(p, path)?;
    commission_time(p, path)
}

/// Checks the parameters whose limits depend on `io_delay`: it is the only parameter that a commissioning run derives
/// and from which limits of others follow.
///
/// # Errors
/// When lead, lead-in or preview does not fit `io_delay`.
pub fn check_delay(p: &Parameters) -> Result<(), ParameterError> {
    check_all(p, &[lead, lead_in, preview])
}

fn travel(p: &Parameters) -> Result<(), ParameterError> {
    const NAMES: [&str; 6] =
        ["axis1.maximum", "axis2.maximum", "axis3.maximum", "axis4.maximum", "axis5.maximum", "axis6.maximum"];
    NAMES.iter().zip(&p.axis).try_for_each(|(name, axis)| {
        let maximum = Parameter::new(name, axis.maximum, "", "the travel is from the minimum to the maximum");
        maximum.must_be(axis.maximum > axis.minimum, || format!("above the minimum of this axis, `{}`", axis.minimum))
    })
}

fn bandwidth(p: &Parameters) -> Result<(), ParameterError> {
    // 0.45 of the sampling rate
    let maximum = 0.9 * std::f64::consts::PI / p.sample_period;
    let value = p.learn.bandwidth;
    let bandwidth = Parameter::new("expert.learn.bandwidth", value, "rad/s", "reduce it or `sample_period`");
    bandwidth.must_be(value <= maximum, || format!("at most `{maximum:.1} rad/s`, 0.45 of the sampling rate"))
}

fn lead(p: &Parameters) -> Result<(), ParameterError> {
    let lead = Parameter::new("expert.learn.lead", p.learn.lead, "", "the error is read ahead by their sum");
    lead.at_least(-p.io_delay, "minus `io_delay`")
}

fn lead_in(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "the compensation starts earlier than the motion by these samples";
    let lead_in = Parameter::new("expert.learn.lead_in", p.learn.lead_in as usize, "", hint);
    lead_in.at_least(p.shift(), "`expert.learn.lead` and `io_delay` together")
}

fn lead_out(p: &Parameters) -> Result<(), ParameterError> {
    // the slowest axis has come to 2 % of its lag
    let slowest = p.servo_gain.iter().fold(f64::INFINITY, |minimum, gain| minimum.min(*gain));
    let minimum = (4.0 / (slowest * p.sample_period)).ceil() as i32;
    let hint = "increase it for shorter samples or a slower servo";
    let lead_out = Parameter::new("expert.learn.lead_out", p.learn.lead_out, "", hint);
    lead_out.at_least(minimum, "4 time constants 1/Kp of the slowest axis")
}

fn preview(p: &Parameters) -> Result<(), ParameterError> {
    let delay = f64::from(p.io_delay) * p.sample_period;
    let (low, high) = (-delay, PREVIEW_MAX as f64 * p.sample_period - delay);
    let value = p.lookup.preview;
    let hint = "use the lag of the velocity loop, twice its damping ratio over its natural frequency";
    Parameter::new("expert.lookup.preview", value, "s", hint).must_be(value >= low && value <= high, || {
        format!("`{low}` to `{high} s`: `0` to `{PREVIEW_MAX}` samples together with `io_delay`")
    })
}

fn speed_min(p: &Parameters, path: &ProgrammedPath) -> Result<(), ParameterError> {
    let (value, programmed) = (p.load.speed_min, path.speed);
    let speed = Parameter::new("expert.load.speed_min", value, "m/s", "the feed is regulated between the two");
    speed.must_be(value <= programmed, || format!("at most the programmed speed, `{programmed} m/s`"))
}

fn commission_apply(p: &Parameters) -> Result<(), ParameterError> {
    let delays = values::delays(p.io_delay);
    let fits = |io_delay: &i32| check_delay(&Parameters { io_delay: *io_delay, ..p.clone() }).is_ok();
    let good = !p.commission.apply || [delays.start(), delays.end()].into_iter().all(fits);
    let hint = "the identified delay must fit them; otherwise reduce `io_delay` to the actual delay";
    Parameter::new("commission.apply", p.commission.apply, "", hint).must_be(good, || {
        format!(
            "`false`, or `expert.learn.lead`, `expert.learn.lead_in` and `expert.lookup.preview` that fit every `io_delay` from `{}` to `{}`",
            delays.start(),
            delays.end()
        )
    })
}

fn commission_time(p: &Parameters, path: &ProgrammedPath) -> Result<(), ParameterError> {
    check_commission_time(p.commission.time, || plan::shortest_time(p, path.speed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;
    use control_blocks::{Refusal, assert_refusals};

    const REFUSALS: &[Refusal<Parameters>] = &[
        (|p| p.axis[2].maximum = 0.05, "axis3.maximum", "`0.05`", "`0.1`"),
        (|p| p.learn.bandwidth = 300.0, "expert.learn.bandwidth", "`300 rad/s`", "`282.7 rad/s`"),
        (|p| p.learn.lead = -3, "expert.learn.lead", "`-3`", "at least `-1`"),
        (|p| (p.learn.lead, p.io_delay) = (8, 6), "expert.learn.lead_in", "`10`", "at least `14`"),
        (|p| p.learn.lead_out = 30, "expert.learn.lead_out", "`30`", "at least `31`"),
        (|p| p.lookup.preview = 0.08, "expert.lookup.preview", "`0.08 s`", "`-0.01` to `0.07 s`"),
        (|p| p.load.speed_min = 0.2, "expert.load.speed_min", "`0.2 m/s`", "`0.1 m/s`"),
        (|p| p.commission.time = 20.0, "expert.commission.time", "`20 s`", "at least `27"),
        (|p| (p.commission.apply, p.learn.lead) = (true, 8), "commission.apply", "`true`", "`0` to `3`"),
    ];

    #[test]
    fn each_limit_belongs_to_what_is_allowed() {
        let path = straight(0.1);
        type Change = fn(&mut Parameters);
        let cases: [(Change, Change); 6] = [
            // two samples more of delay, for the lead-in of 10
            (|p| (p.commission.apply, p.learn.lead) = (true, 7), |p| (p.commission.apply, p.learn.lead) = (true, 8)),
            (|p| p.axis[2].maximum = p.axis[2].minimum + 1e-9, |p| p.axis[2].maximum = p.axis[2].minimum),
            (|p| p.learn.bandwidth = 90.0 * std::f64::consts::PI, |p| p.learn.bandwidth = 90.1 * std::f64::consts::PI),
            (|p| p.lookup.preview = -0.01, |p| p.lookup.preview = -0.0101),
            (|p| p.lookup.preview = 0.07, |p| p.lookup.preview = 0.0701),
            (|p| p.load.speed_min = 0.1, |p| p.load.speed_min = 0.1001),
        ];
        for (k, (within, beyond)) in cases.into_iter().enumerate() {
            for (change, good) in [(within, true), (beyond, false)] {
                let mut p = Parameters::START;
                change(&mut p);
                assert_eq!(check(&p, &path).is_ok(), good, "{k}");
            }
        }
    }

    #[test]
    fn presets_fit_and_each_error_names_parameter_value_and_limit() {
        assert_refusals(|p| check(p, &straight(0.1)), &[Parameters::START, Parameters::PAPER], REFUSALS);
    }
}
