//! One axis whose measurements may be missing or implausible.
//!
//! An axis has inertia: with the velocity v of its last two samples, n samples later it is at y + n v T_s, within
//! n w + a T_s^2 n (n + 1) / 2 for the spread w of a sample and the largest acceleration a. A sample outside of that,
//! an invalid one, and one that is frozen while the axis moves (v T_s > w) are lost; y + n v T_s replaces them.
//!
//! Two samples give a velocity, the third confirms both. Until then each is accepted and the velocity is computed
//! again, because the first may be the bad one.

use control_blocks::{JumpGuard, Reach, is_plausible, wrap};
use serde::{Deserialize, Serialize};

/// Budget that a good sample restores: one of three samples may be lost forever.
const REGAINED: f64 = 0.5;
/// Ratio of all lost samples to consecutive ones: 4 ms of every second sample. If one in fifty samples is lost at
/// random, four consecutive ones occur every 11 min; with one in a hundred every 3 h.
const IN_ALL: f64 = 3.0;

/// Why a sample is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Loss {
    /// It is not a number, or out of range.
    Invalid,
    /// It is where the axis cannot be.
    Jump,
    /// It is frozen while the axis moves.
    Frozen,
}

/// How an axis can move.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Largest accepted value.
    pub maximum: f64,
    /// Largest difference of two samples at rest.
    pub spread: f64,
    /// Largest velocity that is not foreseen, per sample.
    pub motion: f64,
    /// Largest change of the velocity from one sample to the next, per sample.
    pub change: f64,
    /// It may run already when it is read first.
    pub runs: bool,
    /// Consecutive samples that may be lost.
    pub lost: u32,
}

/// A measured axis with its state; by default unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GuardedAxis {
    guard: JumpGuard,
    raw: Option<f64>,
    /// the last accepted value, and the velocity from it and the one before, per sample
    last: Option<f64>,
    velocity: Option<f64>,
    /// a sample agreed with the two before it
    confirmed: bool,
    /// place and velocity can be used
    known: bool,
    /// it has moved, and was sampled several times at rest before
    moved: bool,
    was_frozen: bool,
    /// samples since the last accepted one
    age: u32,
    /// lost samples, less those restored by good ones
    spent: f64,
    /// all samples lost since the last accepted one equal it
    standing: bool,
    loss: Option<Loss>,
}

impl GuardedAxis {
    /// Takes a sample; returns the value to use.
    pub fn update(&mut self, raw: f64, axis: &Axis) -> f64 {
        // the tolerance must not grow forever after a permanent loss
        self.age = self.age.saturating_add(1).min(axis.lost + 1);
        let (velocity, n) = (self.velocity.unwrap_or_default(), f64::from(self.age));
        let (valid, again) = (is_plausible(raw, axis.maximum), self.raw.replace(raw) == Some(raw));
        let frozen = again && velocity.abs() > axis.spread && (self.confirmed || self.was_frozen);
        self.guard.shift(velocity);
        // two equal samples may be one that was sampled twice
        let begins = self.velocity.is_none() || (axis.runs && !self.moved);
        let spread = n * axis.spread + 0.5 * axis.change * n * (n + 1.0);
        // after a permanent loss nothing is accepted before `restart`
        let given_up = self.exhausted(axis);
        let usable = valid && !frozen && !given_up;
        // a last bit may flicker, and all consecutive lost samples must be frozen
        self.standing &= self.last.is_some_and(|last| (raw - last).abs() <= axis.spread);
        let raw = if usable { raw } else { f64::NAN };
        let reach = Reach { motion: axis.motion, spread };
        self.confirmed |= !begins && self.guard.reaches(raw, reach);
        let motion = if self.confirmed { axis.motion } else { f64::INFINITY };
        let used = self.guard.update(raw, Reach { motion, spread });
        if self.guard.doubted() == 0 {
            self.velocity = self.last.replace(used).map(|last| (used - last) / n);
            self.was_frozen = !self.moved && n > 1.0;
            self.moved |= self.velocity.is_some_and(|velocity| velocity != 0.0);
            self.standing = true;
            if begins || self.confirmed {
                self.spent = (self.spent - REGAINED).max(0.0);
                self.loss = None;
            } else {
                self.spent += 1.0;
                self.loss = Some(Loss::Jump);
            }
            // what runs and was read several times has run for as long
            if self.moved || !(again && axis.runs) {
                self.age = 0;
            }
        } else if !given_up {
            self.spent += 1.0;
            self.loss = Some(if !valid {
                Loss::Invalid
            } else if self.standing {
                Loss::Frozen
            } else {
                Loss::Jump
            });
        }
        let rests = self.velocity.is_some_and(|velocity| velocity.abs() <= axis.motion + axis.spread);
        self.known = self.velocity.is_some() && self.loss.is_none() && (self.confirmed || axis.runs || rests);
        used
    }

    /// The same for an angle that may be wrapped.
    pub fn update_angle(&mut self, raw: f64, axis: &Axis) -> f64 {
        let expected = self.last.unwrap_or(raw) + self.velocity.unwrap_or_default() * f64::from(self.age + 1);
        let near = if is_plausible(raw, axis.maximum) { expected + wrap(raw - expected) } else { f64::NAN };
        let used = self.update(near, axis);
        if self.guard.doubted() == 0 { raw } else { used }
    }

    /// Whether too many samples are lost.
    fn exhausted(&self, axis: &Axis) -> bool {
        self.guard.doubted() > axis.lost || self.spent > IN_ALL * f64::from(axis.lost)
    }

    /// Why too many samples are lost, if they are.
    pub fn lost(&self, axis: &Axis) -> Option<Loss> {
        self.loss.filter(|_| self.exhausted(axis))
    }

    /// Whether position and velocity are known: after two samples for an axis that may run already, otherwise after two
    /// equal ones.
    pub fn known(&self) -> bool {
        self.known
    }

    /// Whether two samples have given them and no third has confirmed them yet.
    pub fn begins(&self) -> bool {
        self.velocity.is_some() && !self.confirmed
    }

    /// Velocity from the last two accepted samples, per sample; 0 before there are two.
    pub fn motion(&self) -> f64 {
        self.velocity.unwrap_or_default()
    }
}
