//! Setpoint with a limited rate: the ramp of a drive.

use crate::element::{Element, Ports};

/// `value` moves to `target` at `rate` per second at most; the value at the start of the step acts during the step.
#[derive(Clone, Debug)]
pub struct Slew {
    /// largest change per second
    pub rate: f64,
    /// present value
    pub value: f64,
}

impl Element for Slew {
    fn ports(&self) -> Ports {
        Ports { inputs: &["target"], outputs: &["value"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        outputs[0] = self.value;
        let most = self.rate * h;
        self.value += (inputs[0] - self.value).clamp(-most, most);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_to_the_target_and_stays_there() {
        let mut slew = Slew { rate: 10.0, value: 1.0 };
        let mut out = [0.0];
        for value in [1.0, 2.0, 3.0, 3.5, 3.5] {
            slew.step(&[3.5], &mut out, 0.1);
            assert!((out[0] - value).abs() < 1e-12, "{} instead of {value}", out[0]);
        }
        slew.step(&[-9.0], &mut out, 0.1);
        slew.step(&[-9.0], &mut out, 0.1);
        assert!((out[0] - 2.5).abs() < 1e-12);
    }
}
