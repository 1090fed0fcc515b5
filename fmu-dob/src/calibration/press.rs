//! Force of a touch, by the momentum that it takes from the stage.
//!
//! A fast touch ends before the observer shows its force, and the braking force hides the rest. The momentum of the
//! stage shows it. With P = int (F_t - F_0) dt of the thrust F_t relative to the holding force F_0 before, a stage that
//! arrived at v and moves at v' has lost J = g P - M_n (v' - v) - B int (v' - v) dt to the workpiece. A commissioning
//! run identifies g, the ratio of actual to nominal thrust, and the friction B. Without it g is the slope of the
//! momentum over P while the stage oscillates after the reversal, and B is 0. The force over the depth x is J / int x
//! dt.

use control_blocks::ticks;
use serde::{Deserialize, Serialize};

use crate::interface::{Measured, Parameters};

/// Time constant of the holding force before the touch, s.
const BEFORE: f64 = 0.01;
/// The momentum is evaluated in this time after the detection, s: the contact has ended, and the stage still
/// oscillates.
const AFTER: [f64; 2] = [2e-3, 6e-3];
/// Ratio of maximum force over maximum depth to the mean of the touch, because one flute touches before the other:
/// measured 1.2 at 300 um/s and 1.3 at 130 um/s, for tools whose flutes differ by 0.1 to 0.3 um.
const FLUTES: f64 = 1.25;
/// Minimum divisor: far below a nanometer for a sample, m s, and the square of the slowest speed, m2/s2.
const TINY: f64 = 1e-20;

/// Drive and stage as measured, in addition to the parameters.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    /// Ratio of the measured to the configured thrust.
    pub gain: Option<f64>,
    /// How much later than `io_delay` samples the current acts, without its loop, s.
    pub late: f64,
    /// Viscous friction, N s/m.
    pub damping: f64,
}

impl Drive {
    /// By a successful commissioning run, otherwise unknown.
    pub fn of(p: &Parameters, measured: &Measured) -> Self {
        if !measured.valid {
            return Self { gain: None, late: 0.0, damping: 0.0 };
        }
        Self {
            gain: Some(measured.force_constant / p.stage.force_constant),
            late: (measured.io_delay - f64::from(p.io_delay)) * p.sample_period,
            damping: measured.damping,
        }
    }
}

/// Force of consecutive touches; by default none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Press {
    /// thrust before the touch, N
    before: f64,
    /// thrust relative to that, downstream of the current loop, N
    acting: f64,
    /// P, N s
    push: f64,
    /// int (v' - v) dt, m
    away: f64,
    /// time integral of the depth, m s
    area: f64,
    depth: f64,
    deepest: f64,
    /// samples since the contact was found
    since: u32,
    /// sums over the samples after it: one, P, M_n (v' - v) + B int (v' - v) dt, P^2, and their product
    sums: [f64; 5],
}

impl Press {
    /// Takes the depth (m) of the tool below the surface, negative before it, where the position is known, with the
    /// current that acted (A), and whether the contact was found in an approach at `velocity` m/s.
    pub fn update(
        &mut self,
        p: &Parameters,
        drive: &Drive,
        depth: Option<f64>,
        acted: f64,
        velocity: f64,
        found: bool,
    ) {
        let thrust = p.stage.force_constant * acted;
        // the position after a lost one contains the motion of both samples
        let depth = depth.unwrap_or(self.depth);
        if !found && (depth <= 0.0 || self.since > 0) {
            let before = self.before + (thrust - self.before) * p.sample_period / BEFORE;
            *self = Self { before, depth, ..Self::default() };
            return;
        }
        let [dt, extra] = [p.sample_period, thrust - self.before];
        // first-order current loop under a constant command
        let ahead = (self.acting - extra) * -(-p.stage.current_bandwidth * dt).exp_m1();
        let impulse = extra * dt + ahead / p.stage.current_bandwidth;
        let moved = depth - self.depth - velocity * dt;
        let [from, to] = AFTER.map(|time| ticks(time, dt));
        if self.since < from {
            self.area += depth.max(0.0) * dt;
            self.deepest = self.deepest.max(depth);
        } else if self.since <= to {
            // in the middle of the sample, where its motion gives the speed
            let push = self.push + impulse * (0.5 - drive.late / dt);
            let momentum = p.stage.mass * moved / dt + drive.damping * (self.away + 0.5 * moved);
            let terms = [1.0, push, momentum, push * push, push * momentum];
            self.sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        self.acting -= ahead;
        self.push += impulse;
        self.away += moved;
        self.depth = depth;
        self.since = self.since.saturating_add(u32::from(found));
    }

    /// Largest force of the last touch, N.
    pub fn force(&self, drive: &Drive) -> f64 {
        let [n, push, momentum, squares, products] = self.sums;
        let slope = (n * products - push * momentum) / (n * squares - push * push).max(TINY);
        let taken = (drive.gain.unwrap_or(slope) * push - momentum) / n.max(1.0);
        FLUTES * taken / self.area.max(TINY) * self.deepest
    }
}

/// Force of touches over their speed; by default of none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Hardness {
    products: f64,
    squares: f64,
    steepest: f64,
    fastest: f64,
}

impl Hardness {
    /// Takes the maximum force (N) of a touch at `velocity` m/s; `fast`: its ratio of force and speed is significant by
    /// itself.
    pub fn push(&mut self, velocity: f64, force: f64, fast: bool) {
        self.products += velocity * force;
        self.squares += velocity * velocity;
        self.steepest = self.steepest.max(if fast { force / velocity } else { 0.0 });
        self.fastest = self.fastest.max(velocity);
    }

    /// The fastest of them, m/s.
    pub fn fastest(&self) -> f64 {
        self.fastest
    }

    /// Force over speed by least squares through zero (N s/m), more than zero.
    pub fn slope(&self) -> f64 {
        (self.products / self.squares.max(TINY)).max(TINY)
    }

    /// The largest force over speed of a fast touch (N s/m); before there is one, that of all.
    pub fn steepest(&self) -> f64 {
        if self.steepest > 0.0 { self.steepest } else { self.slope() }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A touch of a stage with a holding force of `weight` N, whose drive has `gain` times the configured thrust after
    /// its current loop.
    #[derive(Clone, Copy, Debug)]
    struct Touch {
        velocity: f64,
        weight: f64,
        stiffness: f64,
        seen: f64,
        gain: f64,
        damping: f64,
        /// samples in which nothing is read
        lost: [i32; 2],
    }

    impl Touch {
        /// Result of a commissioning run.
        fn drive(&self) -> Drive {
            Drive { gain: Some(self.gain), late: 0.0, damping: self.damping }
        }

        /// Its estimated force, and the actual one, on a workpiece that both flutes touch simultaneously, N.
        fn forces(&self, press: &mut Press, drive: &Drive) -> [f64; 2] {
            let p = Parameters::START;
            let (dt, mass, fine) = (p.sample_period, p.stage.mass, p.sample_period / 50.0);
            let (mut depth, mut v, mut actual) = (-1000.0 * self.velocity * dt, self.velocity, 0.0f64);
            let (mut command, mut acting) = (0.0, 0.0);
            for k in -1000..200 {
                let (time, found) = (f64::from(k) * dt - self.seen, f64::from(k) * dt >= self.seen);
                // the reversal in 0.6 ms, then an oscillation of 6 ms
                let torque = if (0.6e-3..6.6e-3).contains(&time) { (TAU * time / 6e-3).sin() } else { 0.0 };
                let next = if found && time < 0.6e-3 { -20.0 } else { 3.0 * torque };
                // a command that acts a sample late is reported before it acts
                let commanded = if drive.late > 0.0 { next } else { command };
                let thrust = (self.weight + self.damping * self.velocity + commanded) / self.gain;
                let read = (!self.lost.contains(&k)).then_some(depth);
                press.update(&p, drive, read, thrust / p.stage.force_constant, self.velocity, found);
                command = next;
                for _ in 0..50 {
                    let force = self.stiffness * depth.max(0.0);
                    actual = actual.max(force);
                    acting += (command - acting) * p.stage.current_bandwidth * fine;
                    v += (acting - force - self.damping * (v - self.velocity)) / mass * fine;
                    depth += v * fine;
                }
            }
            [press.force(drive) / FLUTES, actual]
        }
    }

    const UNKNOWN: Drive = Drive { gain: None, late: 0.0, damping: 0.0 };
    const FAST: Touch =
        Touch { velocity: 3e-4, weight: 0.4, stiffness: 4e6, seen: 8e-4, gain: 1.0, damping: 0.0, lost: [i32::MAX; 2] };

    #[test]
    fn the_momentum_of_a_touch_gives_its_largest_force() {
        let mut press = Press::default();
        for touch in [
            FAST,
            Touch { velocity: 1.3e-4, weight: -0.3, stiffness: 2e6, seen: 1.5e-3, gain: 1.3, ..FAST },
            Touch { gain: 0.8, damping: 30.0, ..FAST },
        ] {
            let commissioned = touch.forces(&mut press, &touch.drive());
            let frictionless = Touch { damping: 0.0, ..touch };
            // the mean of a half sine over its largest value, 2 / pi, is the same for force and depth
            for [estimated, actual] in [commissioned, frictionless.forces(&mut press, &UNKNOWN)] {
                assert!((estimated / actual - 1.0).abs() < 0.05, "{touch:?}: {estimated} N of {actual} N");
            }
        }
        let [estimated, actual] = FAST.forces(&mut press, &Drive { late: 1e-4, ..FAST.drive() });
        assert!((estimated / actual - 1.0).abs() < 0.05, "late: {estimated} N of {actual} N");
        // in the reversal, and after it
        for lost in [[10, 11], [40, 41]] {
            let [estimated, actual] = Touch { lost, ..FAST }.forces(&mut press, &FAST.drive());
            assert!((estimated / actual - 1.0).abs() < 0.1, "lost {lost:?}: {estimated} N of {actual} N");
        }
        // the next approach has not touched yet, wherever it begins, and may touch nothing
        for depth in [-1e-6, 1e-6] {
            let mut next = press;
            next.update(&Parameters::START, &UNKNOWN, Some(depth), 0.0, 1e-4, false);
            assert_eq!(next.force(&UNKNOWN), 0.0);
        }
        assert!(Touch { stiffness: 0.0, ..FAST }.forces(&mut press, &FAST.drive())[0].abs() < 0.02);
    }

    #[test]
    fn a_current_that_comes_later_than_configured_is_known_by_a_commission() {
        let mut p = Parameters::START;
        let mut measured =
            Measured { valid: true, force_constant: 18.0, io_delay: 0.75, damping: 12.0, ..Measured::START };
        let drive = Drive::of(&p, &measured);
        assert_eq!((drive.gain, drive.damping), (Some(0.9), 12.0));
        assert!((drive.late + 2.5e-5).abs() < 1e-18);
        p.io_delay = 0;
        assert!((Drive::of(&p, &measured).late - 7.5e-5).abs() < 1e-18);
        measured.valid = false;
        assert_eq!(Drive::of(&p, &measured).gain, None);
    }

    #[test]
    fn a_position_that_is_never_reached_shows_no_force() {
        let p = Parameters::START;
        let mut press = Press::default();
        (0..100).for_each(|k| press.update(&p, &UNKNOWN, Some(-1e-6), 0.1 * f64::from(k), 1e-4, k > 10));
        assert_eq!(press.force(&UNKNOWN), 0.0);
    }

    #[test]
    fn touches_count_for_the_slope_as_the_square_of_their_speed_and_the_hardest_fast_one_is_the_steepest() {
        let mut hardness = Hardness::default();
        assert!(hardness.slope() > 0.0 && hardness.slope() < 1e-9);
        hardness.push(1e-4, 0.4, false);
        assert!((hardness.slope() - 4e3).abs() < 1e-9 && hardness.steepest() == hardness.slope());
        hardness.push(3e-4, 0.9, true);
        assert!((hardness.slope() - (4e-5 + 27e-5) / 10e-8).abs() < 1e-9);
        assert!((hardness.steepest() - 3e3).abs() < 1e-9);
        hardness.push(2e-4, -9.0, true);
        assert_eq!(hardness.fastest(), 3e-4);
        assert!((hardness.steepest() - 3e3).abs() < 1e-9 && hardness.slope() < 1e-9 && hardness.slope() > 0.0);
    }
}
