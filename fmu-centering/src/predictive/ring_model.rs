//! Recursive model of the ring: center, line of measurement and form.
//!
//! One scalar measurement y = s - q at a time, through the exact geometry (`ring_line`), so that a part of a revolution is
//! enough once b0 and the form are known. The covariance states the uncertainty.
//!
//! The geometry is linearized at the present estimate, which is poor at first. So the measurements since the last
//! motion of the ring are stored, and all of them are evaluated again at the better estimate from time to time
//! (Gauss-Newton).
//!
//! Most rings are ground: few orders of form are enough, and with every order more a part of a revolution identifies
//! less. If they do not explain the measurements, the model uses any form.

use arrayvec::ArrayVec;
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use crate::predictive::any_form::AnyForm;
use crate::predictive::assumptions::Assumptions;
use crate::predictive::ground_ring::GroundRing;
use crate::predictive::refit::Purpose;
use crate::predictive::ring_estimate::{Known, MISFIT_MAX};
use crate::predictive::ring_line::{ANY, GROUND};

/// Stored measurements: more than a revolution at 20 rpm and 66 Hz; later ones are used only once.
const HISTORY: usize = 256;
/// A ring is no ground one if its misfit exceeds the first value in multiples of the noise (default: the configured
/// noise may be wrong), and if more than this fraction of the measurements exceeds the second value: dirt covers less
/// of the surface.
const WIDEN: f64 = 3.0;
const COARSE: (f64, f64) = (0.25, 2.0);
/// Minimum fraction of the measurements that a rough ring explains; otherwise some belong to another position of the ring.
const EXPLAINED: f64 = 0.9;

/// Estimate of the ring.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RingModel {
    assumed: Assumptions,
    ground: GroundRing,
    /// of any form, if a ground ring does not explain the measurements; active from its first fit on
    any: Option<AnyForm>,
    /// angles (rad) and measurements (m) since the ring was moved
    history: ArrayVec<(f64, f64), HISTORY>,
    rejections: u32,
    late: bool,
}

impl RingModel {
    /// Only the prior is known.
    pub fn new(assumed: Assumptions) -> Self {
        let ground = GroundRing::new(assumed);
        Self { assumed, ground, any: None, history: ArrayVec::new_const(), rejections: 0, late: false }
    }

    /// Stores whether the probe is delayed relative to the slide: its residuals are then no form.
    pub fn note_late(&mut self, late: bool) {
        self.late = late;
    }

    /// Adds y = s - q (m) at the spindle angle (rad); false if it was rejected as dirt.
    pub fn observe(&mut self, angle: f64, y: f64) -> bool {
        let waited = self.waits();
        if !self.history.is_full() {
            self.history.push((angle, y));
        }
        if !self.known_mut().observe(angle, y) {
            self.rejections += 1;
            return false;
        }
        // a measurement that fits by chance gives no more information than those that do not, not even the last one
        if !waited {
            self.rejections = 0;
        }
        if self.history.is_full() {
            self.known_mut().linearise();
        }
        true
    }

    /// Evaluates the stored measurements again, linearized at the present estimate, then with less weight for misfits;
    /// does nothing if later measurements are not stored, or if there are none yet. A model of any form only starts it.
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

    /// Makes the next pass of the active fit, or starts one that may explain the rejected measurements;
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

    /// Whether the active model may change: too many measurements were rejected, or a ring of any form is tried.
    pub fn undecided(&self) -> bool {
        self.lost() || self.tried()
    }

    fn tried(&self) -> bool {
        self.any.as_ref().is_some_and(|any| any.fitting() == Some(Purpose::Widen))
    }

    /// Later measurements are not stored, so that no fit uses all of them.
    fn give_up(&mut self) {
        if self.tried() {
            self.any = None;
        } else if let Some(any) = &mut self.any {
            any.give_up();
        }
    }

    /// Whether a ground ring has a larger misfit than noise and dirt explain; a few measurements fit any model.
    fn coarse(&self) -> bool {
        let ring = &self.ground.estimate;
        let far = COARSE.1 * self.assumed.noise;
        let beyond = || self.history.iter().filter(|(angle, y)| (y - ring.line(*angle)).abs() > far).count();
        self.history.len() > 2 * ANY && ring.misfit > WIDEN && beyond() as f64 > COARSE.0 * self.history.len() as f64
    }

    /// Whether more form may explain the misfit: neither a delayed probe nor a round ring has more form.
    fn widens(&self) -> bool {
        self.assumed.form > 0.0 && !self.late
    }

    /// Starts to test whether a ring of any form explains the measurements; a few measurements are explained by any form.
    fn widen(&mut self) {
        let (center, sigma) = self.ground.center_and_sigma();
        let informative = self.history.len() > 2 * GROUND && self.widens();
        self.any = informative.then(|| AnyForm::new(self.assumed, center, sigma, &self.ground.estimate.now.mean));
    }

    /// Starts to test whether a ring with more form than assumed, or a rougher one, explains the rejected measurements;
    /// false if none can.
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

    /// Whether too many measurements of an unknown ring were rejected, and more measurements may show that it has more
    /// form than assumed: with so few, any roughness explains them, too.
    fn waits(&self) -> bool {
        let few = self.any.is_none() && self.history.len() <= 2 * GROUND;
        self.lost() && few && self.widens() && self.ground.center_and_sigma().1 >= self.assumed.center
    }

    /// Whether a ground ring that is rougher than assumed explains the rejected measurements; the model is then that ring.
    fn roughen(&mut self) -> bool {
        self.ground.fit(MISFIT_MAX, &self.history);
        self.explains()
    }

    /// Whether the model explains the measurements except dirt, and the rejected ones, whose count is then reset.
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

    /// Whether the number of consecutive rejected measurements shows that the model is wrong.
    pub fn lost(&self) -> bool {
        self.rejections > self.assumed.rejections_max
    }

    /// The active model.
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

    /// Standard deviation of the measurements from the model, in that of the noise, at least 1.
    pub fn misfit(&self) -> f64 {
        self.known().misfit()
    }

    /// Whether the center is so near to the point of linearization that the curvature of the circle does not matter.
    pub fn settled(&self) -> bool {
        self.known().settled()
    }

    /// b0: position of the line of a round and centered ring, m.
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

    /// Standard deviation of the center in its most uncertain direction, m.
    pub fn center_sigma(&self) -> f64 {
        self.center_covariance().symmetric_eigenvalues().max().max(0.0).sqrt()
    }

    /// Value of y = s - q at `angle` (rad) with the center of the ring on the spindle axis, m.
    pub fn centered_line(&self, angle: f64) -> f64 {
        self.known().centered_line(angle)
    }

    /// Expected value of y = s - q at `angle` (rad), m.
    pub fn line(&self, angle: f64) -> f64 {
        self.known().line(angle)
    }
}

#[cfg(test)]
mod tests;
