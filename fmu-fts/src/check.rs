//! Checks of parameters against each other; ranges of single parameters are in the interface.

use control_blocks::{DELAY_MAX, Parameter, ParameterError, check_all, check_commission_time};

use crate::commission::plan;
use crate::interface::{ERROR_HARMONICS, Parameters, SurfaceKind};
use crate::monitoring::drive::disturbance;
use crate::tracking::adaptive::QUICKER;

/// Smallest ratio of the flexure frequency to the bandwidth of the position loop.
const TIP_OVER_LOOP: f64 = 1.5;

impl Parameters {
    /// Samples from a command to the arm angle that responds to it.
    pub fn loop_delay(&self) -> i32 {
        self.io_delay + self.arm_delay
    }
}

/// Checks all combinations; the first failure is the error.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    check_all(
        p,
        &[
            loop_delay,
            tip_frequency,
            radii,
            roll_off,
            path_harmonics,
            automatic,
            time_constant,
            frequencies,
            commission_torque,
            commission_time,
        ],
    )
}

fn loop_delay(p: &Parameters) -> Result<(), ParameterError> {
    let maximum = DELAY_MAX as i32 - p.io_delay;
    let delay =
        Parameter::new("arm_delay", p.arm_delay, "", "the loop tolerates no more; use a faster link to the encoder");
    delay.must_be(p.arm_delay <= maximum, || {
        format!("at most `{maximum}`, `{DELAY_MAX}` less `io_delay` = `{}`", p.io_delay)
    })
}

fn tip_frequency(p: &Parameters) -> Result<(), ParameterError> {
    let (value, minimum) = (p.tip.frequency, min_tip_frequency(p.servo.bandwidth));
    let frequency = Parameter::new("tip.frequency", value, "rad/s", "use a stiffer arm or reduce `servo.bandwidth`");
    frequency.must_be(value == 0.0 || value >= minimum, || {
        format!("`0` (rigid) or at least `{minimum} rad/s`, {TIP_OVER_LOOP} times `servo.bandwidth`")
    })
}

/// Lowest flexure frequency (rad/s) that a loop of this bandwidth (rad/s) tolerates.
pub fn min_tip_frequency(bandwidth: f64) -> f64 {
    TIP_OVER_LOOP * bandwidth
}

fn radii(p: &Parameters) -> Result<(), ParameterError> {
    let (inner, outer) = (p.surface.inner_radius, p.surface.outer_radius);
    let radius = Parameter::new("surface.outer_radius", outer, "m", "the cut moves from the outer to the inner radius");
    radius.at_least(
        inner + p.path.grid,
        format_args!("one `expert.path.grid` beyond `surface.inner_radius` = `{inner} m`"),
    )
}

fn roll_off(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "the roll-off must attenuate noise far above the bandwidth only";
    let roll_off = Parameter::new("expert.servo.roll_off", p.servo.roll_off, "rad/s", hint);
    roll_off.at_least(2.0 * p.servo.bandwidth, "twice `servo.bandwidth`")
}

fn path_harmonics(p: &Parameters) -> Result<(), ParameterError> {
    let minimum = p.surface.wave_harmonic;
    let harmonics = Parameter::new("path.harmonics", p.path.harmonics, "", "the wave must be a harmonic of the path");
    harmonics.must_be(p.surface.kind != SurfaceKind::Wave || p.path.harmonics >= minimum, || {
        format!("at least `surface.wave_harmonic` = `{minimum}`")
    })
}

fn automatic(p: &Parameters) -> Result<(), ParameterError> {
    let highest = p.afc.cancelled.highest();
    let hint = "the choice uses the reported harmonics of the error";
    let harmonics = Parameter::new("afc.harmonics", format!("up to {highest}"), "", hint);
    harmonics.must_be(!p.afc.automatic || highest <= ERROR_HARMONICS, || {
        format!("up to `{ERROR_HARMONICS}` with `expert.afc.automatic`")
    })
}

/// All harmonics together learn with 2 N / tau. The limit for the position loop follows from the eigenvalues of both.
fn time_constant(p: &Parameters) -> Result<(), ParameterError> {
    let (count, minimum) = (learned(p), minimum_time_constant(p, p.servo.bandwidth));
    let tau = Parameter::new("afc.tau", p.afc.tau, "s", "cancel fewer harmonics, or increase `servo.bandwidth`");
    tau.at_least(minimum, format_args!("5 / `servo.bandwidth` for each of `{count}` harmonics"))
}

/// Shortest `afc.tau` (s) that a loop of this bandwidth (rad/s) tolerates.
pub fn minimum_time_constant(p: &Parameters, bandwidth: f64) -> f64 {
    5.0 * learned(p) / bandwidth
}

/// Number of harmonics that are learned together; a quick one is worth several.
fn learned(p: &Parameters) -> f64 {
    let quicker = if p.feedforward_adaptive && p.feedforward_harmonics > 0 { QUICKER } else { 0.0 };
    p.afc.cancelled.iter().count() as f64 + quicker
}

fn frequencies(p: &Parameters) -> Result<(), ParameterError> {
    let highest = p.identify.grid.highest();
    let frequencies = Parameter::new("expert.identify.frequencies", highest, "Hz", "omit the highest frequencies");
    // five samples per period
    frequencies.at_most(0.2 / p.sample_period, "a fifth of the sampling rate")
}

fn commission_torque(p: &Parameters) -> Result<(), ParameterError> {
    let (value, minimum, maximum) = (p.commission.torque, disturbance(p), p.limits.torque_ratio * p.servo.torque_max);
    let hint = "a smaller torque is below friction and cut; a larger one leaves too little for control";
    let torque = Parameter::new("commission.torque", value, "N.m", hint);
    torque.must_be(value == 0.0 || (minimum..=maximum).contains(&value), || {
        format!(
            "`0`, or from the disturbances, `{minimum} N.m`, to `expert.limits.torque_ratio` of `servo.torque_max`, `{maximum} N.m`"
        )
    })
}

fn commission_time(p: &Parameters) -> Result<(), ParameterError> {
    check_commission_time(p.commission.time, || plan::shortest_time(p))
        .map_err(|error| ParameterError { name: "expert.commission.time", ..error })
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::{Refusal, assert_refusals};

    const REFUSALS: &[Refusal<Parameters>] = &[
        (|p| (p.io_delay, p.arm_delay) = (6, 3), "arm_delay", "`3`", "at most `2`"),
        (|p| p.tip.frequency = 1000.0, "tip.frequency", "`1000 rad/s`", "at least `2167"),
        (|p| p.surface.outer_radius = 0.0, "surface.outer_radius", "`0 m`", "`0.0005 m`"),
        (|p| p.identify.grid = "10, 2500".parse().unwrap(), "expert.identify.frequencies", "`2500 Hz`", "`2000 Hz`"),
        (|p| p.commission.torque = 0.1, "commission.torque", "`0.1 N.m`", "`0.21 N.m`"),
        (|p| p.commission.torque = 6.4, "commission.torque", "`6.4 N.m`", "`6.3 N.m`"),
        (|p| p.commission.time = 5.0, "expert.commission.time", "`5 s`", "`9"),
        (|p| p.afc.tau = 0.05, "afc.tau", "`0.05 s`", "for each of `29` harmonics"),
        (|p| p.servo.roll_off = 2000.0, "expert.servo.roll_off", "`2000 rad/s`", "`2890"),
        (|p| p.surface.kind = SurfaceKind::Wave, "path.harmonics", "`12`", "`surface.wave_harmonic` = `50`"),
        (
            |p| (p.afc.automatic, p.afc.cancelled) = (true, p.afc.cancelled.with(50)),
            "afc.harmonics",
            "`up to 50`",
            "up to `24`",
        ),
    ];

    #[test]
    fn presets_fit_and_each_error_names_parameter_value_and_limit() {
        assert_refusals(check, &[Parameters::START, Parameters::PAPER], REFUSALS);
    }
}
