//! All measurements since the ring was moved are evaluated again, one pass at a time (Gauss-Newton): a sample has time
//! for one pass of a model of any form.

use serde::{Deserialize, Serialize};

use crate::predictive::assumptions::Assumptions;
use crate::predictive::normal::{NormalEquations, Prior, Solution};
use crate::predictive::ring_estimate::MISFIT_MAX;
use crate::predictive::ring_line::{ANY, Vector, line};

/// Purpose of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Purpose {
    /// The first one, from the estimate of a ground ring.
    Widen,
    /// From a model of any form that explains the measurements.
    Refine,
    /// From one that does not, as the ring may be rough.
    Reconsider,
}

impl Purpose {
    /// For each pass, the limit of misfits without dirt in multiples of the noise; at first all, since the model fits
    /// nothing yet.
    fn passes(self) -> &'static [f64] {
        match self {
            Self::Widen | Self::Reconsider => &[f64::INFINITY, MISFIT_MAX, MISFIT_MAX, MISFIT_MAX],
            Self::Refine => &[1.0, 1.0, 1.0],
        }
    }
}

/// A fit between two passes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Refit {
    /// Purpose.
    pub purpose: Purpose,
    /// Point of linearization of the geometry.
    pub linear: Vector<ANY>,
    /// passes made
    made: usize,
}

/// Result of the last pass.
#[derive(Clone, Debug)]
pub struct Found {
    /// Present estimate, relative to the point of linearization.
    pub solution: Solution,
    /// Weighted squares of the residuals at that point, in those of the noise.
    pub squares: f64,
}

impl Refit {
    /// Before the first pass, linearized at a state.
    pub fn new(purpose: Purpose, linear: Vector<ANY>) -> Self {
        Self { purpose, linear, made: 0 }
    }

    /// Whether only the last pass remains.
    pub fn last(&self) -> bool {
        self.made + 1 == self.purpose.passes().len()
    }

    /// The next pass over angles (rad) and measurements (m); none where rounding leaves no solution.
    pub fn pass(&mut self, assumed: &Assumptions, before: &Prior, history: &[(f64, f64)]) -> Option<Found> {
        let far = assumed.gate * self.purpose.passes()[self.made];
        let mut equations = NormalEquations::new(before, &self.linear);
        let mut squares = 0.0;
        for &(angle, y) in history {
            let (expected, gradient) = line(assumed.radius, &self.linear, angle, &self.linear);
            let misfit = (y - expected) / assumed.noise;
            // cauchy's weight: dirt has hardly any influence
            let weight = 1.0 / (1.0 + (misfit / far).powi(2));
            squares += weight * misfit * misfit;
            equations.add(y - expected, &gradient, weight / assumed.noise.powi(2));
        }
        self.made += 1;
        Some(Found { solution: equations.solve()?, squares })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::predictive::ring_estimate::RingEstimate;

    const ASSUMED: Assumptions =
        Assumptions { radius: 0.05, noise: 1e-7, center: 5e-3, form: 2e-6, gate: 6.0, rejections_max: 5 };

    /// The prior, and a revolution of a ring that is 0.2 mm off with a lobe of 3 um, as its own model has it.
    fn revolution() -> (Prior, Vector<ANY>, Vec<(f64, f64)>) {
        let estimate = RingEstimate::new(ASSUMED, Vector2::zeros(), ASSUMED.center);
        let mut state = Vector::zeros();
        (state[0], state[1], state[2], state[2 * 11]) = (0.07, 2e-4, -1e-4, 3e-6);
        let angles = (0..200).map(|k| std::f64::consts::TAU * f64::from(k) / 200.0);
        let seen = angles.map(|angle| (angle, line(ASSUMED.radius, &state, angle, &state).0)).collect();
        (Prior::of(&estimate.now), state, seen)
    }

    #[test]
    fn the_last_pass_of_a_fit_has_found_the_ring_and_is_reported() {
        for (purpose, passes) in [(Purpose::Widen, 4), (Purpose::Reconsider, 4), (Purpose::Refine, 3)] {
            let (before, state, seen) = revolution();
            let mut refit = Refit::new(purpose, if purpose == Purpose::Refine { state } else { Vector::zeros() });
            for pass in 1..=passes {
                assert_eq!(refit.last(), pass == passes, "{purpose:?} {pass}");
                let found = refit.pass(&ASSUMED, &before, &seen).unwrap();
                refit.linear += found.solution.step;
            }
            // 0.2 nm of a lobe are what the assumptions hold back
            assert!((refit.linear - state).amax() < 2e-9, "{purpose:?}: {}", (refit.linear - state).amax());
        }
    }

    #[test]
    fn dirt_has_hardly_any_weight_where_the_model_fits_and_all_of_it_before() {
        let pull = |purpose: Purpose| {
            let (before, state, mut seen) = revolution();
            seen[50].1 += 2e-5;
            let found = Refit::new(purpose, state).pass(&ASSUMED, &before, &seen).unwrap();
            (found.solution.step.fixed_rows::<2>(1).norm(), found.squares)
        };
        let ((all, squares), (weighed, few)) = (pull(Purpose::Widen), pull(Purpose::Refine));
        // of 200 times the noise, which is 33 gates off: 1 / (1 + 33^2) of its weight
        assert!((squares - 4e4).abs() < 1e2 && (few - 4e4 / (1.0 + (200.0_f64 / 6.0).powi(2))).abs() < 0.1, "{few}");
        assert!(all > 1e-7 && weighed < 2e-3 * all, "{all} {weighed}");
    }

    #[test]
    fn what_rounding_leaves_nothing_of_is_no_fit() {
        let (before, state, mut seen) = revolution();
        seen[0].1 = f64::NAN;
        assert!(Refit::new(Purpose::Refine, state).pass(&ASSUMED, &before, &seen).is_none());
    }
}
