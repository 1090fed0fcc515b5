//! Communication points and steps: those that fit the clock and the experiment, and what is wrong with others.

use crate::instance::access::Refusal;
use crate::instance::clock::{Clock, MAX_TICKS, SNAP};
use crate::model::Experiment;

/// Checks that a step starts where the last one has ended, by the clock, and can be done.
///
/// # Errors
/// If `step` is not positive or too long, if `time` is not the end of the last step, or if it passes the stop time.
#[inline]
pub fn check_step(clock: &Clock, experiment: &Experiment, time: f64, step: f64) -> Result<(), Refusal> {
    let possible = clock.is_usual(step) || (step > 0.0 && step.is_finite() && step <= MAX_TICKS * clock.period);
    // importers accumulate time with rounding: the point is checked, never counted with;
    // `<`, because an infinite time makes an infinite tolerance
    let expected = (time - (experiment.start + clock.position())).abs() < 0.01 * step + 1e-9 * time.abs();
    let (end, stop) = (time + step, experiment.stop);
    if possible && expected && (end <= stop || end <= stop + 1e-6 * step + 1e-9 * stop.abs()) {
        Ok(())
    } else {
        Err(wrong_step(clock, experiment, time, step))
    }
}

/// Error that names the reason why [`check_step`] rejects a step.
#[cold]
fn wrong_step(clock: &Clock, experiment: &Experiment, time: f64, step: f64) -> Refusal {
    let expected = experiment.start + clock.position();
    if !(step > 0.0 && step.is_finite()) {
        Refusal::error(format!("the communication step {step} s is not positive"))
    } else if step > MAX_TICKS * clock.period {
        Refusal::error(format!("the communication step {step} s is longer than {MAX_TICKS} sample periods"))
    } else if time.is_finite() && (time - expected).abs() < 0.01 * step + 1e-9 * time.abs() {
        let stop = experiment.stop;
        Refusal::error(format!("the step from {time} s by {step} s passes the stop time {stop} s"))
    } else {
        Refusal::error(format!("the communication point {time} s is not the end of the last step, {expected} s"))
    }
}

/// Whether a step is longer than `longest` sample periods, beyond what rounding makes of it.
#[inline]
pub fn is_too_long(clock: &Clock, step: f64, longest: f64) -> bool {
    step > (longest + SNAP) * clock.period
}

/// The warning about a step that [`is_too_long`].
pub fn too_long(clock: &Clock, step: f64, longest: f64) -> String {
    let (period, samples) = (clock.period, (step / clock.period * 1e6).round() / 1e6);
    format!(
        "the communication step `{step} s` is {samples} sample periods of `{period} s`, a closed loop works up to \
         {longest}: inputs are held for the whole step, and of the outputs those of its last sample are seen\n\
         hint: set the communication step of the importer to `{period} s`"
    )
}
