//! Noise with a bandwidth: white numbers through a first-order filter (Ornstein-Uhlenbeck process).

use crate::element::{Element, Ports};

/// `value` has standard deviation `rms` and autocorrelation `exp(-lag / time)`, whatever the plant step.
///
/// The input `normal` is one standard normal number per step; the process starts in its steady state.
#[derive(Clone, Debug)]
pub struct ColouredNoise {
    /// standard deviation
    rms: f64,
    /// correlation time, s
    time: f64,
    /// value now, none before the first step
    value: Option<f64>,
}

impl ColouredNoise {
    /// Noise of standard deviation `rms` and correlation time `time` s.
    pub fn new(rms: f64, time: f64) -> Self {
        Self { rms, time, value: None }
    }
}

impl Element for ColouredNoise {
    fn ports(&self) -> Ports {
        Ports { inputs: &["normal"], outputs: &["value"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let value = match self.value {
            None => self.rms * inputs[0],
            Some(value) => {
                // exact over the step: decay, and what keeps the variance
                let decay = (-h / self.time).exp();
                decay * value + self.rms * (1.0 - decay * decay).sqrt() * inputs[0]
            }
        };
        self.value = Some(value);
        outputs[0] = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// standard deviation and lag-one correlation of the filter, from its impulse response
    fn statistics(h: f64) -> (f64, f64) {
        let mut noise = ColouredNoise::new(2.0, 1e-3);
        let mut out = [0.0];
        noise.step(&[0.0], &mut out, h);
        let mut response = Vec::new();
        for k in 0..20_000 {
            noise.step(&[if k == 0 { 1.0 } else { 0.0 }], &mut out, h);
            response.push(out[0]);
        }
        let variance: f64 = response.iter().map(|r| r * r).sum();
        let covariance: f64 = response.windows(2).map(|r| r[0] * r[1]).sum();
        (variance.sqrt(), covariance / variance)
    }

    #[test]
    fn spread_and_correlation_do_not_depend_on_the_step() {
        for h in [1e-5, 5e-5, 1e-4] {
            let (deviation, correlation) = statistics(h);
            assert!((deviation - 2.0).abs() < 1e-9, "step {h}: deviation {deviation}");
            assert!((correlation - (-h / 1e-3_f64).exp()).abs() < 1e-9, "step {h}: correlation {correlation}");
        }
    }

    #[test]
    fn starts_in_the_steady_state() {
        let mut out = [0.0];
        ColouredNoise::new(2.0, 1e-3).step(&[1.5], &mut out, 1e-6);
        assert_eq!(out, [3.0]);
    }
}
