//! One axis whose readings may be lost.
//!
//! An axis has inertia: with the velocity v of its last two readings, n samples later it is at y + n v T_s, within
//! n w + a T_s^2 n (n + 1) / 2 for the spread w of a reading and the acceleration a that may come. A reading elsewhere, none at
//! all, and one that stands while the axis moves (v T_s > w) are lost; y + n v T_s stands in for them.
//!
//! Two readings make a velocity, the third confirms both. Until then each is believed and the velocity is taken anew, for the first
//! may be the bad one.

use control_blocks::{JumpGuard, Reach, believable, wrap};
use serde::{Deserialize, Serialize};

/// What a good reading gives back of a lost one: one of three may be lost for ever.
const REGAINED: f64 = 0.5;
/// So many times what may be lost in a row may be lost in all: 4 ms of every second reading. Of readings lost by chance, one
/// in fifty, four in a row come every 11 min, of one in a hundred every 3 h.
const IN_ALL: f64 = 3.0;

/// Why a reading is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Loss {
    /// It is no number, or absurd.
    Invalid,
    /// It is where the axis cannot be.
    Jump,
    /// It stands while the axis moves.
    Frozen,
}

/// How an axis can move.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Largest believable reading.
    pub most: f64,
    /// Largest difference of two readings at rest.
    pub spread: f64,
    /// Largest velocity that is not foreseen, per sample.
    pub motion: f64,
    /// Largest change of the velocity from one sample to the next, per sample.
    pub change: f64,
    /// It may run already when it is read first.
    pub runs: bool,
    /// Readings in a row that may be lost.
    pub lost: u32,
}

/// A reading with what is known of its axis; by default nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GuardedAxis {
    guard: JumpGuard,
    raw: Option<f64>,
    /// the last believed reading and the velocity that it and the one before give, per sample
    last: Option<f64>,
    velocity: Option<f64>,
    /// a reading was where the two before it said
    confirmed: bool,
    /// place and velocity can be used
    known: bool,
    /// it was seen to move, and was read several times where it stood before
    moved: bool,
    stood: bool,
    /// samples since the last believed reading
    age: u32,
    /// readings lost, less what the good ones gave back
    spent: f64,
    /// the readings lost since the last believed one stand where that was
    standing: bool,
    loss: Option<Loss>,
}

impl GuardedAxis {
    /// Takes a reading; gives the one to use.
    pub fn update(&mut self, raw: f64, axis: &Axis) -> f64 {
        // what is lost for good is not waited for with ever less doubt
        self.age = self.age.saturating_add(1).min(axis.lost + 1);
        let (velocity, n) = (self.velocity.unwrap_or_default(), f64::from(self.age));
        let (valid, again) = (believable(raw, axis.most), self.raw.replace(raw) == Some(raw));
        let stands = again && velocity.abs() > axis.spread && (self.confirmed || self.stood);
        self.guard.shift(velocity);
        // two equal readings may be one that was read twice
        let begins = self.velocity.is_none() || (axis.runs && !self.moved);
        let spread = n * axis.spread + 0.5 * axis.change * n * (n + 1.0);
        // what was lost for good is not believed again before `begin_anew`
        let given_up = self.exhausted(axis);
        let usable = valid && !stands && !given_up;
        // a last bit may flicker, and all that is lost in a row must stand
        self.standing &= self.last.is_some_and(|last| (raw - last).abs() <= axis.spread);
        let raw = if usable { raw } else { f64::NAN };
        let reach = Reach { motion: axis.motion, spread };
        self.confirmed |= !begins && self.guard.reaches(raw, reach);
        let motion = if self.confirmed { axis.motion } else { f64::INFINITY };
        let used = self.guard.update(raw, Reach { motion, spread });
        if self.guard.doubted() == 0 {
            self.velocity = self.last.replace(used).map(|last| (used - last) / n);
            self.stood = !self.moved && n > 1.0;
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
        let near = if believable(raw, axis.most) { expected + wrap(raw - expected) } else { f64::NAN };
        let used = self.update(near, axis);
        if self.guard.doubted() == 0 { raw } else { used }
    }

    /// Whether more readings are lost than may be.
    fn exhausted(&self, axis: &Axis) -> bool {
        self.guard.doubted() > axis.lost || self.spent > IN_ALL * f64::from(axis.lost)
    }

    /// Why so many readings are lost, if they are.
    pub fn lost(&self, axis: &Axis) -> Option<Loss> {
        self.loss.filter(|_| self.exhausted(axis))
    }

    /// Whether place and velocity are known; of what runs already when two readings tell them, of what may rest when these agree.
    pub fn known(&self) -> bool {
        self.known
    }

    /// Whether two readings have told them and no third has confirmed them yet.
    pub fn begins(&self) -> bool {
        self.velocity.is_some() && !self.confirmed
    }

    /// Velocity that the last two believed readings give, per sample; 0 before there are two.
    pub fn motion(&self) -> f64 {
        self.velocity.unwrap_or_default()
    }
}
