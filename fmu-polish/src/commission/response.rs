//! Loops and delay of the drives from the answer of the axes to pulses in the air.
//!
//! With the velocity U of the pulses and the position Y of a tone at the frequency w an axis obeys
//!
//! ```text
//! Y = T H exp(-j w T_s d) U,   T = V (K_pp + F) / (s + V K_pp),   F = K_ff s / (1 + s / w_ff),   V = A / (s^2 + b s + A),
//! ```
//!
//! A = w_v (s + w_i), s = j w, with the held velocity H and the delay d in samples. Found are ln K_pp, K_ff, ln w_v, d and b, which all
//! axes have in common; `drive.feedforward_bandwidth` and `drive.velocity_integral` are believed. The friction of the guides takes about
//! the same share b of every tone, as the sign of a sum of many tones goes with it (random-input describing function), so b
//! belongs to the excitation and is told to nobody. From N = K_pp + F and D = s + V K_pp follow dT/dK_pp = V (1 - T) / D,
//! dT/dF = V / D, dT/dV = (N - T K_pp) / D, dV/d ln w_v = V (1 - V), and dV/db = -s V^2 / A.

use control_blocks::{
    Estimate, HARMONICS, NoEstimate, Observation, PeriodicSpectra, SpectralLine, TONES, least_squares,
};
use nalgebra::{Complex, SVector};

use crate::commission::plan::Plan;
use crate::force::response::{hold, rubbed_axis};
use crate::interface::{Drive, Parameters};

/// Unknowns ln K_pp, K_ff, ln w_v, d, b.
type Unknowns = SVector<f64, UNKNOWNS>;

/// How many they are.
const UNKNOWNS: usize = 5;

/// No tone counts as known better than to this share: the friction of the guides is no linear part.
const LEAST_DEVIATION: f64 = 3e-3;
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
    fn new(p: &'a Parameters, omega: f64, line: SpectralLine) -> Self {
        Self { drive: &p.drive, omega, held: hold(p, omega), sample: omega * p.sample_period, line }
    }

    /// Response from the velocity of the pulses to the position, s.
    fn response(&self, x: &Unknowns) -> Complex<f64> {
        rubbed_axis(&drive(self.drive, x), x[4], self.omega) * self.late(x)
    }

    fn late(&self, x: &Unknowns) -> Complex<f64> {
        self.held * Complex::cis(-self.sample * x[3])
    }

    /// Derivatives of the response by the unknowns.
    fn gradient(&self, x: &Unknowns) -> [Complex<f64>; UNKNOWNS] {
        let (found, s) = (drive(self.drive, x), Complex::new(0.0, self.omega));
        let push = found.velocity_bandwidth * (s + found.velocity_integral);
        let velocity = push / (s * (s + x[4]) + push);
        let ahead = s / (1.0 + s / found.feedforward_bandwidth);
        let (gain, denominator) = (found.position_gain, s + velocity * found.position_gain);
        let whole = rubbed_axis(&found, x[4], self.omega);
        let by_velocity = (gain + found.feedforward * ahead - whole * gain) / denominator;
        let by = [
            gain * velocity * (1.0 - whole) / denominator,
            velocity * ahead / denominator,
            velocity * (1.0 - velocity) * by_velocity,
            Complex::new(0.0, -self.sample) * whole,
            -s * velocity * velocity / push * by_velocity,
        ];
        by.map(|part| part * self.late(x))
    }

    /// Standard deviation of each part of the position less that of the model.
    fn deviation(&self, x: &Unknowns) -> f64 {
        let (g, line) = (self.response(x), &self.line);
        let noise = line.output_variance + g.norm_sqr() * line.input_variance - 2.0 * (g.conj() * line.covariance).re;
        let least = LEAST_DEVIATION * (g * line.input).norm();
        (0.5 * noise.max(0.0) + least * least).sqrt().max(f64::MIN_POSITIVE)
    }
}

/// The drive with the unknowns.
fn drive(told: &Drive, x: &Unknowns) -> Drive {
    Drive { position_gain: x[0].exp(), feedforward: x[1], velocity_bandwidth: x[2].exp(), ..*told }
}

/// The unknowns that explain the excitation of all axes best, with their covariance.
///
/// # Errors
/// When it does not tell them apart.
pub fn response(p: &Parameters, plan: &Plan, spectra: &[PeriodicSpectra; AXES]) -> Result<Estimate<UNKNOWNS>, NoEstimate> {
    let frequencies = plan.sines.frequencies();
    let tones: [Tone; AXES * TONES] =
        std::array::from_fn(|i| Tone::new(p, frequencies[i % TONES], spectra[i / TONES].line(i % TONES)));
    let d = &p.drive;
    let told =
        Unknowns::from([d.position_gain.ln(), d.feedforward, d.velocity_bandwidth.ln(), f64::from(p.io_delay), 0.0]);
    // the variances are those at what was told, then at what was found
    let first = fit(&tones, told, &told)?;
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
