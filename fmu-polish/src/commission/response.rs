//! Speed of the drives and delay from the answer of the axes to pulses in the air.
//!
//! With the velocity U of the pulses and the position Y of a tone at the frequency w an axis obeys
//!
//! ```text
//! Y = T H exp(-j w T_s d) U,   T = V (K_pp + F) / (s + V K_pp),   F = K_ff s / (1 + s / w_ff),   V = A / (s^2 + c + A),
//! ```
//!
//! A = w_v (s + w_i), s = j w, with the held velocity H and the delay d in samples. Position and velocity loop are as told but for a common
//! factor g: apart they hardly differ below 100 Hz. Guides that roll pull back like a spring c over the inertia; it belongs to the
//! excitation and is told to nobody. Found are ln g, K_ff, d and c, which all axes have in common. From N = K_pp + F and D = s + V K_pp
//! follow dT/dK_pp = V (1 - T) / D, dT/dF = V / D, dT/dV = (N - T K_pp) / D, dV/d ln w_v = V (1 - V), dV/dc = -V^2 / A.

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
        let least = LEAST_DEVIATION * (g * line.input).norm();
        (0.5 * noise.max(0.0) + least * least).sqrt().max(f64::MIN_POSITIVE)
    }
}

/// The drive with the unknowns.
fn found(told: &Drive, x: &Unknowns) -> Drive {
    told.faster(x[0].exp(), x[1])
}

/// The unknowns ln g, K_ff, d and c that explain the excitation of all axes with the drives `drive` best, with their covariance.
///
/// # Errors
/// When it does not tell them apart.
pub fn response(
    p: &Parameters,
    drive: &Drive,
    plan: &Plan,
    spectra: &[PeriodicSpectra; AXES],
) -> Result<Estimate<UNKNOWNS>, NoEstimate> {
    let frequencies = plan.sines.frequencies();
    let tones: [Tone; AXES * TONES] =
        std::array::from_fn(|i| Tone::new(p, drive, frequencies[i % TONES], spectra[i / TONES].line(i % TONES)));
    let told = Unknowns::from([0.0, drive.feedforward, f64::from(p.io_delay), 0.0]);
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
