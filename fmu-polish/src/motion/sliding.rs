//! Detects whether the ball slides or the tip only bends, from the work of the axes against the lateral force. If the
//! ball slides too little, K_v increases, then the half period.
//!
//! A bend of the tip is reversible. So over whole periods the integrals of F . dx and of |F| F . dx contain only the
//! sliding, with the forces F across the normal and the travels dx of the axes. With the work W = -sum(F . dx) and Q =
//! -sum(|F| F . dx) the friction is Q / W and the sliding distance W^2 / Q. No stiffness of the tip is needed. Without
//! sliding W and Q are noise, so the friction is at least the root mean square of F. The travel passes through the lag
//! of the sensor; otherwise a bent tip would seem to do work. All of this holds for a circle too. A ball that is
//! dragged does W = mu F by its sliding distance. A ball that sticks does none, as its bend is orthogonal to the
//! motion.

use control_blocks::ticks;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::force::contact::Measurement;
use crate::interface::{Mode, Parameters};
use crate::motion::apparent_sliding::ApparentSliding;
use crate::motion::sensed_motion::SensedMotion;
use crate::motion::stick_slip::{self, fastest};
use crate::motion::sweep_limits::{accelerated, highest};

/// Time over which it is measured, s: whole periods.
const WINDOW_TIME: f64 = 0.2;
/// Fraction of the missing speed by which K_v increases in a window.
const RISE: f64 = 0.8;
/// Fraction of the desired speed below which a ball on a circle is treated as sticking.
const STICKS: f64 = 0.5;
/// Fraction of the desired speed that is still sliding: the measured one is up to 25 % off.
const ENOUGH: f64 = 0.9;
/// Consecutive windows at the largest K_v, over which the speed is averaged for the verdict.
const WINDOWS: u32 = 5;
/// Minimum detectable friction, in steps of the sensor.
const SENSED: f64 = 2.0;

/// Measured sliding, and the increase of K_v that follows from it; by default nothing is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sliding {
    motion: SensedMotion,
    apparent: ApparentSliding,
    samples: u32,
    /// W, J
    work: f64,
    /// Q, N J
    weighted: f64,
    /// sum of the squares of the force, N2
    square: f64,
    /// Mean speed at which the ball slides, m/s; none before the first window.
    pub speed: Option<f64>,
    /// Friction while it slides, N.
    pub friction: f64,
    /// Increase of K_v over its configured value, m/s.
    pub added: f64,
    /// Samples that are added to the half period.
    pub lengthened: i32,
    /// the half period is to be lengthened where a period ends
    short: bool,
    /// largest K_v (m/s) at which a ball on a circle slid too little in this cycle
    stuck: f64,
    /// consecutive windows at the largest K_v since the last verdict, and the sum of their speeds, m/s
    windows: u32,
    speeds: f64,
    /// It slides too little, and K_v cannot be raised.
    pub too_little: bool,
}

impl Sliding {
    /// Takes one sample of the path, at the position `position` (m); without a contact nothing slides.
    pub fn update(&mut self, p: &Parameters, position: &Vector3<f64>, now: &Measurement, touching: bool) {
        let normal = &now.frame.normal;
        let force = now.force.unfiltered - normal * normal.dot(&now.force.unfiltered);
        if let Some((mean, sensed)) = self.motion.step(p, &force, position) {
            let work = if touching { -mean.dot(&sensed) } else { 0.0 };
            self.work += work;
            self.weighted += mean.norm() * work;
            self.square += mean.norm_squared();
            self.apparent.add(&sensed);
            self.samples += 1;
        }
        if self.samples >= window(p) {
            self.evaluate(p);
        }
    }

    fn evaluate(&mut self, p: &Parameters) {
        let count = f64::from(self.samples);
        let minimum = (self.square / count).sqrt().max(f64::MIN_POSITIVE);
        self.friction = if self.work > 0.0 { (self.weighted / self.work).max(minimum) } else { minimum };
        let time = count * p.sample_period;
        let (speed, round) = (self.work / self.friction / time, self.apparent.round(time));
        (self.samples, self.work, self.weighted, self.square) = Default::default();
        self.speed = Some(speed);
        if desired_speed(p) == 0.0 {
            self.added = 0.0;
            self.restart_evaluation();
        } else if self.friction <= SENSED * p.sensor_resolution {
            // too little friction to say anything
            self.restart_evaluation();
        } else {
            let maximum = (highest(p) - p.stick_slip.velocity).max(0.0);
            let speed = self.apparent.certain(p, speed, round);
            let (raised, velocity) = (self.added >= maximum, p.stick_slip.velocity + self.added);
            if p.stick_slip.mode == Mode::Circular && speed < ENOUGH * desired_speed(p) {
                self.stuck = self.stuck.max(velocity);
            }
            let minimum = (self.stuck - p.stick_slip.velocity).clamp(0.0, maximum);
            self.added = (self.added + rise(p, velocity, speed)).clamp(minimum, maximum);
            self.add_to_evaluation(p, speed, raised);
        }
    }

    /// Takes the speed (m/s) of a window for the verdict, at the largest K_v or not.
    fn add_to_evaluation(&mut self, p: &Parameters, speed: f64, at_most: bool) {
        if !at_most {
            return self.restart_evaluation();
        }
        self.windows += 1;
        self.speeds += speed;
        if self.windows == WINDOWS {
            let mean = self.speeds / f64::from(WINDOWS);
            let slow = mean < ENOUGH * desired_speed(p);
            self.short = slow && p.stick_slip.half_period < p.stick_slip.half_period_max;
            self.too_little = slow && !self.short;
            // the fault message shows the evaluated speed
            self.speed = if slow { Some(mean) } else { self.speed };
            (self.windows, self.speeds) = (0, 0.0);
        }
    }

    /// Changes the half period after sample `k` of the sweep, if this ends a period: increases one that is too short,
    /// or restores the configured one; returns whether it has changed. A linear sweep is then in its middle; a circle
    /// starts where it is, half its width off the path. K_v starts from its configured value, and earlier measurements
    /// are discarded.
    pub fn restarts(&mut self, p: &Parameters, k: u32) -> bool {
        let law = &p.stick_slip;
        let lengthened = if self.short {
            self.lengthened + law.half_period_max - law.half_period
        } else if desired_speed(p) == 0.0 {
            0
        } else {
            self.lengthened
        };
        let restarts = lengthened != self.lengthened && k.is_multiple_of(2 * law.half_period.unsigned_abs());
        if restarts {
            let Self { motion, speed, friction, .. } = *self;
            *self = Self { motion, speed, friction, lengthened, ..Self::default() };
        }
        restarts
    }

    fn restart_evaluation(&mut self) {
        (self.windows, self.speeds, self.too_little, self.short) = (0, 0.0, false, false);
    }

    /// K_v (m/s) of a sample at the feed `feed` (m/s): no more than the drives accelerate, whatever has been tuned.
    pub fn swept(&self, p: &Parameters, feed: f64) -> f64 {
        (stick_slip::velocity(&p.stick_slip, feed) + self.raised(p)).min(accelerated(p))
    }

    /// Increase (m/s) of K_v in this sample, limited by the present parameters: they may have been tuned since the last
    /// window. 0 if the desired sliding speed is 0.
    fn raised(&self, p: &Parameters) -> f64 {
        if desired_speed(p) > 0.0 { self.added.min((highest(p) - p.stick_slip.velocity).max(0.0)) } else { 0.0 }
    }
}

/// Increase of K_v = `velocity` (m/s) where the ball slides at `speed` (m/s).
///
/// In a linear sweep each m/s of K_v is one of sliding. On a circle the ball slides at s, s^2 = c^2 (K_v^2 - K_0^2)
/// with c = pi / 2, and it sticks up to K_0. This is steep, so K_v^2 increases by the missing part of s^2 over c^2. If
/// the ball sticks, only K_0 > K_v is known. Static friction is larger by r: a ball at rest breaks loose at r K_0, and
/// a ball that slides at a lower K_v sticks for good after any stop. So K_v never falls to a value at which the ball
/// slid too little earlier in the cycle.
fn rise(p: &Parameters, velocity: f64, speed: f64) -> f64 {
    let (desired, c) = (desired_speed(p), fastest(&p.stick_slip));
    match p.stick_slip.mode {
        Mode::Circular if speed < STICKS * desired => RISE * (desired - speed) / c,
        Mode::Circular => {
            let square = velocity.powi(2) + RISE * (desired.powi(2) - speed.powi(2)) / (c * c);
            square.max(0.0).sqrt() - velocity
        }
        _ => RISE * (desired - speed),
    }
}

/// The desired minimum speed (m/s); 0 where K_v stays constant.
pub fn desired_speed(p: &Parameters) -> f64 {
    let law = &p.stick_slip;
    if law.mode == Mode::Off || law.ratio > 0.0 || law.velocity == 0.0 { 0.0 } else { law.sliding }
}

/// Samples of a window: whole periods of the stick-slip motion.
fn window(p: &Parameters) -> u32 {
    let period = 2 * p.stick_slip.half_period.unsigned_abs().max(1);
    ticks(WINDOW_TIME, p.sample_period).div_ceil(period) * period
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::sensor::MeasuredForce;
    use crate::interface::{Drive, ErrorOutput, StickSlip};
    use crate::motion::stick_slip::tests::circular;
    use crate::path::centre_path::Frame;

    const P: Parameters = Parameters::START;

    fn measurement(force: Vector3<f64>) -> Measurement {
        let (zero, normal) = (Vector3::zeros(), Vector3::z());
        let frame = Frame { centre: zero, contact: zero, normal, tangent: Vector3::x(), ratio: 1.0, feed_max: 1.0 };
        let force =
            MeasuredForce { vector: force, unfiltered: force, norm: force.norm(), normal: force.z, controlled: 5.0 };
        let error = ErrorOutput { tangential: 0.0, lateral: 0.0, normal: 0.0 };
        Measurement { frame, force, force_error: 0.0, offset: zero, error, surface: 0.0 }
    }

    /// A tip of `stiffness` N/m that slides at `friction` N, reciprocating by 50 um at `speed` m/s, through the lag of the
    /// sensor: the measurement after `time` s, and the mean speed at which it actually slid.
    fn moved(p: &Parameters, stiffness: f64, friction: f64, speed: f64, time: f64) -> (Sliding, f64) {
        const FINE: u32 = 100;
        let (mut sliding, mut bend, mut sensed, mut y, mut slid) = (Sliding::default(), 0.0f64, 0.0, 0.0, 0.0);
        let dt = p.sample_period / f64::from(FINE);
        let (period, count) = ((100e-6 / speed / p.sample_period) as u32, ticks(time, p.sample_period));
        for k in 0..count {
            sliding.update(p, &Vector3::new(0.0, y, 1e-4 * y), &measurement(Vector3::new(0.0, sensed, 5.0)), true);
            let displacement = if (k / period).is_multiple_of(2) { speed * dt } else { -speed * dt };
            for _ in 0..FINE {
                y += displacement;
                let free = bend - displacement;
                bend = free.clamp(-friction / stiffness, friction / stiffness);
                slid += (free - bend).abs();
                sensed += (stiffness * bend - sensed) * dt * p.sensor_bandwidth;
            }
        }
        (sliding, slid / time)
    }

    #[test]
    fn what_bends_the_tip_is_no_sliding_whatever_its_stiffness() {
        let p = Parameters { stick_slip: StickSlip { sliding: 0.0, ..P.stick_slip }, ..P };
        for (stiffness, friction) in [(1e6, 1.0), (200e3, 1.0), (60e3, 2.0), (30e3, 1.0), (30e3, 1.4)] {
            let (sliding, actual) = moved(&p, stiffness, friction, 10e-3, 1.0);
            let measured = sliding.speed.unwrap();
            // the lag rounds the force where it reverses suddenly
            assert!((measured - actual).abs() < 0.14 * actual, "{stiffness} {friction}: {measured} {actual}");
            assert!((sliding.friction / friction - 1.0).abs() < 0.15, "{stiffness} {friction}: {}", sliding.friction);
        }
        // 50 um to each side are 1.5 N
        let (stuck, actual) = moved(&p, 30e3, 3.5, 10e-3, 1.0);
        assert!(actual == 0.0 && stuck.speed.unwrap().abs() < 0.3e-3, "{stuck:?}");
    }

    /// A tip of `stiffness` N/m whose ball slides at `friction` N, on axes that rotate as commanded by `sliding`,
    /// through the lag of a sensor that is `faster` times as fast as configured; for `time` s: the true mean speed of
    /// sliding in the last window.
    fn round(p: &Parameters, sliding: &mut Sliding, [stiffness, friction, faster]: [f64; 3], time: f64) -> f64 {
        const FINE: u32 = 50;
        let (mut bend, mut sensed, mut position) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        let (dt, count) = (p.sample_period / f64::from(FINE), ticks(time, p.sample_period));
        let mut slid = 0.0;
        for k in 1..=count {
            sliding.update(p, &position, &measurement(sensed + 5.0 * Vector3::z()), true);
            let (ratio, vector) = stick_slip::motion(&p.stick_slip, k, &measurement(sensed).frame);
            let displacement = vector * (ratio * (p.stick_slip.velocity + sliding.raised(p)) * dt);
            for _ in 0..FINE {
                position += displacement;
                let free: Vector3<f64> = bend - displacement;
                bend = free * (friction / (stiffness * free.norm())).min(1.0);
                slid += if k + window(p) > count { (free - bend).norm() } else { 0.0 };
                sensed += (stiffness * bend - sensed) * (dt * faster * p.sensor_bandwidth);
            }
        }
        slid / (f64::from(window(p)) * p.sample_period)
    }

    #[test]
    fn a_ball_that_is_dragged_round_slides_as_derived_and_is_reported_so() {
        let still = Parameters { stick_slip: StickSlip { sliding: 0.0, ..circular().stick_slip }, ..P };
        let fastest = fastest(&still.stick_slip) * still.stick_slip.velocity;
        for (stiffness, friction) in [(1e6, 1.0), (209e3, 1.0), (100e3, 2.0), (50e3, 2.0), (30e3, 1.2)] {
            let mut sliding = Sliding::default();
            let actual = round(&still, &mut sliding, [stiffness, friction, 1.0], 0.6);
            // 50 um are the radius, less up to 0.6 um as a sample goes straight
            let derived = fastest * (1.0 - (friction / stiffness / 50e-6).powi(2)).sqrt();
            assert!((actual / derived - 1.0).abs() < 0.03, "{stiffness} {friction}: {actual} {derived}");
            assert!(
                (sliding.speed.unwrap() / actual - 1.0).abs() < 0.1,
                "{stiffness} {friction}: {sliding:?} {actual}"
            );
            assert!((sliding.friction / friction - 1.0).abs() < 0.1, "{stiffness} {friction}: {sliding:?}");
        }
        // 60 um of bend: it sticks, and no sensor from 120 to 400 Hz takes that for a good sliding
        for faster in [0.6, 1.0, 2.0] {
            let mut sliding = Sliding::default();
            let actual = round(&still, &mut sliding, [30e3, 1.8, faster], 0.6);
            assert!(
                actual < 1e-6 && sliding.speed.unwrap().abs() < 0.5 * P.stick_slip.sliding,
                "{faster}: {sliding:?}"
            );
        }
    }

    #[test]
    fn a_circle_is_raised_until_the_ball_slides_as_fast_as_desired_and_stays_so() {
        let p = circular();
        for (stiffness, friction) in [(30e3, 1.8), (30e3, 2.4), (20e3, 0.97), (60e3, 2.9)] {
            for time in [2.4, 2.6, 2.8] {
                let mut sliding = Sliding::default();
                let desired = p.stick_slip.sliding;
                let actual = round(&p, &mut sliding, [stiffness, friction, 1.0], time);
                // what slides fast enough without is left alone
                let enough = sliding.added == 0.0 && actual > desired;
                // a ball that never stuck may owe 0.12 of its speed to the sensor
                let doubt = 0.12 * fastest(&p.stick_slip) * (p.stick_slip.velocity + sliding.added);
                assert!(
                    (0.85 * desired..1.15 * desired + doubt).contains(&actual) || enough,
                    "{stiffness} {friction}: {actual} {sliding:?}"
                );
                assert!(!sliding.too_little);
            }
        }
        let mut stuck = Sliding::default();
        round(&p, &mut stuck, [15e3, 1.8, 1.0], 2.6);
        assert!(stuck.too_little && stuck.added == 10e-3, "{stuck:?}");
    }

    #[test]
    fn a_circle_is_never_lowered_to_where_the_ball_stuck() {
        for (p, minimum) in [(circular(), 2.5e-3), (P, 0.0)] {
            let mut sliding = Sliding { added: 2.5e-3, ..Sliding::default() };
            for (speed, added) in
                [(3.5e-3, 2.6e-3..5e-3), (12e-3, minimum..minimum + 1e-9), (12e-3, minimum..minimum + 1e-9)]
            {
                let count = f64::from(window(&p));
                let work = speed * count * p.sample_period;
                sliding = Sliding { samples: window(&p), work, weighted: work, square: 0.5 * count, ..sliding };
                sliding.evaluate(&p);
                assert!(added.contains(&sliding.added), "{sliding:?}");
            }
        }
    }

    #[test]
    fn nothing_slides_in_the_air_or_at_rest() {
        let mut sliding = Sliding::default();
        for k in 0..400 {
            sliding.update(&P, &Vector3::new(0.0, 1e-5 * f64::from(k), 0.0), &measurement(-Vector3::y()), false);
        }
        assert_eq!(sliding.speed, Some(0.0));
        let mut sliding = Sliding::default();
        (0..400).for_each(|_| sliding.update(&P, &Vector3::z(), &measurement(Vector3::zeros()), true));
        assert_eq!(sliding.speed, Some(0.0));
    }

    #[test]
    fn it_is_reported_after_whole_periods_of_a_fifth_of_a_second() {
        for (half, expected) in [(1, 200), (10, 200), (7, 210), (300, 600)] {
            let mut p = P;
            p.stick_slip.half_period = half;
            assert_eq!(window(&p), expected);
        }
    }

    #[test]
    fn what_is_tuned_counts_immediately() {
        let mut sliding = Sliding { added: 8e-3, windows: 3, ..Sliding::default() };
        let tuned = |change: fn(&mut StickSlip)| {
            let mut p = P;
            change(&mut p.stick_slip);
            p
        };
        assert_eq!(sliding.raised(&P), 8e-3);
        assert!((sliding.raised(&tuned(|law| law.velocity = 15e-3)) - 5e-3).abs() < 1e-12);
        assert_eq!(sliding.raised(&tuned(|law| law.velocity = 25e-3)), 0.0);
        assert_eq!(sliding.raised(&tuned(|law| law.ratio = 1.0)), 0.0);
        let off = tuned(|law| law.sliding = 0.0);
        assert_eq!(sliding.raised(&off), 0.0);
        sliding.evaluate(&off);
        assert_eq!((sliding.added, sliding.windows), (0.0, 0));
    }

    #[test]
    fn no_more_is_swept_than_the_drives_accelerate_whatever_was_tuned() {
        let weak = Drive { acceleration_max: 7.0, ..P.drive };
        // (pi / 2) K_v pi / 10 ms
        let accelerated = 7.0 * 2.0 * 10e-3 / std::f64::consts::PI.powi(2);
        // a square wave is rounded as the axes can
        for (mode, maximum) in [(Mode::Circular, accelerated), (Mode::Cross, 30e-3)] {
            for (velocity, ratio) in [(30e-3, 0.0), (0.0, 15.0)] {
                let tuned = StickSlip { velocity, ratio, mode, ..P.stick_slip };
                let p = Parameters { stick_slip: tuned, drive: weak, ..P };
                assert!((Sliding::default().swept(&p, 2e-3) - maximum).abs() < 1e-12, "{mode:?} {ratio}");
            }
        }
    }

    #[test]
    fn friction_is_that_while_it_slides_but_no_less_than_the_force_on_the_whole() {
        let p = Parameters { stick_slip: StickSlip { sliding: 0.0, ..P.stick_slip }, ..P };
        // slides for a quarter of the time against `friction` N, and rests under `rest` N
        let measured = |friction: f64, rest: f64| {
            let mut sliding = Sliding::default();
            for k in 0..400 {
                let (period, k) = (f64::from(k / 200), k % 200);
                let (position, force) = (period * 50.0 + f64::from(k).min(50.0), if k < 50 { friction } else { rest });
                sliding.update(&p, &Vector3::new(0.0, 1e-5 * position, 0.0), &measurement(-force * Vector3::y()), true);
            }
            sliding.friction
        };
        assert!((measured(1.0, 0.0) - 1.0).abs() < 0.1, "{}", measured(1.0, 0.0));
        assert!((measured(0.1, 2.0) - 3f64.sqrt()).abs() < 0.02, "{}", measured(0.1, 2.0));
    }

    #[test]
    fn too_little_raises_it_to_the_maximum_and_is_reported_after_a_second_there_but_not_nearly_enough() {
        // 20 mm/s are the maximum, 10 mm/s are configured
        let slow = |time: f64| moved(&P, 30e3, 3.5, 10e-3, time).0;
        let first = slow(0.201);
        assert!((first.added - RISE * (P.stick_slip.sliding - first.speed.unwrap())).abs() < 1e-12, "{first:?}");
        assert!(slow(0.65).added > 9.9e-3 && !slow(1.59).too_little);
        assert!(matches!(slow(1.65), Sliding { added: 10e-3, too_little: true, .. }), "{:?}", slow(1.65));
        // a ball that slides enough returns to the configured value
        let mut good = moved(&P, 200e3, 1.0, 10e-3, 0.15).0;
        good.added = 1e-3;
        (good.work, good.weighted) = (good.work + 1e-2, good.weighted + 1e-2);
        (good.samples, good.too_little) = (window(&P), true);
        good.evaluate(&P);
        assert!(good.added == 0.0 && !good.too_little, "{good:?}");
        for (ratio, expected) in [(0.95, false), (0.85, true)] {
            let mut maximum = Sliding::default();
            (0..WINDOWS).for_each(|_| maximum.add_to_evaluation(&P, ratio * P.stick_slip.sliding, true));
            assert_eq!(maximum.too_little, expected, "{ratio}");
        }
    }

    #[test]
    fn the_half_period_is_raised_once_at_the_end_of_a_period_and_then_it_is_too_little() {
        let mut p = P;
        p.stick_slip.half_period_max = 30;
        let slow = |sliding: &mut Sliding, p: &Parameters| {
            (0..WINDOWS).for_each(|_| sliding.add_to_evaluation(p, 0.85 * p.stick_slip.sliding, true));
        };
        let mut sliding = Sliding { added: 10e-3, stuck: 19e-3, speed: Some(5e-3), ..Sliding::default() };
        assert!(!sliding.restarts(&p, 20));
        slow(&mut sliding, &p);
        assert!(!sliding.too_little && !sliding.restarts(&p, 30) && sliding.restarts(&p, 40));
        let begun = Sliding { lengthened: 20, speed: sliding.speed, ..Sliding::default() };
        assert_eq!(sliding, begun);
        p.stick_slip.half_period = 30;
        slow(&mut sliding, &p);
        assert!(sliding.too_little && !sliding.restarts(&p, 60) && sliding.lengthened == 20);
        // what nothing asks for any more ends with the period
        for tuned in [StickSlip { sliding: 0.0, ..p.stick_slip }, StickSlip { ratio: 5.0, ..p.stick_slip }] {
            let (p, mut sliding) = (Parameters { stick_slip: tuned, ..p.clone() }, sliding);
            assert!(!sliding.restarts(&p, 59) && sliding.restarts(&p, 60) && sliding.lengthened == 0);
        }
        // and what was too short before is not raised
        (sliding, p.stick_slip.half_period) = (Sliding::default(), 10);
        slow(&mut sliding, &p);
        p.stick_slip.sliding = 0.0;
        sliding.evaluate(&p);
        assert!(!sliding.restarts(&p, 20));
    }
}
