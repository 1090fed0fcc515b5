//! Inputs with derivatives: extrapolated to the samples inside a communication step.

use crate::table::place::Place;
use serde::{Deserialize, Serialize};

/// A derivative of a Real input.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Derivative {
    /// Value reference of the input.
    pub reference: u32,
    /// 1 for the first derivative.
    pub order: i32,
    /// In the unit of the input per second to the power of the order.
    pub value: f64,
}

impl Derivative {
    /// Contribution of this derivative to the input after `after` seconds: a term of the Taylor series.
    fn term(&self, after: f64) -> f64 {
        let mut factor = 1.0;
        for k in 1..=self.order {
            factor *= after / f64::from(k);
            // no more will come of it, however high the order
            if factor == 0.0 || factor.is_infinite() {
                break;
            }
        }
        self.value * factor
    }
}

/// A Real input that is extrapolated inside a step.
pub struct Slope<V> {
    place: Place<V, f64>,
    base: f64,
    derivatives: Vec<Derivative>,
}

impl<V> Slope<V> {
    /// The input that lies at `place`, from its present value on.
    ///
    /// None where that is no finite number: the importer has set it, and it stays.
    pub fn new(place: Place<V, f64>, vars: &V, derivatives: Vec<Derivative>) -> Option<Self> {
        let base = place.get(vars);
        base.is_finite().then_some(Self { place, base, derivatives })
    }

    /// Sets the input to its value `after` seconds from the start of the step.
    ///
    /// # Errors
    /// That value, where it is no finite number; the input keeps the one before.
    pub fn apply(&self, vars: &mut V, after: f64) -> Result<(), f64> {
        let terms = self.derivatives.iter().map(|derivative| derivative.term(after));
        let value = terms.fold(self.base, |sum, term| sum + term);
        if !value.is_finite() {
            return Err(value);
        }
        self.place.set(vars, value);
        Ok(())
    }

    /// Value reference of the input.
    pub fn reference(&self) -> u32 {
        self.derivatives[0].reference
    }

    /// Value and derivatives that the importer has set, as text for a message.
    pub fn to_text(&self) -> String {
        let derivative = |Derivative { order, value, .. }: &Derivative| format!("{value} (order {order})");
        let derivatives = self.derivatives.iter().map(derivative).collect::<Vec<_>>().join(", ");
        format!("{} with the derivatives {derivatives}", self.base)
    }

    /// Sets the input to the value that the master has set.
    pub fn restore(&self, vars: &mut V) {
        self.place.set(vars, self.base);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_those_of_the_taylor_sum() {
        let term = |order, value, after| Derivative { reference: 0, order, value }.term(after);
        assert_eq!(term(1, 3.0, 0.5), 1.5);
        assert_eq!(term(2, 8.0, 0.5), 1.0);
        assert_eq!(term(3, 6.0, 2.0), 8.0);
        let exponential: f64 = 1.0 + (1..=20).map(|order| term(order, 1.0, 1.0)).sum::<f64>();
        assert!((exponential - std::f64::consts::E).abs() < 1e-15);
        assert_eq!(term(i32::MAX, 1.0, 1e-3), 0.0);
    }
}
