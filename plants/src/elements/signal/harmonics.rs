//! Periodic disturbance of a rotating part: a sum of harmonics of its angle.

use crate::element::{Element, Ports};

/// `value = sum over n of amplitude_n sin(n angle + phase_n)`, n = 1, 2, ...
#[derive(Clone, Debug)]
pub struct Harmonics {
    /// amplitude and phase (rad) of each order, first order first
    orders: Vec<(f64, f64)>,
}

impl Harmonics {
    /// Harmonics 1, 2, ... with the amplitude and phase (rad) of each.
    pub fn new(orders: Vec<(f64, f64)>) -> Self {
        Self { orders }
    }
}

impl Element for Harmonics {
    fn ports(&self) -> Ports {
        Ports { inputs: &["angle"], outputs: &["value"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let orders = (1..).zip(&self.orders);
        outputs[0] = orders.map(|(n, (amplitude, phase))| amplitude * (f64::from(n) * inputs[0] + phase).sin()).sum();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn sums_the_orders() {
        let mut harmonics = Harmonics::new(vec![(3.0, 0.0), (0.5, FRAC_PI_2)]);
        let mut out = [0.0];
        // 3 sin(a) + 0.5 cos(2 a)
        for (angle, value) in [(0.0, 0.5), (FRAC_PI_2, 2.5), (PI, 0.5), (3.0 * FRAC_PI_2, -3.5)] {
            harmonics.step(&[angle], &mut out, 1e-4);
            assert!((out[0] - value).abs() < 1e-14, "at {angle} rad: {}", out[0]);
        }
    }
}
