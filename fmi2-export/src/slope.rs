//! Inputs with a first derivative: extrapolated to the samples inside a communication step.

use crate::place::Place;

/// A Real input that is extrapolated inside a step.
pub struct Slope<V> {
    place: Place<V, f64>,
    base: f64,
    slope: f64,
}

impl<V> Slope<V> {
    pub fn new(place: Place<V, f64>, vars: &V, slope: f64) -> Self {
        Self { place, base: place.get(vars), slope }
    }

    /// Sets the input to its value `after` seconds from the start of the step.
    pub fn apply(&self, vars: &mut V, after: f64) {
        self.place.set(vars, self.base + self.slope * after);
    }
}
