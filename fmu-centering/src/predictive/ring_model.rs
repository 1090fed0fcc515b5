//! Recursive model of the ring: where its center is, how far the line of measurement, and what form it has.
//!
//! One scalar measurement y = s - q at a time, through the exact geometry (`ring_line`), so that a part of a revolution is
//! enough once b0 and the form are known, and all angles count at once. The covariance says how much is known.
//!
//! The geometry is linearised at the present estimate, which is poor at first. So the measurements since the ring was
//! last moved are kept, and all of them are taken in again at the better estimate now and then (Gauss-Newton).
//!
//! Most rings are ground: few orders of form are enough, and every order more makes a part of a revolution worth less. Where
//! they do not explain what was measured, the ring is taken to have any form.

use arrayvec::ArrayVec;
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use crate::predictive::any_form::AnyForm;
use crate::predictive::assumptions::Assumptions;
use crate::predictive::ground_ring::GroundRing;
use crate::predictive::refit::Purpose;
use crate::predictive::ring_estimate::{Known, MISFIT_MAX};
use crate::predictive::ring_line::{ANY, GROUND};

/// Measurements kept: more than a revolution at 20 rpm and 66 Hz; later ones are taken in only once.
const HISTORY: usize = 256;
/// A ring that leaves its model by more than so many times the noise is no ground one (our choice: what was told may be wrong),
/// if more than this share of the measurements does by more than so many times the noise: dirt has less of the surface.
const WIDEN: f64 = 3.0;
const COARSE: (f64, f64) = (0.25, 2.0);
/// Least share of the measurements that a rough ring explains; else some of them belong to another place of the ring.
const EXPLAINED: f64 = 0.9;

/// What is known of the ring.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RingModel {
    assumed: Assumptions,
    ground: GroundRing,
    /// of any form, where a ground ring does not explain what was measured; in force from its first fit on
    any: Option<AnyForm>,
    /// angles (rad) and measurements (m) since the ring was moved
    history: ArrayVec<(f64, f64), HISTORY>,
    rejections: u32,
    late: bool,
}

impl RingModel {
    /// Nothing known but the assumptions.
    pub fn new(assumed: Assumptions) -> Self {
        let ground = GroundRing::new(assumed);
        Self { assumed, ground, any: None, history: ArrayVec::new_const(), rejections: 0, late: false }
    }

    /// Notes whether the probe tells later than the slide: what it leaves then is no form.
    pub fn note_late(&mut self, late: bool) {
        self.late = late;
    }

    /// Takes in y = s - q (m) at the spindle angle (rad); false if it was taken for dirt.
    pub fn observe(&mut self, angle: f64, y: f64) -> bool {
        let waited = self.waits();
        if !self.history.is_full() {
            self.history.push((angle, y));
        }
        if !self.known_mut().observe(angle, y) {
            self.rejections += 1;
            return false;
        }
        // one that fits by chance tells no more than those that do not, not even the last that was waited for
        if !waited {
            self.rejections = 0;
        }
        if self.history.is_full() {
            self.known_mut().linearise();
        }
        true
    }

    /// Takes in the history again, linearised at what is known by now, then with less weight for what does not fit;
    /// does nothing if later measurements are not kept, or if there are none yet. A model of any form only begins it.
    pub fn refine(&mut self) {
        if self.history.is_empty() || self.history.is_full() {
            return;
        }
        let Some(any) = &mut self.any else {
            self.ground.fit(1.0, &self.history);
            if self.coarse() {
                self.widen();
            }
            return;
        };
        if any.fitting().is_none() {
            any.begin(Purpose::Refine);
        }
    }

    /// Makes the next pass of a fit that is under way, or begins one that may explain why so many measurements were rejected;
    /// false where none does: the ring was moved.
    pub fn advance(&mut self) -> bool {
        if self.history.is_full() {
            self.give_up();
        }
        let Some((any, purpose)) = self.any.as_mut().and_then(|any| any.fitting().map(|purpose| (any, purpose))) else {
            return !self.lost() || self.waits() || self.reconsider();
        };
        any.advance(&self.history);
        if any.fitting().is_some() || !self.lost() || self.explains() {
            return true;
        }
        match purpose {
            Purpose::Widen => {
                self.any = None;
                self.roughen()
            }
            Purpose::Refine => true,
            Purpose::Reconsider => false,
        }
    }

    /// Whether what is in force may be about to change: too much was rejected, or a ring of any form is tried.
    pub fn undecided(&self) -> bool {
        self.lost() || self.tried()
    }

    fn tried(&self) -> bool {
        self.any.as_ref().is_some_and(|any| any.fitting() == Some(Purpose::Widen))
    }

    /// Later measurements are not kept, so that no fit has them all.
    fn give_up(&mut self) {
        if self.tried() {
            self.any = None;
        } else if let Some(any) = &mut self.any {
            any.give_up();
        }
    }

    /// Whether a ground ring leaves its model by more than noise and dirt do; a few measurements fit any model.
    fn coarse(&self) -> bool {
        let ring = &self.ground.estimate;
        let far = COARSE.1 * self.assumed.noise;
        let beyond = || self.history.iter().filter(|(angle, y)| (y - ring.line(*angle)).abs() > far).count();
        self.history.len() > 2 * ANY && ring.misfit > WIDEN && beyond() as f64 > COARSE.0 * self.history.len() as f64
    }

    /// Whether more form may explain anything: what a late probe tells is none, and a round ring has none.
    fn widens(&self) -> bool {
        self.assumed.form > 0.0 && !self.late
    }

    /// Begins to try whether a ring of any form explains what was measured; a few measurements are explained by any.
    fn widen(&mut self) {
        let (center, sigma) = self.ground.told();
        let tell = self.history.len() > 2 * GROUND && self.widens();
        self.any = tell.then(|| AnyForm::new(self.assumed, center, sigma, &self.ground.estimate.now.mean));
    }

    /// Begins to find out whether a ring that has more form than assumed, or is rougher, explains what was rejected; false where
    /// none can.
    fn reconsider(&mut self) -> bool {
        if self.history.is_full() {
            return false;
        }
        match &mut self.any {
            Some(any) => any.begin(Purpose::Reconsider),
            None => self.widen(),
        }
        self.any.is_some() || self.roughen()
    }

    /// Whether too much was rejected of a ring of which nothing was known before, and more measurements may tell that it has more
    /// form than assumed: so few are explained by any roughness, too.
    fn waits(&self) -> bool {
        let few = self.any.is_none() && self.history.len() <= 2 * GROUND;
        self.lost() && few && self.widens() && self.ground.told().1 >= self.assumed.center
    }

    /// Whether a ground ring that is rougher than assumed explains what was rejected; it is taken for such a one then.
    fn roughen(&mut self) -> bool {
        self.ground.fit(MISFIT_MAX, &self.history);
        self.explains()
    }

    /// Whether the model explains what was measured, but for dirt, and what was rejected, which then counts no longer.
    fn explains(&mut self) -> bool {
        let known = self.known();
        let (noise, rejected) = (known.misfit() * self.assumed.noise, self.rejections as usize);
        let fits = |&(angle, y): &(f64, f64)| (y - known.line(angle)).abs() <= self.assumed.gate * noise;
        let count = self.history.iter().filter(|seen| fits(seen)).count() as f64;
        let explained =
            count >= EXPLAINED * self.history.len() as f64 && self.history.iter().rev().take(rejected).all(fits);
        if explained {
            self.rejections = 0;
        }
        explained
    }

    /// The ring was moved: its center is now near `center` (table frame, m), within `sigma` (m) in each coordinate.
    pub fn displaced(&mut self, center: Vector2<f64>, sigma: f64) {
        if self.tried() {
            self.any = None;
        }
        match &mut self.any {
            Some(any) => any.displaced(center, sigma),
            None => self.ground.displaced(center, sigma),
        }
        self.history.clear();
    }

    /// Whether so many measurements in a row were rejected that the model must be wrong.
    pub fn lost(&self) -> bool {
        self.rejections > self.assumed.rejections_max
    }

    /// What is in force.
    fn known(&self) -> &dyn Known {
        match &self.any {
            Some(any) if !self.tried() => &any.estimate,
            _ => &self.ground.estimate,
        }
    }

    fn known_mut(&mut self) -> &mut dyn Known {
        let tried = self.tried();
        match &mut self.any {
            Some(any) if !tried => &mut any.estimate,
            _ => &mut self.ground.estimate,
        }
    }

    /// Standard deviation of what is measured from the model, in that of the noise, at least 1.
    pub fn misfit(&self) -> f64 {
        self.known().misfit()
    }

    /// Whether the center is so near to the point of linearisation that the curvature of the circle does not matter.
    pub fn settled(&self) -> bool {
        self.known().settled()
    }

    /// b0: where the line of a round and centered ring is, m.
    pub fn mean_line(&self) -> f64 {
        self.known().mean_line()
    }

    /// Center of the ring in the table frame, m.
    pub fn center(&self) -> Vector2<f64> {
        self.known().center()
    }

    /// Covariance of the center, m2.
    pub fn center_covariance(&self) -> Matrix2<f64> {
        self.known().center_covariance()
    }

    /// Eccentricity B, m.
    pub fn eccentricity(&self) -> f64 {
        self.center().norm()
    }

    /// Standard deviation of the center in the direction in which it is known least, m.
    pub fn center_sigma(&self) -> f64 {
        self.center_covariance().symmetric_eigenvalues().max().max(0.0).sqrt()
    }

    /// What y = s - q would be at `angle` (rad) with the center of the ring on the axis of the spindle, m.
    pub fn centered_line(&self, angle: f64) -> f64 {
        self.known().centered_line(angle)
    }

    /// What y = s - q is expected to be at `angle` (rad), m.
    pub fn line(&self, angle: f64) -> f64 {
        self.known().line(angle)
    }
}

#[cfg(test)]
mod tests;
