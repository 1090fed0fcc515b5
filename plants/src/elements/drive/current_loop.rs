//! Closed current loop of a servo amplifier: a first-order lag, exact for a command held over the step.

use crate::element::{Element, Ports};

/// `current[A] = lag(command[A]) + noise[A]`; the current at the start of the step acts during the step.
#[derive(Clone, Debug)]
pub struct CurrentLoop {
    /// bandwidth, rad/s
    bandwidth: f64,
    /// lagged command, A
    current: f64,
}

impl CurrentLoop {
    /// A loop of `bandwidth` rad/s at zero current.
    pub fn new(bandwidth: f64) -> Self {
        Self { bandwidth, current: 0.0 }
    }
}

impl Element for CurrentLoop {
    fn ports(&self) -> Ports {
        Ports { inputs: &["command", "noise"], outputs: &["current"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let (command, noise) = (inputs[0], inputs[1]);
        // mean of the exponential over the step: the impulse of the force is exact
        let x = self.bandwidth * h;
        let next = command + (self.current - command) * (-x).exp();
        let mean = if x > 0.0 { command + (self.current - next) / x } else { self.current };
        self.current = next;
        outputs[0] = mean + noise;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(bandwidth: f64, h: f64, steps: usize) -> (f64, f64) {
        let mut current = CurrentLoop::new(bandwidth);
        let mut out = [0.0];
        let mut charge = 0.0;
        for _ in 0..steps {
            current.step(&[2.0, 0.0], &mut out, h);
            charge += out[0] * h;
        }
        (current.current, charge)
    }

    #[test]
    fn reaches_63_percent_after_one_time_constant() {
        let bandwidth = 1000.0;
        let (current, _) = run(bandwidth, 5e-5, 20);
        assert!((current - 2.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
    }

    #[test]
    fn charge_does_not_depend_on_the_step() {
        // integral of 2 (1 - exp(-w t)) from 0 to 1 ms at w = 1000 rad/s
        let exact = 2.0 * (1e-3 - (1.0 - (-1.0_f64).exp()) / 1000.0);
        for (h, steps) in [(1e-4, 10), (5e-5, 20), (1e-5, 100)] {
            assert!((run(1000.0, h, steps).1 - exact).abs() < 1e-15, "step {h}");
        }
    }

    #[test]
    fn noise_is_added() {
        let mut current = CurrentLoop::new(1000.0);
        let mut out = [0.0];
        current.step(&[0.0, 0.25], &mut out, 1e-4);
        assert_eq!(out, [0.25]);
    }
}
