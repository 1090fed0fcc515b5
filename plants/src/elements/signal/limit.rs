//! Limit of the valid range of a plant.

use crate::element::{Element, Ports};

/// Stops the plant when `value` is outside `low..=high`.
#[derive(Clone, Debug)]
pub struct Limit {
    /// name of the value, with article
    quantity: String,
    unit: String,
    low: f64,
    high: f64,
    /// remedy
    hint: String,
    /// the rejected value
    refused: Option<f64>,
}

impl Limit {
    /// A limit of `quantity` in `unit` to the closed range from `low` to `high`, with a hint.
    pub fn new(quantity: String, unit: String, low: f64, high: f64, hint: String) -> Self {
        Self { quantity, unit, low, high, hint, refused: None }
    }
}

impl Element for Limit {
    fn ports(&self) -> Ports {
        Ports { inputs: &["value"], outputs: &[] }
    }

    fn step(&mut self, inputs: &[f64], _outputs: &mut [f64], _h: f64) {
        self.refused = Some(inputs[0]).filter(|value| !(self.low..=self.high).contains(value));
    }

    fn stop(&self) -> Option<String> {
        let Self { quantity, unit, low, high, hint, refused } = self;
        let value = (*refused)?;
        Some(format!("{quantity} is `{value:.6}` {unit}, limit `{low:.6}` to `{high:.6}` {unit}\nhint: {hint}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_outside_and_only_outside_with_value_limit_and_hint() {
        let mut limit = Limit::new("the oil".into(), "K".into(), -1.0, 2.5, "cool it".into());
        for value in [-1.0, 0.0, 2.5] {
            limit.step(&[value], &mut [], 1e-4);
            assert_eq!(limit.stop(), None, "at {value}");
        }
        limit.step(&[2.75], &mut [], 1e-4);
        let message = limit.stop().expect("beyond the limit");
        assert_eq!(message, "the oil is `2.750000` K, limit `-1.000000` to `2.500000` K\nhint: cool it");
    }
}
