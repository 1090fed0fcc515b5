//! Integral of a value, such as the position of an axis from its velocity.

use crate::element::{Element, Ports};

/// `integral += value h`; the integral at the start of the step acts during the step.
#[derive(Clone, Debug)]
pub struct Integrator {
    /// present integral
    pub integral: f64,
}

impl Element for Integrator {
    fn ports(&self) -> Ports {
        Ports { inputs: &["value"], outputs: &["integral"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        outputs[0] = self.integral;
        self.integral += inputs[0] * h;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_velocity_is_a_straight_line_from_the_start() {
        let mut place = Integrator { integral: 2.0 };
        let mut out = [0.0];
        for k in 0..100 {
            place.step(&[-0.5], &mut out, 1e-2);
            assert!((out[0] - (2.0 - 0.5 * 1e-2 * f64::from(k))).abs() < 1e-13);
        }
    }
}
