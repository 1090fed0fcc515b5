//! Distances and times of a cycle.

use control_blocks::stopping_distance;

use crate::detection::detector::Detector;
use crate::detection::touch;
use crate::interface::{Approach, Parameters};

/// Ratio of the retract to the travel that arms the detector: reserve for the surface and the stop.
const RETRACT_SPARE: f64 = 1.2;
/// Reserve of the maximum cycle time: factor, and time in s.
const CYCLE_SPARE: (f64, f64) = (1.25, 1.0);

/// First touches in air are frequent, and each second touch takes 0.2 s: the approach takes longer by this factor.
const TOUCHED_AGAIN: f64 = 2.0;

/// Travel (m) until the detector is armed, v^2 / (2 a) + v (t_settle + t_learn).
pub fn arming_travel(p: &Parameters, approach: &Approach) -> f64 {
    let v = approach.velocity;
    stopping_distance(v, approach.acceleration) + v * (p.learn.settle_time + p.learn.time)
}

/// Distance of the retract (m): `retract.distance`, or that with which the next approach is armed before it touches.
pub fn retract_distance(p: &Parameters, approach: &Approach) -> f64 {
    if p.retract.distance > 0.0 { p.retract.distance } else { RETRACT_SPARE * arming_travel(p, approach) }
}

/// Distance of the retract (m) from a touch of a calibration: `next` is armed there, however short `retract.distance`
/// is.
pub fn retract_between(p: &Parameters, next: &Approach) -> f64 {
    retract_distance(p, next).max(RETRACT_SPARE * arming_travel(p, next))
}

/// Maximum time of learning (s): `expert.limits.learn_time`, or twice `learn.time` and the settling of the filters.
pub fn learn_limit(p: &Parameters) -> f64 {
    if p.limits.learn_time > 0.0 {
        return p.limits.learn_time;
    }
    2.0 * p.learn.time + Detector::settling(p) as f64 * p.sample_period
}

/// Maximum time of a cycle (s): `limits.cycle_time`, or that of its motions and times with a reserve.
pub fn cycle_limit(p: &Parameters, approach: &Approach) -> f64 {
    if p.limits.cycle_time > 0.0 {
        return p.limits.cycle_time;
    }
    let Approach { velocity, acceleration, travel_max, .. } = *approach;
    let again = if p.touch.confirm { TOUCHED_AGAIN } else { 1.0 };
    let there = again * travel_max / velocity + velocity / acceleration + p.learn.settle_time + learn_limit(p);
    let back = (travel_max + retract_distance(p, approach)) / p.retract.velocity;
    CYCLE_SPARE.0 * (there + back) + CYCLE_SPARE.1
}

/// Time (s) of a number of samples; `limits.cycle_time` may be longer than a 32-bit count.
pub fn lasted(p: &Parameters, samples: u64) -> f64 {
    samples as f64 * p.sample_period
}

/// Travel (m) of each touch of a calibration cycle: from one touch to the next at the fastest speed, with the maximum
/// bias, and to a stop.
pub fn calibration_travel(p: &Parameters) -> f64 {
    let fastest = Approach { velocity: p.calibration.velocity_max, ..p.approach };
    let dwell = if p.touch.confirm { touch::DWELL } else { 0.0 };
    let stop = fastest.velocity * dwell + stopping_distance(fastest.velocity, p.retract.deceleration);
    retract_between(p, &fastest) + p.limits.bias + stop
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_and_times_of_the_defaults() {
        let mut p = Parameters::START;
        let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-9, "{value} {expected}");
        // 100 um/s for 0.75 s, and 0.1 um to get there
        near(arming_travel(&p, &p.approach), 75.1e-6);
        near(retract_distance(&p, &p.approach), 90.12e-6);
        // twice 0.5 s, 0.2 s for the gain of the filter, 0.03 s for its template
        near(learn_limit(&p), 1.23);
        // 50 s there, 5.09 s back
        near(cycle_limit(&p, &p.approach), 1.25 * (50.0 + 0.002 + 0.25 + 1.23 + 5.09012) + 1.0);
        p.touch.confirm = true;
        near(cycle_limit(&p, &p.approach), 1.25 * (100.0 + 0.002 + 0.25 + 1.23 + 5.09012) + 1.0);
        (p.retract.distance, p.limits.learn_time, p.limits.cycle_time) = (1e-3, 3.0, 7.0);
        near(retract_distance(&p, &p.approach), 1e-3);
        near(retract_between(&p, &p.approach), 1e-3);
        p.retract.distance = 8e-5;
        near(retract_between(&p, &Approach { velocity: 3e-4, ..p.approach }), 1.2 * (225e-6 + 0.9e-6));
        near(learn_limit(&p), 3.0);
        near(cycle_limit(&p, &p.approach), 7.0);
    }

    #[test]
    fn a_calibration_needs_the_retract_of_its_fastest_touch_and_as_much_as_that_may_be_late() {
        let mut p = Parameters::START;
        let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-9, "{value} {expected}");
        // 300 um/s for 0.75 s and 0.9 um to get there, a fifth more; 1 um late; 22.5 nm to stop at 2 m/s2
        near(calibration_travel(&p), 1.2 * (225e-6 + 0.9e-6) + 1e-6 + 22.5e-9);
        p.touch.confirm = true;
        near(calibration_travel(&p), 1.2 * (225e-6 + 0.9e-6) + 1e-6 + 22.5e-9 + 3e-6);
        (p.retract.distance, p.limits.bias) = (1e-3, 2e-6);
        near(calibration_travel(&p), 1e-3 + 2e-6 + 22.5e-9 + 3e-6);
    }

    #[test]
    fn a_cycle_may_last_for_more_samples_than_a_counter_of_32_bit_holds() {
        let mut p = Parameters::START;
        p.limits.cycle_time = 1e9;
        assert!(lasted(&p, 2 * u64::from(u32::MAX)) < cycle_limit(&p, &p.approach));
        assert!(lasted(&p, 10_000_000_000_001) > cycle_limit(&p, &p.approach));
    }
}
