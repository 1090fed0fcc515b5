//! Recursive model of the ring: where its centre is, how far the line of measurement, and what form it has.
//!
//! One scalar measurement y = s - q at a time, through the exact geometry (`ring_line`), so that a part of a revolution is
//! enough once b0 and the form are known, and all angles count at once. The covariance says how much is known.
//!
//! The geometry is linearised at the present estimate, which is poor at first. So the measurements since the ring was
//! last moved are kept, and all of them are taken in again at the better estimate now and then (Gauss-Newton).

use arrayvec::ArrayVec;
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use crate::predictive::assumptions::{Assumptions, FINE, FINE_SHARE, ROUND};
use crate::predictive::noise::Noise;
use crate::predictive::normal::{Matrix, Prior};
use crate::predictive::refit::{Evidence, HISTORY, ROUGH, Refit};
use crate::predictive::ring_line::{STATES, Vector, form, line, place};

/// Change of b0 and form on the way of the ring, relative (derived: a lateral ratio of 0.1 turns it, lobes of 2 um).
const TURN: f64 = 1e-4;
/// Relative uncertainty of the radius.
const RADIUS: f64 = 0.02;
/// A noise of more than so many times what was told, found by more than twice as many measurements as there are states, makes it likely that the ring is none of these: it has as much of all harmonics.
const COARSE: f64 = 3.0;
/// Least share of the measurements that a rough ring explains; else some of them belong to another place of the ring.
const EXPLAINED: f64 = 0.9;
/// The history is taken in again when it has grown by this share of it.
const GROWTH: f64 = 0.25;
/// What is further off than this share of the gate is dirt in part.
const DOUBT: f64 = 0.5;

/// Mean of the state and a square root of its covariance, which cannot become indefinite.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Gaussian {
    mean: Vector,
    root: Matrix,
}

impl Gaussian {
    /// Variance of what a measurement with this gradient is expected to be.
    fn spread(&self, gradient: &Vector) -> f64 {
        self.root.tr_mul(gradient).norm_squared()
    }

    /// Takes in a measurement that was `innovation` larger than expected (Potter's form of eq. 21 to 23).
    fn update(&mut self, innovation: f64, gradient: &Vector, noise: f64) {
        let seen = self.root.tr_mul(gradient);
        let spread = seen.norm_squared() + noise;
        let cross = self.root * seen;
        self.mean += cross * (innovation / spread);
        let share = 1.0 / (spread + (noise * spread).sqrt());
        self.root.ger(-share, &cross, &seen, 1.0);
    }
}

/// What is known of the ring.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RingModel {
    assumed: Assumptions,
    now: Gaussian,
    noise: Noise,
    /// where the geometry is linearised
    linear: Vector,
    /// before the measurements of the history
    before: (Prior, Noise),
    /// angles (rad) and measurements (m) since the ring was moved
    history: ArrayVec<(f64, f64), HISTORY>,
    /// length of the history when it was last taken in again, and whether it has had dirt since
    fitted: usize,
    doubtful: bool,
    /// a ring that has as much of all harmonics
    coarse: bool,
    /// the history is a whole revolution, and tells all by itself
    alone: bool,
    /// the fit of the history that is under way
    refit: Option<Refit>,
    rejections: u32,
}

impl RingModel {
    /// Nothing known but the assumptions.
    pub fn new(assumed: Assumptions) -> Self {
        let sigmas = assumed.sigmas();
        let now = Gaussian { mean: Vector::zeros(), root: Matrix::from_diagonal(&sigmas) };
        let prior = assumed.prior();
        let noise = Noise::told(assumed.noise);
        Self {
            assumed,
            linear: now.mean,
            before: (prior, noise),
            now,
            noise,
            history: ArrayVec::new_const(),
            fitted: 0,
            doubtful: false,
            coarse: false,
            alone: false,
            refit: None,
            rejections: 0,
        }
    }

    /// Takes in y = s - q (m) at the spindle angle (rad); false if it was taken for dirt.
    pub fn observe(&mut self, angle: f64, y: f64) -> bool {
        let (expected, gradient) = self.expect(angle, &self.now.mean);
        let innovation = y - expected;
        if !self.history.is_full() {
            self.history.push((angle, y));
        }
        let spread = self.now.spread(&gradient) + self.gated().powi(2) + self.blur(&gradient).powi(2);
        let off = innovation.powi(2) / (self.assumed.gate.powi(2) * spread);
        self.doubtful |= off > DOUBT.powi(2);
        if off > 1.0 {
            self.rejections += 1;
            return false;
        }
        self.rejections = 0;
        self.now.update(innovation, &gradient, self.noise.sigma.powi(2));
        if self.history.is_full() {
            // later ones are in no fit
            (self.linear, self.refit) = (self.now.mean, None);
        }
        true
    }

    /// Begins to take in the history again where that tells more: linearised at what is known by now, with less weight for
    /// what does not fit, and with the noise that it has.
    pub fn refine(&mut self) {
        if self.refit.is_some() {
            return;
        }
        let grown = self.history.len() as f64 >= (1.0 + GROWTH) * self.fitted as f64;
        let near = self.settled();
        if !self.coarse && self.history.len() > 2 * STATES && self.noise.sigma > COARSE * self.assumed.noise {
            self.coarsen();
        } else if self.doubtful || grown || !near {
            self.fit(near, self.noise, 0.0);
        }
    }

    /// The history is a whole revolution: what a part of one has told of the ring before, perhaps too surely, counts no
    /// longer. Whether that is so already, or only begins.
    pub fn stand_alone(&mut self) -> bool {
        if self.alone || self.refit.as_ref().is_some_and(|refit| refit.alone) {
            return self.alone;
        }
        self.before.0 = self.assumed.prior();
        if std::mem::take(&mut self.coarse) {
            self.coarsen();
        } else {
            self.fit(false, self.noise, 0.0);
        }
        match &mut self.refit {
            Some(refit) => refit.alone = true,
            None => self.alone = true,
        }
        self.alone
    }

    /// The ring may have as much of all harmonics: its history tells more of them then, and less noise.
    fn coarsen(&mut self) {
        if std::mem::replace(&mut self.coarse, true) {
            return;
        }
        let (prior, noise) = &mut self.before;
        let fine = place(FINE)..;
        prior.information.columns_range_mut(fine.clone()).fill(0.0);
        prior.information.rows_range_mut(fine).fill(0.0);
        let least = self.assumed.form.max(ROUND).powi(-2);
        (place(FINE)..STATES).for_each(|i| prior.information[(i, i)] = least);
        *noise = Noise::told(self.assumed.noise);
        self.fit(false, Noise::told(self.assumed.noise), ROUGH);
    }

    /// Begins to take in the history again from what is `near` or not, with misfits that are no dirt of a ring whose noise is
    /// `rough` (m) at least; not if later measurements are not kept, or if there are none yet.
    fn fit(&mut self, near: bool, noise: Noise, rough: f64) {
        let kept = !self.history.is_empty() && !self.history.is_full();
        self.refit = kept.then(|| Refit::new(self.now.mean, noise, near, rough));
    }

    /// Makes the next pass of a fit that is under way; what is known changes with the last.
    pub fn advance(&mut self) {
        let Some(mut refit) = self.refit.take() else { return };
        let measured = Evidence { assumed: &self.assumed, before: &self.before, history: &self.history };
        let Some((found, last)) = refit.pass(&measured) else {
            self.alone |= refit.alone;
            return;
        };
        let mean = refit.linear + found.step;
        if !last {
            refit.linear = mean;
            self.refit = Some(refit);
            return;
        }
        self.alone |= refit.alone;
        (self.linear, self.noise) = (refit.linear, refit.noise);
        self.now = Gaussian { mean, root: found.root };
        (self.fitted, self.doubtful) = (self.history.len(), false);
    }

    /// Makes all passes of a fit that is under way.
    pub fn finish(&mut self) {
        while self.refit.is_some() {
            self.advance();
        }
    }

    /// Whether a ring that is rougher or has more form than assumed explains what was rejected; it is taken for such a one then.
    pub fn reconsider(&mut self) -> bool {
        self.coarsen();
        self.finish();
        let explained = self.explained(self.gated()) || {
            self.fit(false, self.noise, ROUGH);
            self.finish();
            self.noise.sigma = self.noise.sigma.max(ROUGH);
            self.explained(self.noise.sigma)
        };
        if explained {
            self.rejections = 0;
        }
        explained
    }

    /// Whether a model with so much noise (m) explains what was measured, but for dirt, and what was rejected is no more than rough.
    fn explained(&self, noise: f64) -> bool {
        let rejected = self.rejections as usize;
        let within = |&(angle, y): &(f64, f64), noise: f64| {
            (y - self.expect(angle, &self.now.mean).0).abs() <= self.assumed.gate * noise
        };
        let known = self.history.iter().filter(|seen| within(seen, noise)).count() as f64;
        !self.history.is_full()
            && known >= EXPLAINED * self.history.len() as f64
            && self.history.iter().rev().take(rejected).all(|seen| within(seen, ROUGH))
    }

    /// Noise by which dirt is told: what is quieter than was told may have worse places.
    fn gated(&self) -> f64 {
        self.noise.sigma.max(self.assumed.noise)
    }

    /// Noise of one measurement.
    pub fn noise(&self) -> Noise {
        self.noise
    }

    /// Whether the centre is so near to the point of linearisation that the curvature of the circle does not matter.
    pub fn settled(&self) -> bool {
        self.bend(&self.step()) < self.noise.sigma
    }

    fn step(&self) -> Vector2<f64> {
        Vector2::new(self.now.mean[1] - self.linear[1], self.now.mean[2] - self.linear[2])
    }

    /// How far the circle leaves its tangent, m.
    fn bend(&self, step: &Vector2<f64>) -> f64 {
        step.norm_squared() / (2.0 * self.assumed.radius)
    }

    /// The ring was moved: its centre is now near `centre` (table frame, m), within `sigma` (m) in each coordinate.
    ///
    /// What was taken for b0 and form where the ring was is less sure here: it has turned a little, and the radius is
    /// not known exactly.
    pub fn displaced(&mut self, centre: Vector2<f64>, sigma: f64) {
        let way = (self.centre() - centre).norm();
        let doubt = TURN * way + RADIUS * way * way / (4.0 * self.assumed.radius);
        let mut doubts = Vector::from_element(doubt);
        doubts.rows_range_mut(place(FINE)..).scale_mut(FINE_SHARE);
        // what warmth moves is not known to stay by less than a measurement tells
        doubts[0] = doubts[0].hypot(self.assumed.noise);
        let mut covariance = self.now.root * self.now.root.transpose();
        for i in 0..STATES {
            covariance[(i, i)] += doubts[i].powi(2);
        }
        for i in [1, 2] {
            covariance.row_mut(i).fill(0.0);
            covariance.column_mut(i).fill(0.0);
            covariance[(i, i)] = sigma.powi(2);
        }
        self.now.mean.fixed_rows_mut::<2>(1).copy_from(&centre);
        let Some(factor) = covariance.cholesky() else {
            // nothing is known but the noise
            *self = Self { noise: self.noise, ..Self::new(self.assumed) };
            return;
        };
        let prior = Prior { mean: self.now.mean, information: factor.inverse() };
        self.now.root = factor.l();
        (self.linear, self.before) = (self.now.mean, (prior, self.noise.remembered()));
        self.noise = self.before.1;
        self.history.clear();
        (self.fitted, self.doubtful, self.alone, self.refit) = (0, false, false, None);
    }

    /// Whether so many measurements in a row were rejected that the model must be wrong.
    pub fn lost(&self) -> bool {
        self.rejections > self.assumed.rejections_max
    }

    /// b0: where the line of a round and centred ring is, m.
    pub fn mean_line(&self) -> f64 {
        self.now.mean[0]
    }

    /// Centre of the ring in the table frame, m.
    pub fn centre(&self) -> Vector2<f64> {
        self.now.mean.fixed_rows::<2>(1).into_owned()
    }

    /// Covariance of the centre, m2.
    pub fn centre_covariance(&self) -> Matrix2<f64> {
        let rows = self.now.root.fixed_rows::<2>(1);
        rows * rows.transpose()
    }

    /// Eccentricity B, m.
    pub fn eccentricity(&self) -> f64 {
        self.centre().norm()
    }

    /// Standard deviation of the centre in the direction in which it is known least, m.
    pub fn centre_sigma(&self) -> f64 {
        self.centre_covariance().symmetric_eigenvalues().max().max(0.0).sqrt()
    }

    /// What y = s - q would be at `angle` (rad) with the centre of the ring on the axis of the spindle, m.
    pub fn centred_line(&self, angle: f64) -> f64 {
        self.now.mean[0] - form(&self.now.mean, -angle)
    }

    /// What y = s - q is expected to be at `angle` (rad), m.
    pub fn line(&self, angle: f64) -> f64 {
        self.expect(angle, &self.now.mean).0
    }

    /// What y is at `angle` (rad) for a state near the point of linearisation, m, and its gradient.
    fn expect(&self, angle: f64, state: &Vector) -> (f64, Vector) {
        line(self.assumed.radius, &self.linear, angle, state)
    }

    /// What is left of the measurement beyond its gradient: the curvature of the circle over the doubt about c_y, m.
    fn blur(&self, gradient: &Vector) -> f64 {
        // c_y varies with the derivative of the gradient by the angle
        let side = Vector2::new(gradient[2], -gradient[1]);
        0.5 * side.dot(&(self.centre_covariance() * side)) / self.assumed.radius + self.bend(&self.step())
    }
}

#[cfg(test)]
mod tests;
