//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{DELAY_MAX, Parameter, ParameterError, check_all, check_commission_time};

use crate::commission::plan;
use crate::interface::{ERROR_HARMONICS, Parameters, SurfaceKind};
use crate::monitoring::drive::disturbance;
use crate::tracking::adaptive::QUICKER;

/// The flexure is at least so many times as quick as the position loop.
const TIP_OVER_LOOP: f64 = 1.5;

impl Parameters {
    /// Samples from a command to the reading of the arm that answers it.
    pub fn loop_delay(&self) -> i32 {
        self.io_delay + self.arm_delay
    }
}

/// Checks all combinations; the first that fails is the error.
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
    let most = DELAY_MAX as i32 - p.io_delay;
    let delay =
        Parameter::new("arm_delay", p.arm_delay, "", "the loop bears no more; use a quicker link to the encoder");
    delay.must_be(p.arm_delay <= most, || format!("at most `{most}`, `{DELAY_MAX}` less `io_delay` = `{}`", p.io_delay))
}

fn tip_frequency(p: &Parameters) -> Result<(), ParameterError> {
    let (value, least) = (p.tip.frequency, least_tip_frequency(p.servo.bandwidth));
    let frequency = Parameter::new("tip.frequency", value, "rad/s", "use a stiffer arm or less `servo.bandwidth`");
    frequency.must_be(value == 0.0 || value >= least, || {
        format!("`0` (rigid) or at least `{least} rad/s`, {TIP_OVER_LOOP} times `servo.bandwidth`")
    })
}

/// Lowest frequency (rad/s) of a flexure that a loop of this bandwidth (rad/s) bears.
pub fn least_tip_frequency(bandwidth: f64) -> f64 {
    TIP_OVER_LOOP * bandwidth
}

fn radii(p: &Parameters) -> Result<(), ParameterError> {
    let (inner, outer) = (p.surface.inner_radius, p.surface.outer_radius);
    let radius = Parameter::new("surface.outer_radius", outer, "m", "the cut goes from the outer to the inner radius");
    radius.at_least(inner + p.path.grid, format_args!("one `path.grid` beyond `surface.inner_radius` = `{inner} m`"))
}

fn roll_off(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "the roll-off is for noise far above the bandwidth";
    let roll_off = Parameter::new("servo.roll_off", p.servo.roll_off, "rad/s", hint);
    roll_off.at_least(2.0 * p.servo.bandwidth, "twice `servo.bandwidth`")
}

fn path_harmonics(p: &Parameters) -> Result<(), ParameterError> {
    let least = p.surface.wave_harmonic;
    let harmonics = Parameter::new("path.harmonics", p.path.harmonics, "", "the wave is a harmonic of the path, too");
    harmonics.must_be(p.surface.kind != SurfaceKind::Wave || p.path.harmonics >= least, || {
        format!("at least `surface.wave_harmonic` = `{least}`")
    })
}

fn automatic(p: &Parameters) -> Result<(), ParameterError> {
    let highest = p.afc.cancelled.highest();
    let hint = "the choice is made from the reported harmonics of the error";
    let harmonics = Parameter::new("afc.harmonics", format!("up to {highest}"), "", hint);
    harmonics.must_be(!p.afc.automatic || highest <= ERROR_HARMONICS, || {
        format!("up to `{ERROR_HARMONICS}` with `afc.automatic`")
    })
}

/// All harmonics together learn with 2 N / tau, which the position loop must bear: measured by the eigenvalues of both.
fn time_constant(p: &Parameters) -> Result<(), ParameterError> {
    let (count, least) = (learned(p), least_time_constant(p, p.servo.bandwidth));
    let tau = Parameter::new("afc.tau", p.afc.tau, "s", "cancel fewer harmonics, or wish for more `servo.bandwidth`");
    tau.at_least(least, format_args!("5 / `servo.bandwidth` for each of `{count}` harmonics"))
}

/// Shortest `afc.tau` (s) that a loop of this bandwidth (rad/s) bears.
pub fn least_time_constant(p: &Parameters, bandwidth: f64) -> f64 {
    5.0 * learned(p) / bandwidth
}

/// Harmonics that are learned at once, the quick ones as often as they count.
fn learned(p: &Parameters) -> f64 {
    let quicker = if p.feedforward_adaptive && p.feedforward_harmonics > 0 { QUICKER } else { 0.0 };
    p.afc.cancelled.iter().count() as f64 + quicker
}

fn frequencies(p: &Parameters) -> Result<(), ParameterError> {
    let highest = p.identify.grid.highest();
    let frequencies = Parameter::new("identify.frequencies", highest, "Hz", "leave out the highest frequencies");
    // five samples a period
    frequencies.at_most(0.2 / p.sample_period, "a fifth of the sampling rate")
}

fn commission_torque(p: &Parameters) -> Result<(), ParameterError> {
    let (value, least, most) = (p.commission.torque, disturbance(p), p.limits.torque_share * p.servo.torque_max);
    let hint = "less than friction and cut tells nothing, and the rest is for control";
    let torque = Parameter::new("commission.torque", value, "N.m", hint);
    torque.must_be(value == 0.0 || (least..=most).contains(&value), || {
        format!(
            "`0`, or from the disturbances, `{least} N.m`, to `limits.torque_share` of `servo.torque_max`, `{most} N.m`"
        )
    })
}

fn commission_time(p: &Parameters) -> Result<(), ParameterError> {
    check_commission_time(p.commission.time, || plan::least_time(p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::{Refusal, assert_refusals};

    const REFUSALS: &[Refusal<Parameters>] = &[
        (|p| (p.io_delay, p.arm_delay) = (6, 3), "arm_delay", "`3`", "at most `2`"),
        (|p| p.tip.frequency = 1000.0, "tip.frequency", "`1000 rad/s`", "at least `2167"),
        (|p| p.surface.outer_radius = 0.0, "surface.outer_radius", "`0 m`", "`0.0005 m`"),
        (|p| p.identify.grid = "10, 2500".parse().unwrap(), "identify.frequencies", "`2500 Hz`", "`2000 Hz`"),
        (|p| p.commission.torque = 0.1, "commission.torque", "`0.1 N.m`", "`0.21 N.m`"),
        (|p| p.commission.torque = 6.4, "commission.torque", "`6.4 N.m`", "`6.3 N.m`"),
        (|p| p.commission.time = 5.0, "commission.time", "`5 s`", "`9"),
        (|p| p.afc.tau = 0.05, "afc.tau", "`0.05 s`", "for each of `29` harmonics"),
        (|p| p.servo.roll_off = 2000.0, "servo.roll_off", "`2000 rad/s`", "`2890"),
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
