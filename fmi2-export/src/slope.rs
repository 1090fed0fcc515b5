//! Inputs with a first derivative: extrapolated to the samples inside a communication step.

use crate::export::Index;
use crate::variable::Kind;

/// A Real input that is extrapolated inside a step.
pub struct Slope<V: 'static> {
    set: fn(&mut V, usize, f64),
    element: usize,
    base: f64,
    slope: f64,
}

impl<V> Slope<V> {
    pub fn new(index: &Index<V>, vars: &V, (reference, slope): (u32, f64)) -> Self {
        let (row, element) = index.entries[reference as usize];
        match row.kind {
            Kind::Real { get, set, .. } => Self { set, element, base: get(vars, element), slope },
            _ => unreachable!("derivatives are accepted for Real inputs only"),
        }
    }

    /// Sets the input to its value `after` seconds from the start of the step.
    pub fn apply(&self, vars: &mut V, after: f64) {
        (self.set)(vars, self.element, self.base + self.slope * after);
    }
}
