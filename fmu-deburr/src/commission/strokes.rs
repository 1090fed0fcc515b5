//! Record of the strokes of one axis: reference and control error of each sample.

use serde::{Deserialize, Serialize};

use crate::learning::identification::BareRun;

/// Reference and control error of one axis in each sample, counts.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Strokes {
    reference: Vec<f64>,
    error: Vec<f64>,
    count: usize,
}

impl Strokes {
    /// With memory for `samples` samples.
    pub fn new(samples: usize) -> Self {
        Self { reference: vec![0.0; samples], error: vec![0.0; samples], count: 0 }
    }

    /// Discards all samples.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Takes the reference and the control error of a sample, as long as there is memory.
    pub fn take(&mut self, reference: f64, error: f64) {
        if let (Some(slot), Some(left)) = (self.reference.get_mut(self.count), self.error.get_mut(self.count)) {
            (*slot, *left) = (reference, error);
            self.count += 1;
        }
    }
}

impl BareRun for Strokes {
    fn weight(fraction: f64) -> f64 {
        fraction
    }

    fn count(&self) -> usize {
        self.count
    }

    fn inside(&self, index: isize) -> Option<usize> {
        usize::try_from(index).ok().filter(|k| *k < self.count)
    }

    fn rate(&self, k: usize) -> f64 {
        if k + 1 < self.count { self.reference[k + 1] - self.reference[k] } else { 0.0 }
    }

    fn error(&self, k: usize) -> f64 {
        self.error[k]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_those_to_the_next_sample_and_what_has_no_room_is_left_out() {
        let mut strokes = Strokes::new(3);
        for k in 0..5 {
            strokes.take(f64::from(k * k), -f64::from(k));
        }
        assert_eq!(
            (strokes.count(), strokes.inside(-1), strokes.inside(2), strokes.inside(3)),
            (3, None, Some(2), None)
        );
        assert_eq!([0, 1, 2].map(|k| (strokes.rate(k), strokes.error(k))), [(1.0, 0.0), (3.0, -1.0), (0.0, -2.0)]);
        strokes.clear();
        assert_eq!((strokes.count(), strokes.inside(0)), (0, None));
    }
}
