//! Product of two values: a switch, a variable gain.

use crate::element::{Element, Ports};

/// `product = a b`.
#[derive(Clone, Copy, Debug)]
pub struct Product;

impl Element for Product {
    fn ports(&self) -> Ports {
        Ports { inputs: &["a", "b"], outputs: &["product"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        outputs[0] = inputs[0] * inputs[1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiplies() {
        let mut out = [9.0];
        Product.step(&[3.0, -2.5], &mut out, 1e-4);
        assert_eq!(out, [-7.5]);
    }
}
