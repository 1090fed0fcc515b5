//! Largest value so far, seen at every plant step and not only at the samples of the controller.

use crate::element::{Element, Ports};

/// `maximum = max(value)` since time zero.
#[derive(Clone, Debug)]
pub struct Peak {
    maximum: f64,
}

impl Peak {
    /// A peak without values.
    pub fn new() -> Self {
        Self { maximum: f64::NEG_INFINITY }
    }
}

impl Default for Peak {
    fn default() -> Self {
        Self::new()
    }
}

impl Element for Peak {
    fn ports(&self) -> Ports {
        Ports { inputs: &["value"], outputs: &["maximum"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        self.maximum = self.maximum.max(inputs[0]);
        outputs[0] = self.maximum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_the_largest() {
        let mut peak = Peak::new();
        let mut out = [0.0];
        for (value, maximum) in [(-3.0, -3.0), (-1.0, -1.0), (-2.0, -1.0)] {
            peak.step(&[value], &mut out, 1e-4);
            assert_eq!(out, [maximum]);
        }
    }
}
