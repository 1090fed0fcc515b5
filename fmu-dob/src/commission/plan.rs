//! Amplitude, force and time of the commissioning run, from its bounds.
//!
//! During the excitation a proportional-derivative servo alone holds the stage, without any model. With a drive g times
//! as strong as configured its open loop is g (2 w s + w^2) / s^2 exp(-s tau) at the bandwidth w and the damping 1,
//! where tau is the sum of delay, half a sample, current loop and velocity estimate. Its gain is 1 at w sqrt(2 g^2 +
//! sqrt(4 g^4 + g^2)), 4.03 w for g = 2, with the phase margin atan(8.06) - 4.03 w tau: 83 degrees minus the 0.35 rad
//! that w = 0.35 / (4.03 tau) leaves to the delays, so 63 degrees. A weaker drive crosses earlier, with less of both;
//! at g = 1/2 the damping is still 0.7.
//!
//! Between reference and position the servo has the gain T = g (s^2 + 2 w s + w^2) / (s^2 + 2 g w s + g w^2), at most 2
//! for g from 1/2 to 2. Between the force of the reference on the nominal stage and that of the drive it has T / g, at
//! most 2.2 at the slow tones and 1 at the fast ones that dominate. A reference within half of travel and force
//! therefore keeps both bounds for every such g.

use control_blocks::{
    Excitation, ExcitationTimes, Multisine, QUINTIC_ACCELERATION, RATIO_MAX, commission_time, configured_or,
    quintic_duration, ticks, tolerated_delays,
};
use serde::{Deserialize, Serialize};

use crate::detection::detector::Detector;
use crate::interface::{Approach, Parameters, Servo};

/// Phase (rad) that the delays may take at the crossing of the gain, and that crossing over the bandwidth.
const PHASE: f64 = 0.35;
const CROSSING: f64 = 4.03;
/// Period of the excitation (s), and how many are measured.
const PERIOD: f64 = 0.5;
const PERIODS: u32 = 12;
/// Times (s) in which the excitation grows and fades, settles, and rests.
const TIMES: ExcitationTimes = ExcitationTimes { ramp: 0.5, settle: 0.5, rest: 0.2 };
/// Strokes at the approach speed, back and forth.
pub const STROKES: u32 = 4;
/// Ratio of the travel to a stroke, and minimum travel (m): with less, for the slowest approaches, the excitation does
/// not identify the delay of a stage with the default noise. With more, their faults would move farther than 50 um.
const TRAVEL: (f64, f64) = (1.2, 45e-6);
/// Fraction of the drive force that the excitation may use by default.
const DRIVE_RATIO: f64 = 0.5;
/// Maximum time at a reversal for which a stage of another mass is at rest while the reference moves, s.
pub const REVERSAL_TIME: f64 = 1e-3;

/// The motions of a commissioning run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// Excitation around its center.
    pub excitation: Excitation,
    /// Distance from the start to the center, m.
    pub back: f64,
    /// Time of that motion, s.
    pub stroke_time: f64,
    /// Strokes: speed and acceleration of the approach.
    pub approach: Approach,
    /// Samples of a stroke at constant speed until the filters have settled, and then those that are learned from.
    pub stroke: [u32; 2],
    /// Servo while it excites.
    pub servo: Servo,
}

impl Plan {
    /// The plan for these bounds.
    pub fn new(p: &Parameters) -> Self {
        let dt = p.sample_period;
        let unit = Multisine { amplitude: 1.0, period: ticks(PERIOD, dt).max(1), sample_period: dt };
        let back = 0.5 * travel(p);
        let by_travel = back / (RATIO_MAX * unit.reach());
        let by_force = force(p) / (RATIO_MAX * p.stage.mass * unit.acceleration_max());
        let brake = (QUINTIC_ACCELERATION * back / p.retract.deceleration).sqrt();
        Self {
            excitation: Excitation::new(Multisine { amplitude: by_travel.min(by_force), ..unit }, PERIODS, &TIMES),
            back,
            stroke_time: quintic_duration(back, p.retract.velocity).max(brake).max(dt),
            approach: p.approach,
            stroke: [stroke_settling(p), ticks(p.learn.time, dt)],
            servo: Servo { bandwidth: bandwidth(p), damping: 1.0, ..p.servo },
        }
    }

    /// How far (m) the stage may be from the reference of the excitation, for it may move up to twice as far.
    pub fn diverged(&self) -> f64 {
        RATIO_MAX * self.excitation.sines.reach()
    }

    /// Tolerated motion (m) of the excitation without a change of the position at its reversals.
    pub fn unanswered(&self) -> f64 {
        self.excitation.sines.velocity_max() * REVERSAL_TIME
    }

    /// Time of all motions, s.
    fn duration(&self) -> f64 {
        let dt = self.excitation.sines.sample_period;
        let stroke =
            2.0 * self.approach.velocity / self.approach.acceleration + f64::from(self.stroke[0] + self.stroke[1]) * dt;
        2.0 * self.stroke_time + f64::from(self.excitation.samples()) * dt + f64::from(STROKES) * stroke
    }
}

/// Bandwidth (rad/s) of the servo while it excites.
fn bandwidth(p: &Parameters) -> f64 {
    let samples = f64::from(*tolerated_delays(p.io_delay).end()) + 0.5;
    let late = samples * p.sample_period + p.stage.current_bandwidth.recip() + p.observer.velocity_bandwidth.recip();
    p.servo.bandwidth.min(PHASE / (CROSSING * late))
}

/// Samples of a stroke at constant speed until the filters have settled.
fn stroke_settling(p: &Parameters) -> u32 {
    ticks(p.learn.settle_time, p.sample_period).max(Detector::settling(p) as u32)
}

/// Way (m) of a stroke.
pub fn stroke(p: &Parameters) -> f64 {
    let Approach { velocity, acceleration, .. } = p.approach;
    let cruise = f64::from(stroke_settling(p) + ticks(p.learn.time, p.sample_period)) * p.sample_period;
    velocity * velocity / acceleration + velocity * cruise
}

/// Maximum travel (m): `commission.travel`, or a stroke with a margin, and at least that of the excitation.
pub fn travel(p: &Parameters) -> f64 {
    configured_or(p.commission.travel, || f64::max(TRAVEL.0 * stroke(p), TRAVEL.1))
}

/// Maximum force (N) in addition to the holding force: `commission.force`, or that of the hardest braking, at most half
/// of that of the drive and at least that of the guard.
pub fn force(p: &Parameters) -> f64 {
    let drive = p.stage.force_constant * p.stage.current_max;
    configured_or(p.commission.force, || {
        (p.stage.mass * p.retract.deceleration).min(DRIVE_RATIO * drive).max(p.guard_force)
    })
}

/// Maximum time of the run (s): `expert.commission.time`, or that of its motions with a margin.
pub fn time(p: &Parameters) -> f64 {
    commission_time(p.commission.time, || shortest_time(p))
}

/// Time (s) of the motions of a commissioning run.
pub fn shortest_time(p: &Parameters) -> f64 {
    Plan::new(p).duration()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::stability::radius;
    use control_blocks::{DELAY_SPREAD, HARMONICS};
    use nalgebra::Complex;

    const RATIOS: [f64; 4] = [0.5, 0.7, 1.0, 2.0];

    /// T at the frequency `omega` over the bandwidth, for a drive `g` times as strong as configured.
    fn closed(g: f64, omega: f64) -> f64 {
        let s = Complex::new(0.0, omega);
        let servo = s * 2.0 + 1.0;
        (g * (s * s + servo) / (s * s + servo * g)).norm()
    }

    #[test]
    fn the_servo_of_the_excitation_is_stable_on_every_machine_that_it_is_for() {
        for io_delay in 0..=4 {
            let mut p = Parameters { io_delay, ..Parameters::START };
            p.servo = Plan::new(&p).servo;
            (p.servo.disturbance_compensation, p.servo.integral_gain) = (false, 0.0);
            for ratio in RATIOS {
                for more in 0..=DELAY_SPREAD as usize {
                    let radius = radius(&p, ratio, io_delay as usize + more);
                    assert!(radius < 0.997, "{io_delay} + {more}, {ratio}: {radius}");
                }
            }
        }
    }

    #[test]
    fn the_gain_of_the_strongest_drive_crosses_where_it_says() {
        let gain = |x: f64| (Complex::new(1.0, 2.0 * x) * RATIO_MAX / (x * x)).norm();
        assert!((gain(CROSSING) - 1.0).abs() < 2e-3, "{}", gain(CROSSING));
        // 3.5 samples, 1 kHz and 500 Hz
        let p = Parameters::START;
        let late = 3.5e-4 + 1.0 / 6283.0 + 1.0 / 3142.0;
        assert!((bandwidth(&p) * CROSSING * late / PHASE - 1.0).abs() < 1e-12);
        let mut slow = p;
        slow.servo.bandwidth = 20.0;
        assert_eq!(bandwidth(&slow), 20.0);
    }

    #[test]
    fn travel_and_force_are_kept_by_a_stage_that_is_not_what_was_configured() {
        for force in [0.0, 1.0] {
            let mut p = Parameters::START;
            p.commission.force = force;
            let plan = Plan::new(&p);
            let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
                plan.excitation
                    .sines
                    .frequencies()
                    .into_iter()
                    .zip(HARMONICS)
                    .map(|(omega, h)| of(omega, f64::from(h).sqrt()))
                    .sum()
            };
            for g in RATIOS {
                let gain = |omega: f64| closed(g, omega / plan.servo.bandwidth);
                let motion = plan.excitation.sines.amplitude * sum(&|omega, root| gain(omega) / root);
                assert!(motion <= plan.back, "{g}: {motion}");
                let push = p.stage.mass
                    * plan.excitation.sines.amplitude
                    * sum(&|omega, root| gain(omega) / g * omega * omega / root);
                assert!(push <= super::force(&p), "{g}: {push}");
                assert!(motion - plan.excitation.sines.reach() <= plan.diverged());
            }
        }
    }

    #[test]
    fn bounds_of_the_defaults_and_bounds_that_are_detected() {
        let mut p = Parameters::START;
        let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-9, "{value} {expected}");
        // 100 um/s for 0.75 s, and 0.1 um at each end
        near(stroke(&p), 75.2e-6);
        near(travel(&p), 90.24e-6);
        near(force(&p), 20.0);
        // 15/8 of 45.12 um at 1 mm/s twice; 0.5, 0.5, 6, 0.5 and 0.2 s; four strokes of 0.754 s
        near(shortest_time(&p), 2.0 * 0.0846 + 7.7 + 4.0 * 0.754);
        near(time(&p), 1.25 * shortest_time(&p) + 1.0);
        (p.commission.travel, p.commission.force, p.commission.time) = (2e-4, 3.0, 33.0);
        near(travel(&p), 2e-4);
        near(force(&p), 3.0);
        near(time(&p), 33.0);
        // strokes of 7.5 um would leave the excitation a fifth of its travel
        let mut slow = Parameters::START;
        slow.approach.velocity = 1e-5;
        near(travel(&slow), 45e-6);
        assert_eq!(Plan::new(&slow).back, 22.5e-6);
    }
}
