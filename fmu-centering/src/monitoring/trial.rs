//! The test of the probe before `Centered`: it must follow a small move of the slide, out and in again.
//!
//! With the positions s and q of slide and probe at rest before, outside and after it, the gain ratio of the probe is
//! (q0 - 2 q1 + q2) / (s0 - 2 s1 + s2). The surface continues to turn meanwhile; its even motion cancels.

use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

/// Number of positions.
const POSITIONS: usize = 3;
/// Tolerance of the gain ratio about 1: errors of the probe scale, and uneven motion of the surface of an eccentric
/// ring (default).
pub const RATIO_ERROR: f64 = 0.2;

/// The positions so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ProbeTrial(ArrayVec<[f64; 2], POSITIONS>);

impl ProbeTrial {
    /// Adds a position at rest: slide and probe, m.
    pub fn note(&mut self, slide: f64, probe: f64) {
        if !self.over() {
            self.0.push([slide, probe]);
        }
    }

    /// Whether all positions are measured.
    pub fn over(&self) -> bool {
        self.0.is_full()
    }

    /// Gain ratio of the probe, once the move is over.
    pub fn ratio(&self) -> Option<f64> {
        let [a, b, c] = self.0.as_slice() else { return None };
        let curvature = |i: usize| a[i] - 2.0 * b[i] + c[i];
        let ratio = curvature(1) / curvature(0);
        Some(if ratio.is_finite() { ratio } else { 0.0 })
    }
}

/// Whether the gain ratio of a probe is acceptable.
pub fn plausible_ratio(ratio: f64) -> bool {
    (ratio - 1.0).abs() <= RATIO_ERROR
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(positions: [[f64; 2]; 3]) -> f64 {
        let mut trial = ProbeTrial::default();
        positions.iter().for_each(|[slide, probe]| trial.note(*slide, *probe));
        trial.ratio().unwrap()
    }

    #[test]
    fn the_ratio_is_that_of_the_probe_whatever_the_surface_does_evenly() {
        for (scale, drift) in [(1.0, 0.0), (1.0, 5e-5), (0.3, -5e-5), (0.0, 0.0)] {
            let probe = |slide: f64, time: f64| 4e-3 + scale * slide + drift * time;
            let positions = [[0.1, probe(0.1, 0.0)], [0.0998, probe(0.0998, 1.0)], [0.1, probe(0.1, 2.0)]];
            assert!((ratio(positions) - scale).abs() < 1e-9);
            assert_eq!(plausible_ratio(ratio(positions)), scale == 1.0);
        }
    }

    #[test]
    fn a_slide_that_has_not_moved_proves_nothing() {
        assert_eq!(ratio([[0.1, 4e-3]; 3]), 0.0);
        assert_eq!(ProbeTrial::default().ratio(), None);
    }

    #[test]
    fn a_fifth_more_or_less_is_accepted() {
        assert!([0.81, 1.0, 1.19].into_iter().all(plausible_ratio));
        assert!(![0.79, 1.21, 0.0, -1.0].into_iter().any(plausible_ratio));
    }

    #[test]
    fn it_is_over_with_its_third_position_and_keeps_all_three() {
        let mut trial = ProbeTrial::default();
        for (k, probe) in [4e-3, 3.8e-3, 4e-3].into_iter().enumerate() {
            assert!(!trial.over() && trial.ratio().is_none());
            trial.note(if k == 1 { 0.0998 } else { 0.1 }, probe);
        }
        let ratio = trial.ratio();
        trial.note(9.0, 9.0);
        assert!(trial.over() && trial.ratio() == ratio && (ratio.unwrap() - 1.0).abs() < 1e-9);
    }
}
