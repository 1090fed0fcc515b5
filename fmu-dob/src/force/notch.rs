//! Notch filters that follow the spindle: noise related to spindle rotation.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::interface::{HARMONICS_MAX, Parameters};

/// Relative speed change that makes new coefficients.
const RETUNE: f64 = 1e-3;
/// Quality Q of each notch: width of half the frequency, so that 1 % of speed error costs no attenuation.
const QUALITY: f64 = 2.0;
/// Harmonics above this fraction of the Nyquist frequency are passed.
const NYQUIST_RATIO: f64 = 0.9;

/// Second-order notch with gain 1 at DC, direct form 1: its states are past inputs and outputs,
/// so that new coefficients make no bump on a constant force.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Biquad {
    active: bool,
    side: f64,
    centre: f64,
    pole: f64,
    x: [f64; 2],
    y: [f64; 2],
}

impl Biquad {
    /// Coefficients for the angle `theta` rad per sample; inactive at 0 and close to Nyquist.
    fn tune(&mut self, theta: f64, quality: f64) {
        self.active = theta > 0.0 && theta <= NYQUIST_RATIO * PI;
        if self.active {
            let alpha = theta.sin() / (2.0 * quality);
            self.side = 1.0 / (1.0 + alpha);
            self.centre = -2.0 * theta.cos() / (1.0 + alpha);
            self.pole = (1.0 - alpha) / (1.0 + alpha);
        }
    }

    fn update(&mut self, x: f64) -> f64 {
        let y = if self.active {
            self.side * (x + self.x[1]) + self.centre * (self.x[0] - self.y[0]) - self.pole * self.y[1]
        } else {
            x
        };
        self.x = [x, self.x[0]];
        self.y = [y, self.y[0]];
        y
    }
}

/// One notch per spindle harmonic, in cascade.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NotchCascade {
    sample_period: f64,
    quality: f64,
    harmonics: usize,
    tuned_speed: f64,
    sections: [Biquad; HARMONICS_MAX],
}

impl NotchCascade {
    /// Cascade that passes everything until it knows a spindle speed.
    pub fn new(p: &Parameters) -> Self {
        Self {
            sample_period: p.sample_period,
            quality: QUALITY,
            harmonics: p.notch_harmonics as usize,
            tuned_speed: 0.0,
            sections: [Biquad::default(); HARMONICS_MAX],
        }
    }

    /// Filters one sample of force (N) at the spindle speed (rad/s); 0 passes everything.
    pub fn update(&mut self, force: f64, spindle_speed: f64) -> f64 {
        let speed = spindle_speed.abs();
        if (speed - self.tuned_speed).abs() > RETUNE * self.tuned_speed {
            self.tune(speed);
        }
        self.sections[..self.harmonics].iter_mut().fold(force, |x, section| section.update(x))
    }

    fn tune(&mut self, speed: f64) {
        self.tuned_speed = speed;
        for (section, harmonic) in self.sections.iter_mut().zip(1..) {
            let theta = f64::from(harmonic) * speed * self.sample_period;
            section.tune(theta, self.quality);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEED: f64 = 3141.592653589793;

    fn cascade() -> NotchCascade {
        NotchCascade::new(&Parameters::START)
    }

    /// Largest output of the second half of a sine of 1 N at `frequency` rad/s.
    fn gain(frequency: f64) -> f64 {
        let mut notch = cascade();
        (0..20_000)
            .map(|k| notch.update((frequency * f64::from(k) * 1e-4).sin(), SPEED))
            .skip(10_000)
            .fold(0.0, |m, y| f64::max(m, y.abs()))
    }

    #[test]
    fn removes_its_frequencies_and_passes_the_rest() {
        assert!(gain(SPEED) < 1e-9, "first {}", gain(SPEED));
        assert!(gain(2.0 * SPEED) < 1e-9, "second {}", gain(2.0 * SPEED));
        assert!((gain(0.01 * SPEED) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn is_as_wide_as_its_quality_says() {
        let p = Parameters { notch_harmonics: 1, ..Parameters::START };
        let mut notch = NotchCascade::new(&p);
        let sine = (0..20_000).map(|k| notch.update((0.9 * SPEED * f64::from(k) * 1e-4).sin(), SPEED));
        let gain = sine.skip(10_000).fold(0.0, |m, y| f64::max(m, y.abs()));
        // |1 - x^2| / hypot(1 - x^2, x / Q) at x = 0.9 and Q = 2
        let expected = 0.19 / f64::hypot(0.19, 0.45);
        assert!((gain - expected).abs() < 0.02, "{gain} {expected}");
    }

    #[test]
    fn follows_a_speed_that_changes_by_half_a_percent() {
        let mut notch = cascade();
        (0..100).for_each(|_| _ = notch.update(0.0, SPEED));
        let speed = 1.005 * SPEED;
        let sine = (0..20_000).map(|k| notch.update((speed * f64::from(k) * 1e-4).sin(), speed));
        let left = sine.skip(10_000).fold(0.0, |m, y| f64::max(m, y.abs()));
        assert!(left < 1e-9, "{left}");
    }

    #[test]
    fn passes_a_constant_force_unchanged() {
        let mut notch = cascade();
        let y = (0..5000).map(|_| notch.update(3.0, SPEED)).last().unwrap();
        assert!((y - 3.0).abs() < 1e-12);
    }

    #[test]
    fn is_inactive_at_zero_speed_and_above_nyquist() {
        let mut notch = cascade();
        for k in 0..100 {
            let x = (0.3 * f64::from(k)).sin();
            assert_eq!(notch.update(x, 0.0), x);
        }
        let mut notch = cascade();
        for k in 0..100 {
            let x = (0.3 * f64::from(k)).sin();
            assert_eq!(notch.update(x, 0.95 * PI / 1e-4), x);
        }
    }

    #[test]
    fn speed_change_makes_no_bump() {
        let mut notch = cascade();
        (0..5000).for_each(|_| _ = notch.update(2.0, SPEED));
        let speeds = [SPEED, 0.9 * SPEED, 0.0, 2.0 * SPEED, 100.0, SPEED];
        for k in 0..6000 {
            let y = notch.update(2.0, speeds[k / 1000]);
            assert!((y - 2.0).abs() < 1e-9, "tick {k}: {y}");
        }
    }
}
