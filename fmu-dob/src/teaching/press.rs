//! How hard a touch presses, by the momentum that it takes from the stage.
//!
//! A fast touch is over before the observer has felt it, and hides behind the force of the turn. But the stage has a momentum less behind it: with
//! P = int (F_t - F_0) dt of the thrust F_t beside what held the stage before, F_0, a stage that came at v and goes at v' now has taken
//! J = g P - M_n (v' - v) from the work. The stage swings after the turn; while it does, the line of M_n (v' - v) over P tells J and with it g, by which
//! the thrust is other than told. Force over depth x is J / int x dt, and the largest force that at the largest depth.

use control_blocks::ticks;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Time constant of what holds the stage before, s.
const BEFORE: f64 = 0.01;
/// The line is drawn in this time after the contact was found, s: it is gone, and friction has not taken much yet.
const LINE: [f64; 2] = [2e-3, 6e-3];
/// Least divisor: far below a nanometre for a sample, m s, and the square of the slowest speed, m2/s2.
const LEAST: f64 = 1e-20;

/// One touch after the other; by default none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Press {
    /// thrust before the touch, N
    before: f64,
    /// P, N s
    push: f64,
    /// time integral of the depth, m s
    area: f64,
    depth: f64,
    deepest: f64,
    /// samples since the contact was found
    since: u32,
    /// sums of the line: one, P, M_n (v' - v), P^2, P M_n (v' - v)
    sums: [f64; 5],
}

impl Press {
    /// Takes how deep (m) the tool is behind the place of the work, less than zero before, with the current that acted (A), how much later (s) than told it
    /// acts, and whether the contact was found in an approach at `velocity` m/s.
    pub fn update(&mut self, p: &Parameters, depth: f64, acted: f64, late: f64, velocity: f64, found: bool) {
        let thrust = p.stage.force_constant * acted;
        if !found && depth <= 0.0 {
            let before = self.before + (thrust - self.before) * p.sample_period / BEFORE;
            *self = Self { before, depth, ..Self::default() };
            return;
        }
        let [from, to] = LINE.map(|time| ticks(time, p.sample_period));
        let extra = thrust - self.before;
        if self.since < from {
            self.area += depth.max(0.0) * p.sample_period;
            self.deepest = self.deepest.max(depth);
        } else if self.since <= to {
            // in the middle of the sample, where its motion tells the speed
            let push = self.push + extra * (0.5 * p.sample_period - late);
            let momentum = p.stage.mass * ((depth - self.depth) / p.sample_period - velocity);
            let terms = [1.0, push, momentum, push * push, push * momentum];
            self.sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        self.push += extra * p.sample_period;
        self.depth = depth;
        self.since = self.since.saturating_add(u32::from(found));
    }

    /// Largest force of the last touch, N.
    pub fn force(&self) -> f64 {
        let [n, push, momentum, squares, products] = self.sums;
        let gain = (n * products - push * momentum) / (n * squares - push * push).max(LEAST);
        let taken = (gain * push - momentum) / n.max(1.0);
        taken / self.area.max(LEAST) * self.deepest
    }
}

/// Force of touches over their speed, by least squares through zero; by default of none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Hardness {
    products: f64,
    squares: f64,
    fastest: f64,
}

impl Hardness {
    /// Takes the largest force (N) of a touch at `velocity` m/s.
    pub fn push(&mut self, velocity: f64, force: f64) {
        self.products += velocity * force;
        self.squares += velocity * velocity;
        self.fastest = self.fastest.max(velocity);
    }

    /// The fastest of them, m/s.
    pub fn fastest(&self) -> f64 {
        self.fastest
    }

    /// Force over speed (N s/m), more than zero.
    pub fn slope(&self) -> f64 {
        (self.products / self.squares.max(LEAST)).max(LEAST)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A touch of a stage that is held against `weight` N, and whose drive does `gain` times what is told.
    #[derive(Clone, Copy)]
    struct Touch {
        velocity: f64,
        weight: f64,
        stiffness: f64,
        seen: f64,
        gain: f64,
    }

    /// Its force as told, and the true one, N.
    fn forces(press: &mut Press, touch: Touch) -> [f64; 2] {
        let Touch { velocity, weight, stiffness, seen, gain } = touch;
        let p = Parameters::START;
        let (dt, mass) = (p.sample_period, p.stage.mass);
        let (mut depth, mut v, mut truth, mut turn) = (-1000.0 * velocity * dt, velocity, 0.0f64, 0.0);
        for k in -1000..200 {
            let (time, found) = (f64::from(k) * dt - seen, f64::from(k) * dt >= seen);
            // the turn in 0.6 ms, then a swing in 6 ms
            let swing = if (0.6e-3..6.6e-3).contains(&time) { (TAU * time / 6e-3).sin() } else { 0.0 };
            press.update(&p, depth, (weight + turn) / gain / p.stage.force_constant, 0.0, velocity, found);
            turn = if found && time < 0.6e-3 { -20.0 } else { 3.0 * swing };
            for _ in 0..20 {
                let force = stiffness * depth.max(0.0);
                truth = truth.max(force);
                v += (turn - force) / mass * dt / 20.0;
                depth += v * dt / 20.0;
            }
        }
        [press.force(), truth]
    }

    const FAST: Touch = Touch { velocity: 3e-4, weight: 0.4, stiffness: 4e6, seen: 8e-4, gain: 1.0 };

    #[test]
    fn the_momentum_of_a_touch_tells_its_largest_force() {
        let mut press = Press::default();
        for touch in [
            FAST,
            Touch { gain: 0.8, ..FAST },
            Touch { velocity: 1.3e-4, weight: -0.3, stiffness: 2e6, seen: 1.5e-3, gain: 1.3 },
            Touch { velocity: 2.3e-5, weight: 0.0, stiffness: 2e6, seen: 5e-3, gain: 1.0 },
        ] {
            let [told, truth] = forces(&mut press, touch);
            assert!((told / truth - 1.0).abs() < 0.03, "{}: {told} N of {truth} N", touch.velocity);
        }
        // the next approach has not touched yet, and may touch nothing
        press.update(&Parameters::START, -1e-6, 0.0, 0.0, 1e-4, false);
        assert_eq!(press.force(), 0.0);
        assert!(forces(&mut press, Touch { stiffness: 0.0, ..FAST })[0].abs() < 1e-2);
    }

    #[test]
    fn a_place_that_is_never_reached_tells_no_force() {
        let p = Parameters::START;
        let mut press = Press::default();
        (0..100).for_each(|k| press.update(&p, -1e-6, 0.1 * f64::from(k), 0.0, 1e-4, k > 10));
        assert_eq!(press.force(), 0.0);
    }

    #[test]
    fn the_fast_touches_count_for_the_slope_as_the_square_of_their_speed() {
        let mut hardness = Hardness::default();
        assert!(hardness.slope() > 0.0 && hardness.slope() < 1e-9);
        hardness.push(1e-4, 0.2);
        assert!((hardness.slope() - 2e3).abs() < 1e-9);
        hardness.push(3e-4, 0.9);
        assert!((hardness.slope() - (2e-5 + 27e-5) / 10e-8).abs() < 1e-9);
        hardness.push(2e-4, -9.0);
        assert_eq!(hardness.fastest(), 3e-4);
        assert!(hardness.slope() > 0.0 && hardness.slope() < 1e-9);
    }
}
