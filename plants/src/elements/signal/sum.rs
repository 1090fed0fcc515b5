//! Summing junction; signs and units are set in the cells it is bound to.

use crate::element::{Element, Ports};

const NAMES: [&str; 8] = ["a", "b", "c", "d", "e", "f", "g", "h"];

/// `sum = a + b + ...`
#[derive(Clone, Debug)]
pub struct Sum {
    terms: usize,
}

impl Sum {
    /// Maximum number of terms of one sum.
    pub const TERMS_MAX: usize = NAMES.len();

    /// A junction of `terms` inputs, or none if there are more than [`Self::TERMS_MAX`].
    pub fn new(terms: usize) -> Option<Self> {
        (terms <= Self::TERMS_MAX).then_some(Self { terms })
    }
}

impl Element for Sum {
    fn ports(&self) -> Ports {
        Ports { inputs: &NAMES[..self.terms], outputs: &["sum"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        outputs[0] = inputs.iter().sum();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adds_its_inputs_and_refuses_too_many() {
        let mut sum = Sum::new(3).expect("three terms fit");
        let mut out = [0.0];
        sum.step(&[1.0, -2.5, 4.0], &mut out, 1e-4);
        assert_eq!(out, [2.5]);
        assert_eq!(sum.ports().inputs.len(), 3);
        assert!(Sum::new(Sum::TERMS_MAX + 1).is_none());
    }
}
