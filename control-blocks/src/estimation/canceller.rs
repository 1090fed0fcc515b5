//! Cancels one harmonic of an error: adaptive feedforward cancellation (Messner and Bodson, 1995).
//!
//! The output is u = Re c p with the phasor p = e^(j n theta) of the harmonic. Through a loop of the response T it makes
//! the error e = Re (d - T c) p, whose mean product with conj(p) is (d - T c) / 2. So
//!
//! ```text
//! c += 2 T_s / (tau T) e conj(p) = 2 T_s / (tau |T|) e conj(p) exp(-j arg T)
//! ```
//!
//! moves T c to d with the time constant tau, whatever T is, and stays stable while the phase of T is known within
//! pi/2. In a frame that turns with theta it needs no speed.

use num_complex::Complex;
use serde::{Deserialize, Serialize};

/// 2 T_s / (tau |T|) exp(-j arg T): the gain of [`Canceller::learn`] for the time constant `tau` (s), the sample period
/// `period` (s) and the response `t` of the loop, whose magnitude is never taken for less than `response_min`.
pub fn adaptation_gain(period: f64, tau: f64, t: Complex<f64>, response_min: f64) -> Complex<f64> {
    let magnitude = t.norm();
    let size = 2.0 * period / (tau * magnitude.max(response_min));
    if magnitude > 0.0 { t.conj() * (size / magnitude) } else { Complex::new(size, 0.0) }
}

/// Complex amplitude c of one harmonic, in the unit of the output; by default nothing is learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Canceller(Complex<f64>);

impl Canceller {
    /// Learns from the error of one sample with a gain that was prepared: c += gain conj(p) e.
    pub fn learn(&mut self, gain: Complex<f64>, phasor: Complex<f64>, error: f64) {
        self.0 += gain * phasor.conj() * error;
    }

    /// Removes the cause of the error of one sample: c -= conj(p) e size / response, where `response` is that
    /// from output to error and `size` = 2 T_s / tau.
    pub fn take_back(&mut self, size: f64, response: Complex<f64>, phasor: Complex<f64>, error: f64) {
        self.0 -= phasor.conj() * error * size / response;
    }

    /// Limits the amplitude; the phase stays.
    pub fn limit(&mut self, amplitude_max: f64) {
        let amplitude = self.amplitude();
        if amplitude > amplitude_max {
            // the divisor is never zero: a compiler may divide before it compares
            self.0 *= amplitude_max / amplitude.max(amplitude_max);
        }
    }

    /// Keeps the fraction `factor` of the amplitude.
    pub fn fade(&mut self, factor: f64) {
        self.0 *= factor;
    }

    /// Rotates and scales the learned amplitude with its harmonic.
    pub fn scale(&mut self, factor: Complex<f64>) {
        self.0 *= factor;
    }

    /// Re c p: the term added to the output in this sample.
    pub fn output(&self, phasor: Complex<f64>) -> f64 {
        self.0.re * phasor.re - self.0.im * phasor.im
    }

    /// Amplitude |c|, unit of the output.
    pub fn amplitude(&self) -> f64 {
        self.0.norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-3;
    const TAU: f64 = 0.5;
    /// radians of the harmonic in a sample: 40 Hz, 25 samples in a period
    const STEP: f64 = std::f64::consts::TAU / 25.0;

    /// Remainder of the disturbance d after `time` s with the loop `t`, as d - T c; `learn` takes phasor and error.
    fn left(
        d: Complex<f64>,
        t: Complex<f64>,
        time: f64,
        learn: impl Fn(&mut Canceller, Complex<f64>, f64),
    ) -> Complex<f64> {
        let mut canceller = Canceller::default();
        for k in 0..(time / DT).round() as u32 {
            let phasor = Complex::cis(STEP * f64::from(k % 25));
            let through = Canceller(t * canceller.0);
            learn(&mut canceller, phasor, Canceller(d).output(phasor) - through.output(phasor));
        }
        d - t * canceller.0
    }

    #[test]
    fn converges_with_its_time_constant_whatever_the_loop() {
        let d = Complex::new(0.3, -0.4);
        for phase in [-2.5, -0.7, 0.0, 1.9] {
            for magnitude in [0.2, 1.0, 3.0] {
                let t = Complex::from_polar(magnitude, phase);
                let gain = adaptation_gain(DT, TAU, t, 0.05);
                for time in [TAU, 2.0 * TAU, 4.0 * TAU] {
                    let now = left(d, t, time, |c, phasor, error| c.learn(gain, phasor, error));
                    // the product with conj(p) has the double frequency, too: a ripple of T_s / (tau sin(step))
                    assert!((now - d * (-time / TAU).exp()).norm() < 0.01 * d.norm(), "{t} after {time} s: {now}");
                }
                assert!(left(d, t, 40.0 * TAU, |c, phasor, error| c.learn(gain, phasor, error)).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn taking_back_is_the_same_law() {
        let (d, t) = (Complex::new(0.3, -0.4), Complex::from_polar(0.8, 1.2));
        let gain = adaptation_gain(DT, TAU, t, 0.05);
        let learned = left(d, t, TAU, |c, phasor, error| c.learn(gain, phasor, error));
        // the response from output to error is -T
        let taken = left(d, t, TAU, |c, phasor, error| c.take_back(2.0 * DT / TAU, -t, phasor, error));
        assert!((learned - taken).norm() < 1e-14);
    }

    #[test]
    fn a_phase_that_is_wrong_by_more_than_a_quarter_diverges() {
        let t = Complex::ONE;
        for (wrong, stable) in [(1.4, true), (1.75, false)] {
            let gain = adaptation_gain(DT, TAU, t * Complex::cis(wrong), 0.05);
            let now = left(Complex::ONE, t, 10.0 * TAU, |c, phasor, error| c.learn(gain, phasor, error));
            assert_eq!(now.norm() < 1.0, stable, "{wrong} rad: {now}");
        }
    }

    #[test]
    fn a_loop_without_response_has_a_finite_gain() {
        let limit = 2.0 * DT / (TAU * 0.05);
        assert!((adaptation_gain(DT, TAU, Complex::new(0.0, 0.01), 0.05) - Complex::new(0.0, -limit)).norm() < 1e-15);
        assert_eq!(adaptation_gain(DT, TAU, Complex::ZERO, 0.05), Complex::new(limit, 0.0));
    }

    #[test]
    fn limit_and_fading_keep_the_phase() {
        let mut canceller = Canceller(Complex::new(3.0, -4.0));
        canceller.limit(10.0);
        assert_eq!(canceller.amplitude(), 5.0);
        canceller.limit(2.5);
        assert_eq!(canceller, Canceller(Complex::new(1.5, -2.0)));
        canceller.fade(0.5);
        assert_eq!(canceller, Canceller(Complex::new(0.75, -1.0)));
    }

    #[test]
    fn what_was_learned_goes_along_with_what_it_belongs_to() {
        let mut canceller = Canceller::default();
        canceller.learn(Complex::new(2.0, 0.0), Complex::new(1.0, 0.0), 1.0);
        canceller.scale(Complex::new(0.0, 1.5));
        // 2 cos(x) has become 3 cos(x + pi / 2)
        assert!((canceller.output(Complex::new(0.0, 1.0)) + 3.0).abs() < 1e-15);
        assert!(canceller.output(Complex::new(1.0, 0.0)).abs() < 1e-15);
    }
}
