//! Self-modification: the offset P that is learned from the pushes, eq. 37 to 39.

use serde::{Deserialize, Serialize};

use crate::center::Estimate;
use crate::interface::{Offset, OffsetMethod};

/// Only pushes of a smaller eccentricity are used for learning, m (paper).
const GATE: f64 = 2e-4;
/// Largest offset in either direction, m: a third of the usual eccentricity (default).
const LIMIT: f64 = 3e-4;

/// A ring that moved by less than this fraction of the desired distance was not touched (paper).
const UNTOUCHED: f64 = 0.05;

/// Data of a completed push.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LastStroke {
    /// The ring before.
    pub before: Estimate,
    /// Gap between pusher and ring at the end of the stroke, m.
    pub remaining: f64,
}

/// Learned offset.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Learner {
    offset: f64,
}

impl Learner {
    /// The offset P, m.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Learns from a push and the ring after it.
    pub fn learn(&mut self, p: &Offset, stroke: &LastStroke, after: &Estimate) {
        match p.method {
            OffsetMethod::Off => {}
            OffsetMethod::Recursive => self.recurse(stroke, after),
        }
    }

    fn recurse(&mut self, stroke: &LastStroke, after: &Estimate) {
        let requested = stroke.before.center.eccentricity();
        if requested >= GATE {
            return;
        }
        let actual = stroke.before.center.distance(&after.center);
        // 38: the remaining gap is used when the pusher has not reached the ring
        let remaining = if actual < UNTOUCHED * requested { stroke.remaining.max(0.0) } else { 0.0 };
        // 37, 39: desired minus actual; P is not part of the desired distance, otherwise it would grow by itself
        self.offset = (self.offset + remaining + requested - actual).clamp(-LIMIT, LIMIT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::center::Center;

    fn at(x: f64) -> Estimate {
        Estimate { center: Center { x, y: 0.0 }, mean: 0.08, sigma: 0.0 }
    }

    fn learned(before: f64, after: f64, remaining: f64) -> f64 {
        let mut learner = Learner::default();
        learner.learn(&Offset::START, &LastStroke { before: at(before), remaining }, &at(after));
        learner.offset()
    }

    #[test]
    fn a_short_push_makes_the_next_one_longer_and_a_long_one_shorter() {
        assert!((learned(1e-4, 3e-5, 1e-6) - 3e-5).abs() < 1e-12);
        assert!((learned(1e-4, -2e-5, 1e-6) + 2e-5).abs() < 1e-12);
    }

    #[test]
    fn the_gap_left_counts_only_if_the_ring_did_not_move() {
        assert!((learned(1e-4, 9.6e-5, 4e-5) - 9.6e-5 - 4e-5).abs() < 1e-12);
        assert!((learned(1e-4, 9.4e-5, 4e-5) - 9.4e-5).abs() < 1e-12);
        // the probe was beyond the pusher: no gap
        assert!((learned(1e-4, 9.6e-5, -4e-5) - 9.6e-5).abs() < 1e-12);
    }

    #[test]
    fn large_pushes_do_not_teach() {
        assert_eq!(learned(2e-4, 1e-4, 0.0), 0.0);
    }

    #[test]
    fn a_constant_loss_is_learned_without_bound_by_itself() {
        let mut learner = Learner::default();
        let (loss, mut x) = (2e-5, 1e-4);
        for _ in 0..6 {
            let moved = x + learner.offset() - loss;
            learner.learn(&Offset::START, &LastStroke { before: at(x), remaining: 0.0 }, &at(x - moved));
            x = 1e-4;
        }
        assert!((learner.offset() - loss).abs() < 1e-12, "{}", learner.offset());
    }

    #[test]
    fn the_offset_stays_within_its_limit() {
        let mut learner = Learner::default();
        for _ in 0..100 {
            learner.learn(&Offset::START, &LastStroke { before: at(1e-4), remaining: 1e-4 }, &at(1e-4));
        }
        assert_eq!(learner.offset(), LIMIT);
    }

    #[test]
    fn switched_off_it_learns_nothing() {
        let mut learner = Learner::default();
        let p = Offset { method: OffsetMethod::Off };
        learner.learn(&p, &LastStroke { before: at(1e-4), remaining: 0.0 }, &at(5e-5));
        assert_eq!(learner.offset(), 0.0);
    }
}
