//! First-order filter, as in the amplifier of a sensor.

use crate::element::{Element, Ports};

/// `filtered = lag(value)`: the exact answer at the end of a step during which the value was held.
#[derive(Clone, Debug)]
pub struct LowPass {
    /// rad/s
    pub bandwidth: f64,
    /// present value
    pub filtered: f64,
}

impl Element for LowPass {
    fn ports(&self) -> Ports {
        Ports { inputs: &["value"], outputs: &["filtered"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        self.filtered += (inputs[0] - self.filtered) * -(-self.bandwidth * h).exp_m1();
        outputs[0] = self.filtered;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_answered_by_the_exponential_at_any_step_size() {
        for (h, steps) in [(1e-4, 10), (1e-5, 100)] {
            let (mut filter, mut out) = (LowPass { bandwidth: 1000.0, filtered: 0.0 }, [0.0]);
            for _ in 0..steps {
                filter.step(&[2.0], &mut out, h);
            }
            assert!((out[0] - 2.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-12, "{h} s: {}", out[0]);
        }
    }
}
