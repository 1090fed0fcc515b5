//! Speed of the drives and delay from the response of the axes to pulses in the air.
//!
//! With the velocity U of the pulses and the position Y of a tone at the frequency w an axis obeys
//!
//! ```text
//! Y = T H exp(-j w T_s d) U,   T = V (K_pp + F) / (s + V K_pp),   F = K_ff s / (1 + s / w_ff),   V = A / (s^2 + c + A),
//! ```
//!
//! A = w_v (s + w_i), s = j w, with the held velocity H and the delay d in samples. Position and velocity loop are as
//! configured, except for a common factor g: below 100 Hz the two hardly differ. Rolling guides act like a spring c
//! over the inertia. It belongs to the excitation and is not an output. The estimates are ln g, K_ff, d and c, common
//! to all axes. From N = K_pp + F and D = s + V K_pp follow dT/dK_pp = V (1 - T) / D, dT/dF = V / D, dT/dV = (N - T
//! K_pp) / D, dV/d ln w_v = V (1 - V), dV/dc = -V^2 / A.

use control_blocks::{
    Estimate, HARMONICS, NoEstimate, Observation, PeriodicSpectra, SpectralLine, TONES, least_squares,
};
use nalgebra::{Complex, SVector};

use crate::commission::plan::Plan;
use crate::force::response::{hold, rolling_axis};
use crate::interface::{Drive, Parameters};

/// Unknowns ln g, K_ff, d, c.
type Unknowns = SVector<f64, UNKNOWNS>;

/// How many they are.
const UNKNOWNS: usize = 4;

/// Minimum relative uncertainty of a tone: the friction of the guides is nonlinear.
const STD_MIN: f64 = 3e-3;
/// What the friction of rolling guides leaves to gain (relative), feedforward and delay (samples), as deviations. It
/// does not grow with the motion, so no linear part stands for it: 2 N that turn over 20 um, on axes of 8, 19 and 31 kg
/// with g and K_ff within 30 %, let the loops seem 13 % faster, 0.10 less fed forward and 0.04 samples more of delay,
/// as a root of the mean square.
pub const GUIDES: [f64; 3] = [0.13, 0.10, 0.04];
/// Axes.
const AXES: usize = 3;

/// An axis at one frequency.
struct Tone<'a> {
    drive: &'a Drive,
    omega: f64,
    /// way of the held velocity
    held: Complex<f64>,
    /// phase of one sample, rad
    sample: f64,
    line: SpectralLine,
}

impl<'a> Tone<'a> {
    fn new(p: &Parameters, drive: &'a Drive, omega: f64, line: SpectralLine) -> Self {
        Self { drive, omega, held: hold(p, omega), sample: omega * p.sample_period, line }
    }

    /// Response from the velocity of the pulses to the position, s.
    fn response(&self, x: &Unknowns) -> Complex<f64> {
        rolling_axis(&found(self.drive, x), x[3], self.omega) * self.late(x)
    }

    fn late(&self, x: &Unknowns) -> Complex<f64> {
        self.held * Complex::cis(-self.sample * x[2])
    }

    /// Derivatives of the response by the unknowns.
    fn gradient(&self, x: &Unknowns) -> [Complex<f64>; UNKNOWNS] {
        let (d, s) = (found(self.drive, x), Complex::new(0.0, self.omega));
        let push = d.velocity_bandwidth * (s + d.velocity_integral);
        let velocity = push / (s * s + x[3] + push);
        let ahead = s / (1.0 + s / d.feedforward_bandwidth);
        let (gain, denominator) = (d.position_gain, s + velocity * d.position_gain);
        let whole = rolling_axis(&d, x[3], self.omega);
        let by_velocity = (gain + d.feedforward * ahead - whole * gain) / denominator;
        let by_bandwidth = velocity * (1.0 - velocity);
        let by = [
            gain * velocity * (1.0 - whole) / denominator + by_bandwidth * by_velocity,
            velocity * ahead / denominator,
            Complex::new(0.0, -self.sample) * whole,
            -velocity * velocity / push * by_velocity,
        ];
        by.map(|part| part * self.late(x))
    }

    /// Standard deviation of each part of the position less that of the model.
    fn deviation(&self, x: &Unknowns) -> f64 {
        let (g, line) = (self.response(x), &self.line);
        let noise = line.output_variance + g.norm_sqr() * line.input_variance - 2.0 * (g.conj() * line.covariance).re;
        let minimum = STD_MIN * (g * line.input).norm();
        (0.5 * noise.max(0.0) + minimum * minimum).sqrt().max(f64::MIN_POSITIVE)
    }
}

/// The drive with the unknowns.
fn found(nominal: &Drive, x: &Unknowns) -> Drive {
    nominal.faster(x[0].exp(), x[1])
}

/// The unknowns ln g, K_ff, d and c that explain the excitation of all axes with the drives `drive` best, with their
/// covariance.
///
/// # Errors
/// When the data do not determine the parameters.
pub fn response(
    p: &Parameters,
    drive: &Drive,
    plan: &Plan,
    spectra: &[PeriodicSpectra; AXES],
) -> Result<Estimate<UNKNOWNS>, NoEstimate> {
    let frequencies = plan.excitation.sines.frequencies();
    let tones: [Tone; AXES * TONES] =
        std::array::from_fn(|i| Tone::new(p, drive, frequencies[i % TONES], spectra[i / TONES].line(i % TONES)));
    let nominal = Unknowns::from([0.0, drive.feedforward, f64::from(p.io_delay), 0.0]);
    // the variances are those at the configured values, then at the estimates
    let first = fit(&tones, nominal, &nominal)?;
    fit(&tones, first.value, &first.value)
}

fn fit(tones: &[Tone; AXES * TONES], start: Unknowns, at: &Unknowns) -> Result<Estimate<UNKNOWNS>, NoEstimate> {
    let deviations: [f64; AXES * TONES] = std::array::from_fn(|i| tones[i].deviation(at));
    least_squares(start, 2 * AXES * HARMONICS.len(), |i, x| {
        let (tone, imaginary) = (&tones[i / 2], i % 2 == 1);
        let part = |z: Complex<f64>| if imaginary { z.im } else { z.re } / deviations[i / 2];
        let input = tone.line.input;
        Observation {
            residual: part(tone.response(x) * input - tone.line.output),
            gradient: SVector::from(tone.gradient(x).map(|by| part(by * input))),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const P: Parameters = Parameters::START;

    /// Estimate of the unknowns of axes that have the values `x`, from their response to the excitation; white noise of
    /// the standard deviation `noise` (m) is added to the positions.
    fn answer(p: &Parameters, x: Unknowns, noise: f64, seed: u64) -> Result<Estimate<UNKNOWNS>, NoEstimate> {
        let plan = Plan::new(p);
        let tones =
            plan.excitation.sines.frequencies().map(|omega| Tone::new(p, &p.drive, omega, SpectralLine::default()));
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut spectra: [PeriodicSpectra; AXES] = Default::default();
        for (i, k) in (0..AXES).flat_map(|i| (0..plan.excitation.measured()).map(move |k| (i, k))) {
            let (mut velocity, mut position) = (0.0, 0.3 + noise * normal());
            for tone in &tones {
                // each tone moves by 10 um
                let angle = tone.sample * f64::from(k % plan.excitation.sines.period);
                let phasor = Complex::from_polar(10e-6 * tone.omega, angle);
                velocity += phasor.re;
                position += (phasor * tone.response(&x)).re;
            }
            spectra[i].update(plan.excitation.sines.period, velocity, position);
        }
        response(p, &p.drive, &plan, &spectra)
    }

    #[test]
    fn every_unknown_is_found_far_from_the_configured_values() {
        for actual in [[0.0, 0.8, 1.0, 0.0], [-0.5, 0.4, 0.0, 3e3], [0.6, 1.0, 2.6, -2e3]] {
            let value = answer(&P, Unknowns::from(actual), 0.0, 1).unwrap().value;
            let spread = [1e-6, 1e-6, 1e-6, 1e-2];
            (0..UNKNOWNS).for_each(|i| assert!((value[i] - actual[i]).abs() < spread[i], "{actual:?}: {value}"));
        }
    }

    #[test]
    fn the_deviation_is_the_scatter_of_the_estimates() {
        let actual = Unknowns::from([0.2, 0.7, 1.3, 1e3]);
        // much noise, so that the minimum deviation of a tone has no effect
        let all: Vec<_> = (0..60).map(|seed| answer(&P, actual, 5e-6, seed).unwrap()).collect();
        for i in 0..UNKNOWNS {
            let nominal = all.iter().map(|one| one.sigma(i)).sum::<f64>() / all.len() as f64;
            let scatter = all.iter().map(|one| (one.value[i] - actual[i]).powi(2)).sum::<f64>() / all.len() as f64;
            let ratio = scatter.sqrt() / nominal;
            assert!((0.6..1.4).contains(&ratio), "{i}: {ratio}");
        }
    }

    #[test]
    fn the_derivatives_are_those_of_the_response() {
        let drive = P.drive;
        let tone = Tone::new(&P, &drive, 250.0, SpectralLine::default());
        let x = Unknowns::from([0.3, 0.6, 1.4, 2e3]);
        for (i, by) in tone.gradient(&x).into_iter().enumerate() {
            let step = [1e-6, 1e-6, 1e-6, 1e-1][i];
            let mut near = [x, x];
            (near[0][i], near[1][i]) = (x[i] - step, x[i] + step);
            let expected = (tone.response(&near[1]) - tone.response(&near[0])) / (2.0 * step);
            assert!((by - expected).norm() < 1e-6 * expected.norm(), "{i}: {by} {expected}");
        }
    }

    #[test]
    fn axes_that_do_not_answer_show_nothing() {
        let plan = Plan::new(&P);
        let mut spectra: [PeriodicSpectra; AXES] = Default::default();
        (0..plan.excitation.measured())
            .for_each(|_| spectra.iter_mut().for_each(|axis| axis.update(plan.excitation.sines.period, 0.0, 1.0)));
        assert!(response(&P, &P.drive, &plan, &spectra).is_err());
    }
}
