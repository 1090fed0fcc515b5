//! Memory of an event between the samples of the controller.

use crate::element::{Element, Ports};

/// `seen` is 0 until `value` has been positive once, then 1.
#[derive(Clone, Debug, Default)]
pub struct Latch {
    seen: bool,
}

impl Element for Latch {
    fn ports(&self) -> Ports {
        Ports { inputs: &["value"], outputs: &["seen"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        self.seen |= inputs[0] > 0.0;
        outputs[0] = f64::from(u8::from(self.seen));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remembers_the_first_positive_value() {
        let mut latch = Latch::default();
        let mut out = [9.0];
        for (value, seen) in [(0.0, 0.0), (-1.0, 0.0), (1e-300, 1.0), (-1.0, 1.0)] {
            latch.step(&[value], &mut out, 1e-4);
            assert_eq!(out, [seen]);
        }
    }
}
