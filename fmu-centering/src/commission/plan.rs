//! Travel, acceleration and duration of the commissioning run, from its bounds.
//!
//! The servo of the motion board holds the slide all the time. No loop of this controller is closed around it, so an
//! off-nominal machine cannot become unstable. The setpoint stays within travel and acceleration. The
//! slide follows with e = r - x, of which e'' + 2 zeta w e' + w^2 e = r'': a stable filter of |r''| <= a, so |e| never
//! exceeds (a / w^2) coth(pi zeta / (2 sqrt(1 - zeta^2))), the peak under an acceleration that reverses with every half
//! period: 1.1 a / w^2 at zeta = 0.7, 2.2 a / w^2 at 0.3. By that distance the slide may exceed its travel.
//!
//! All strokes are on the side of the ring, because the slide waits at the rear end of its travel. They end long before
//! the ring: an approach without a ring may move by `approach.travel_max`, and the pusher touches only at
//! `probe.at_pusher`.

use control_blocks::{commission_time, configured_or};

use crate::interface::Parameters;
use crate::limits::slowest_servo;
use crate::motion::duration;

/// Positions of the strokes in travels, and their speeds in `approach.velocity`. The quick ones reverse at many
/// frequencies around that of the servo; the slow ones are long at rest or at one speed, where only an integral action
/// still moves the slide.
const STROKES: [(f64, f64); 14] = [
    (1.0, 1.0),
    (0.0, 1.0),
    (0.5, 1.0),
    (0.25, 1.0),
    (0.75, 1.0),
    (0.6, 1.0),
    (0.7, 1.0),
    (0.1, 1.0),
    (0.15, 1.0),
    (0.05, 1.0),
    (0.3, 1.0),
    (0.0, 1.0),
    (1.0, 0.05),
    (0.0, 0.05),
];
/// Repetitions of all strokes in a round.
const REPEATS: usize = 3;
/// Rounds: each uses the delay of the one before; and one more, if a measurement was lost.
pub const ROUNDS: u32 = 3;
const ROUNDS_SPARE: u32 = 1;
/// Rest at the end of a round, until the slide is still, s.
pub const REST: f64 = 0.3;
/// Period of the longest stroke back and forth in periods of the servo, and largest fraction of `probe.at_pusher`.
const PERIODS: f64 = 4.0;
const PUSHER_RATIO: f64 = 0.1;

/// Position (travels from the start) and speed (in `approach.velocity`) of a stroke; none after the last one of a round.
pub fn stroke(number: usize) -> Option<(f64, f64)> {
    (number < REPEATS * STROKES.len()).then(|| STROKES[number % STROKES.len()])
}

/// Maximum travel towards the ring (m): `commission.travel`, or the one with which the longest stroke back and
/// forth, 4 (d / a)^(1/2), takes four periods of the servo.
pub fn travel(p: &Parameters) -> f64 {
    configured_or(p.commission.travel, || {
        let period = PERIODS * std::f64::consts::TAU / configured_or(p.slide.bandwidth, || slowest_servo(p));
        let distance = acceleration(p) * (0.25 * period).powi(2);
        distance.min(PUSHER_RATIO * p.probe.at_pusher).min(p.approach.travel_max)
    })
}

/// Acceleration (m/s2) of the strokes: `commission.acceleration`, or that of all moves.
pub fn acceleration(p: &Parameters) -> f64 {
    configured_or(p.commission.acceleration, || p.slide.acceleration_max)
}

/// Longest commissioning run (s): the time of its motions and of one more round, with a reserve.
pub fn time(p: &Parameters) -> f64 {
    commission_time(0.0, || f64::from(ROUNDS + ROUNDS_SPARE) * round_time(p))
}

/// Time (s) that the motions of a commissioning run take.
#[cfg(test)]
pub fn shortest_time(p: &Parameters) -> f64 {
    f64::from(ROUNDS) * round_time(p)
}

/// Time (s) of a round.
fn round_time(p: &Parameters) -> f64 {
    let mut position = 0.0;
    let strokes: f64 = (0..)
        .map_while(stroke)
        .map(|(next, speed)| {
            let distance = (next - std::mem::replace(&mut position, next)) * travel(p);
            // a stroke ends with a sample
            duration(distance.abs(), speed * p.approach.velocity, acceleration(p)) + p.sample_period
        })
        .sum();
    strokes + REST
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn bounds_of_the_defaults_and_configured_bounds() {
        let mut p = Parameters::START;
        let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-12, "{value} {expected}");
        // 2.56 m/s2, and a period of 40 Hz
        near(travel(&p), 2.56 * 0.025f64.powi(2));
        near(acceleration(&p), 2.56);
        near(time(&p), 5.0 / 3.0 * shortest_time(&p) + 1.0);
        p.slide.bandwidth = TAU * 30.0;
        near(travel(&p), 2e-3);
        p.slide.bandwidth = 0.0;
        near(travel(&p), 2e-3);
        p.approach.travel_max = 1e-3;
        near(travel(&p), 1e-3);
        (p.commission.travel, p.commission.acceleration) = (5e-4, 1.0);
        assert_eq!((travel(&p), acceleration(&p)), (5e-4, 1.0));
    }

    #[test]
    fn a_round_returns_to_its_start() {
        let last = (0..).map_while(stroke).last().unwrap();
        assert_eq!((last.0, stroke(0).unwrap().0), (0.0, 1.0));
        assert!((0..).map_while(stroke).all(|(position, _)| (0.0..=1.0).contains(&position)));
    }

    #[test]
    fn a_slide_whose_setpoint_turns_at_the_worst_moments_stays_within_what_is_said() {
        let (w, a, dt) = (TAU * 40.0, 2.56, 1e-6);
        for (zeta, expected) in [(0.7, 1.1), (0.3, 2.2)] {
            let root = f64::sqrt(1.0 - zeta * zeta);
            let bound = a / (w * w) / (0.5 * PI * zeta / root).tanh();
            assert!((bound * w * w / a / expected - 1.0).abs() < 0.05, "{bound}");
            // it reverses with every half period of the damped servo
            let half = PI / (w * root);
            let (mut error, mut rate, mut maximum) = (0.0f64, 0.0, 0.0f64);
            for k in 0..1_000_000 {
                let turning = if ((dt * f64::from(k) / half) as u32).is_multiple_of(2) { a } else { -a };
                rate += dt * (turning - 2.0 * zeta * w * rate - w * w * error);
                error += dt * rate;
                maximum = maximum.max(error.abs());
            }
            assert!((maximum / bound - 1.0).abs() < 1e-3, "{zeta}: {maximum} {bound}");
        }
    }
}
