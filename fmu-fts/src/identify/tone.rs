//! One sine of the identification: how long it is averaged, and how far it goes.

use std::f64::consts::TAU;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Largest error of the oscillation over the limit of the following error.
const ERROR_RATIO: f64 = 0.7;

/// Smallest averaging time, in whole periods, s: two periods of the lowest default frequency.
const AVERAGE_TIME: f64 = 0.2;

/// Expected response of loop and arm at a frequency, from which the amplitude of a tone follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Closed loop T, from reference to encoder.
    pub response: Complex<f64>,
    /// Amplitude of the torque over that of the arm, N.m/rad.
    pub stiffness: f64,
    /// Amplitude of the arm at the hub over that at the tool.
    pub hub_over_tool: f64,
}

/// One sine of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tone {
    /// Whole periods that are averaged.
    pub periods: u32,
    /// Samples of these periods.
    pub samples: u32,
    /// Amplitude of the set-point, rad.
    pub amplitude: f64,
}

impl Tone {
    /// The sine of a frequency (rad/s).
    pub fn new(p: &Parameters, omega: f64, expected: &Expected) -> Self {
        let per_sample = omega * p.sample_period / TAU;
        // rounding errors make no period more
        let periods = (omega * AVERAGE_TIME / TAU - 1e-9).ceil().max(1.0);
        let samples = (periods / per_sample).round();
        Self { periods: periods as u32, samples: samples as u32, amplitude: amplitude(p, omega, expected) }
    }

    /// Periods in one sample.
    pub fn frequency(&self) -> f64 {
        f64::from(self.periods) / f64::from(self.samples)
    }

    /// exp(-j phase) at sample `k` of the average.
    pub fn rotation(&self, k: u32) -> Complex<f64> {
        let cycles = u64::from(k) * u64::from(self.periods) % u64::from(self.samples);
        Complex::from_polar(1.0, -TAU * cycles as f64 / f64::from(self.samples))
    }
}

/// Amplitude of the set-point (rad): the tool moves as in the cut, or as far as the limits allow.
fn amplitude(p: &Parameters, omega: f64, expected: &Expected) -> f64 {
    let (identify, length) = (&p.identify, p.tool.arm_length[p.tool.index()]);
    let tool = identify.amplitude.min(identify.acceleration_max / (omega * omega));
    let torque = identify.torque_ratio * p.servo.torque_max;
    let arm = (expected.hub_over_tool * tool / length).min(torque / expected.stiffness);
    let error = ERROR_RATIO * p.limits.following_error / length;
    let (arm, behind) = (arm / expected.response.norm(), (1.0 - expected.response).norm());
    // without an error only the other limit counts
    if behind > 0.0 { arm.min(error / behind) } else { arm }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rigid arm under a loop with T = `response`.
    fn tone(p: &Parameters, hertz: f64, response: Complex<f64>) -> Tone {
        let omega = TAU * hertz;
        let stiffness = p.servo.inertia * omega * omega;
        Tone::new(p, omega, &Expected { response, stiffness, hub_over_tool: 1.0 })
    }

    #[test]
    fn whole_periods_in_whole_samples() {
        let p = Parameters::START;
        for (hertz, periods, samples) in
            [(10.0, 2, 2000), (30.0, 6, 2000), (230.0, 46, 2000), (17.3, 4, 2312), (2.0, 1, 5000)]
        {
            let tone = tone(&p, hertz, Complex::ONE);
            assert_eq!((tone.periods, tone.samples), (periods, samples), "{hertz} Hz");
            assert!((tone.frequency() * 1e4 / hertz - 1.0).abs() < 2e-4);
        }
    }

    #[test]
    fn the_rotation_is_exact_after_many_periods() {
        let tone = tone(&Parameters::START, 230.0, Complex::ONE);
        let sum: Complex<f64> = (0..tone.samples).map(|k| tone.rotation(k)).sum();
        assert!(sum.norm() < 1e-10, "{sum}");
        assert_eq!(tone.rotation(0), tone.rotation(tone.samples));
    }

    #[test]
    fn each_limit_counts_where_it_is_the_smallest() {
        let p = Parameters::START;
        let amplitude = |hertz: f64, t: f64| tone(&p, hertz, Complex::new(t, 0.0)).amplitude;
        // the amplitude of the cut at 10 Hz, half of 7 N.m at 100 Hz, a little more set-point where the loop lags
        assert!((amplitude(10.0, 1.0) - 1.75e-3 / 0.08).abs() < 1e-12);
        assert!((amplitude(100.0, 1.0) - 3.5 / 8e-4 / (TAU * 100.0).powi(2)).abs() < 1e-12);
        assert!((amplitude(200.0, 0.9) - 3.5 / 8e-4 / (TAU * 200.0).powi(2) / 0.9).abs() < 1e-12);
        // 0.7 of 1 mm of following error
        assert!((amplitude(10.0, 0.5) - 0.7e-3 / 0.08 / 0.5).abs() < 1e-12);
        let mut gentle = p.clone();
        gentle.identify.acceleration_max = 1.0;
        assert!((tone(&gentle, 100.0, Complex::ONE).amplitude - 1.0 / 0.08 / (TAU * 100.0).powi(2)).abs() < 1e-12);
        // a tool that oscillates four times as far as the hub
        let omega = TAU * 1e3;
        let bent = Expected { response: Complex::ONE, stiffness: p.servo.inertia * omega * omega, hub_over_tool: 0.25 };
        assert!((Tone::new(&p, omega, &bent).amplitude - 0.25 * 500.0 / 0.08 / (omega * omega)).abs() < 1e-12);
    }
}
