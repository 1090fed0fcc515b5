//! All measurements since the ring was moved are taken in again, one pass over them at a time (Gauss-Newton): one pass
//! is what a sample has time for.

use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

use crate::predictive::assumptions::Assumptions;
use crate::predictive::noise::{Noise, median};
use crate::predictive::normal::{NormalEquations, Prior, Solution};
use crate::predictive::ring_line::{Vector, line};

/// Measurements kept: more than a revolution at 20 rpm and 66 Hz; later ones are taken in only once.
pub const HISTORY: usize = 256;
/// Largest noise of a ring that is only rough, m (our choice), if no more was told; beyond it was moved.
pub const ROUGH: f64 = 2e-6;
/// Passes from a point of linearisation that is too far, from a good one, and at most.
const PASSES: [usize; 3] = [3, 1, 5];
/// The noise is the same up to this factor.
const SAME: f64 = 1.2;

/// What a pass goes over.
pub struct Evidence<'a> {
    /// What is assumed of any ring.
    pub assumed: &'a Assumptions,
    /// Before the measurements.
    pub before: &'a (Prior, Noise),
    /// Angles (rad) and measurements (m).
    pub history: &'a [(f64, f64)],
}

/// A fit between two passes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Refit {
    /// Where the geometry is linearised.
    pub linear: Vector,
    /// Noise that the last pass has found.
    pub noise: Noise,
    /// Whether the measurements are a whole revolution that tells all by itself.
    pub alone: bool,
    /// the first point of linearisation is a good one
    near: bool,
    /// least noise (m) of a ring whose misfits are no dirt
    rough: f64,
    /// passes made
    pass: usize,
}

impl Refit {
    /// Before the first pass, from what is known now.
    pub fn new(linear: Vector, noise: Noise, near: bool, rough: f64) -> Self {
        Self { linear, noise, alone: false, near, rough, pass: 0 }
    }

    /// The next pass: what it finds, and whether it is the last; none where rounding leaves no solution.
    pub fn pass(&mut self, measured: &Evidence) -> Option<(Solution, bool)> {
        let Evidence { assumed, before: (prior, noise), history } = measured;
        let used = self.noise.sigma;
        let weighed = self.near || self.pass > 0;
        let far = assumed.gate * used.max(assumed.noise).max(self.rough);
        let mut equations = NormalEquations::new(prior, &self.linear);
        let mut magnitudes = ArrayVec::<f64, HISTORY>::new_const();
        for &(angle, y) in *history {
            let (expected, gradient) = line(assumed.radius, &self.linear, angle, &self.linear);
            let misfit = y - expected;
            magnitudes.push(misfit.abs());
            // cauchy's weight: dirt has hardly any influence
            let weight = if weighed { 1.0 / (1.0 + (misfit / far).powi(2)) } else { 1.0 };
            equations.add(misfit, &gradient, weight / used.powi(2));
        }
        let found = equations.solve(prior)?;
        if weighed {
            let most = ROUGH.max(assumed.noise);
            self.noise = noise.after(median(&mut magnitudes), history.len() as f64, found.free, most);
        }
        self.pass += 1;
        // with too little noise a model is too sure
        let same = self.pass >= PASSES[usize::from(self.near)] && self.noise.sigma < SAME * used;
        Some((found, same || self.pass == PASSES[2]))
    }
}
