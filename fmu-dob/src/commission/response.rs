//! Thrust, delay, friction and stiffness from the response to the excitation.
//!
//! With the current U and the position Y of a tone at the frequency w the stage obeys
//!
//! ```text
//! (-w^2 + j w b + c) Y = g L U,   L = exp(-j w T_s (d + 1/2)) sinc(w T_s / 2) / (1 + j w / w_i),
//! ```
//!
//! g = K_t / M, b = B / M, c = C / M, the delay d in samples, a held command and the current loop. Mass and thrust
//! are not observable, only their ratio; `stage.mass` is used as configured, and all forces are those of a stage of
//! that mass. Each tone has the variance of the left side minus the right; the four unknowns follow from weighted least
//! squares.

use control_blocks::{
    Estimate, HARMONICS, NoEstimate, Observation, PeriodicSpectra, SpectralLine, TONES, least_squares,
};
use nalgebra::{Complex, SVector};

use crate::commission::plan::Plan;
use crate::interface::Parameters;

/// Unknowns g, d, b, c.
pub type Unknowns = SVector<f64, 4>;

/// Ripple of the thrust over the magnet pitch, of which a short travel shows one value: 1 % is usual, 2^(-1/2) of it as
/// standard deviation.
const RIPPLE: f64 = 0.007;
/// Relative standard deviation of the lag of a current loop that is known to 30 %, uniformly: 0.3 / 3^(1/2).
const LOOP_SPREAD: f64 = 0.17;

/// Minimum relative uncertainty of a tone: the model error.
const STD_MIN: f64 = 1e-4;

/// The stage at one frequency.
struct Tone {
    omega: f64,
    /// L at the delay 0
    held: Complex<f64>,
    /// phase of one sample, rad
    sample: f64,
    line: SpectralLine,
}

impl Tone {
    fn new(p: &Parameters, omega: f64, line: SpectralLine) -> Self {
        let sample = omega * p.sample_period;
        let hold = Complex::from_polar((0.5 * sample).sin() / (0.5 * sample), -0.5 * sample);
        Self { omega, held: hold / Complex::new(1.0, omega / p.stage.current_bandwidth), sample, line }
    }

    /// Factors of Y and U.
    fn sides(&self, x: &Unknowns) -> [Complex<f64>; 2] {
        let inertia = Complex::new(x[3] - self.omega * self.omega, self.omega * x[2]);
        [inertia, self.held * Complex::cis(-self.sample * x[1]) * x[0]]
    }

    /// Standard deviation of each part of the left side less the right.
    fn deviation(&self, x: &Unknowns) -> f64 {
        let ([a, b], line) = (self.sides(x), &self.line);
        let noise = a.norm_sqr() * line.output_variance + b.norm_sqr() * line.input_variance
            - 2.0 * (a * b.conj() * line.covariance).re;
        let minimum = STD_MIN * (b * line.input).norm();
        (0.5 * noise.max(0.0) + minimum * minimum).sqrt().max(f64::MIN_POSITIVE)
    }

    /// Left side less the right, and its derivatives.
    fn difference(&self, x: &Unknowns) -> (Complex<f64>, [Complex<f64>; 4]) {
        let ([a, b], line) = (self.sides(x), &self.line);
        let push = b * line.input;
        let unit = self.held * Complex::cis(-self.sample * x[1]) * line.input;
        let by_delay = push * Complex::new(0.0, self.sample);
        (a * line.output - push, [-unit, by_delay, Complex::new(0.0, self.omega) * line.output, line.output])
    }
}

/// Standard deviation of the thrust constant over that here.
pub fn ripple(force_constant: f64) -> f64 {
    RIPPLE * force_constant.abs()
}

/// Standard deviation of the delay (samples) by the current loop: an error of its lag appears as delay.
pub fn loop_spread(p: &Parameters) -> f64 {
    LOOP_SPREAD / (p.stage.current_bandwidth * p.sample_period)
}

/// The unknowns that explain the excitation best, with their covariance.
///
/// # Errors
/// When they cannot be distinguished.
pub fn response(p: &Parameters, plan: &Plan, spectra: &PeriodicSpectra) -> Result<Estimate<4>, NoEstimate> {
    let frequencies = plan.excitation.sines.frequencies();
    let tones: [Tone; TONES] = std::array::from_fn(|i| Tone::new(p, frequencies[i], spectra.line(i)));
    let nominal = Unknowns::from([p.stage.force_constant / p.stage.mass, f64::from(p.io_delay), 0.0, 0.0]);
    // the variances are those at the configured values, then at the found ones
    let first = fit(&tones, nominal, &nominal)?;
    fit(&tones, first.value, &first.value)
}

fn fit(tones: &[Tone; TONES], start: Unknowns, at: &Unknowns) -> Result<Estimate<4>, NoEstimate> {
    let deviations: [f64; TONES] = std::array::from_fn(|i| tones[i].deviation(at));
    least_squares(start, 2 * HARMONICS.len(), |i, x| {
        let (tone, imaginary) = (&tones[i / 2], i % 2 == 1);
        let (difference, gradient) = tone.difference(x);
        let part = |z: Complex<f64>| if imaginary { z.im } else { z.re } / deviations[i / 2];
        Observation { residual: part(difference), gradient: SVector::from(gradient.map(part)) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// The stage at `omega` rad/s: its motion over the commanded current (m/A), and its phase lag (rad).
    fn answer(p: &Parameters, x: Unknowns, omega: f64) -> [f64; 2] {
        let (push, damping, half) = (x[3] - omega * omega, omega * x[2], 0.5 * omega * p.sample_period);
        let loop_ratio = omega / p.stage.current_bandwidth;
        let ratio = x[0] * half.sin() / half / loop_ratio.hypot(1.0) / push.hypot(damping);
        [ratio, damping.atan2(push) + half * (2.0 * x[1] + 1.0) + loop_ratio.atan()]
    }

    /// Estimate of the unknowns of a stage that has the values `x`, from its response to the excitation; white noise of
    /// the standard deviation `noise` (m) is added to the position.
    fn found(p: &Parameters, x: Unknowns, noise: f64, seed: u64) -> Result<Estimate<4>, NoEstimate> {
        let plan = Plan::new(p);
        let answers = plan.excitation.sines.frequencies().map(|omega| (omega, answer(p, x, omega)));
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut spectra = PeriodicSpectra::default();
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        for k in 0..plan.excitation.measured() {
            let (mut current, mut position) = (0.0, 1e-6 + noise * normal());
            for (omega, [ratio, late]) in answers {
                // each tone moves by 0.2 um
                let phase = omega * p.sample_period * f64::from(k % plan.excitation.sines.period);
                current += 2e-7 / ratio * (phase + late).cos();
                position += 2e-7 * phase.cos();
            }
            spectra.update(plan.excitation.sines.period, current, position);
        }
        response(p, &plan, &spectra)
    }

    #[test]
    fn every_unknown_is_found_far_from_what_was_configured() {
        let p = Parameters::START;
        for expected in [[1.1, 0.0, 1.0, 4.0], [2.0, 1.0, 0.0, 0.0], [3.6, 2.6, 5.0, -30.0]] {
            let value = found(&p, Unknowns::from(expected), 0.0, 1).unwrap().value;
            let spread = [1e-6, 1e-4, 1e-3, 1e-2];
            (0..4).for_each(|i| assert!((value[i] - expected[i]).abs() < spread[i], "{expected:?}: {value}"));
        }
    }

    #[test]
    fn the_deviation_is_the_scatter_of_the_estimates() {
        let (p, actual) = (Parameters::START, Unknowns::from([1.8, 1.3, 1.0, 5.0]));
        // one percent, so that the minimum uncertainty of a tone has no effect
        let all: Vec<Estimate<4>> = (0..60).map(|seed| found(&p, actual, 3e-7, seed).unwrap()).collect();
        for i in 0..4 {
            let expected = all.iter().map(|one| one.sigma(i)).sum::<f64>() / all.len() as f64;
            let scatter = all.iter().map(|one| (one.value[i] - actual[i]).powi(2)).sum::<f64>() / all.len() as f64;
            let ratio = scatter.sqrt() / expected;
            assert!((0.6..1.4).contains(&ratio), "{i}: {ratio}");
        }
    }

    #[test]
    fn the_derivatives_are_those_of_the_difference() {
        let (p, x) = (Parameters::START, Unknowns::from([2.0, 1.0, 3.0, -20.0]));
        let line = SpectralLine {
            input: Complex::new(0.3, -0.2),
            output: Complex::new(1e-6, 4e-6),
            ..SpectralLine::default()
        };
        let tone = Tone::new(&p, 300.0, line);
        let (_, gradient) = tone.difference(&x);
        for (i, step) in [1e-3, 1e-3, 1.0, 1.0].into_iter().enumerate() {
            let at = |sign: f64| {
                let mut x = x;
                x[i] += sign * step;
                tone.difference(&x).0
            };
            let slope = (at(1.0) - at(-1.0)) / (2.0 * step);
            assert!((slope - gradient[i]).norm() < 1e-6 * slope.norm(), "{i}: {slope} {}", gradient[i]);
        }
    }

    #[test]
    fn a_current_that_scatters_with_its_answer_is_no_noise() {
        let (p, x) = (Parameters::START, Unknowns::from([2.0, 1.0, 3.0, -20.0]));
        let mut tone = Tone::new(&p, 300.0, SpectralLine::default());
        let [left, right] = tone.sides(&x);
        // by a hundredth of its size, with noise of the response in addition
        let answer = right / left;
        let noise = 1e-3 * (0.01 * answer).norm_sqr();
        tone.line = SpectralLine {
            input: Complex::new(1.0, 0.0),
            output: answer,
            input_variance: 1e-4,
            output_variance: 1e-4 * answer.norm_sqr() + noise,
            covariance: 1e-4 * answer,
        };
        let minimum = STD_MIN * right.norm();
        let expected = (0.5 * noise * left.norm_sqr()).sqrt().hypot(minimum);
        assert!((tone.deviation(&x) / expected - 1.0).abs() < 1e-6, "{} {expected}", tone.deviation(&x));
    }

    #[test]
    fn a_stage_that_does_not_answer_shows_nothing() {
        let (p, plan) = (Parameters::START, Plan::new(&Parameters::START));
        let mut spectra = PeriodicSpectra::default();
        (0..plan.excitation.measured()).for_each(|_| spectra.update(plan.excitation.sines.period, 0.0, 1.0));
        assert!(response(&p, &plan, &spectra).is_err());
    }
}
