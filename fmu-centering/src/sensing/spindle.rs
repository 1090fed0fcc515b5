//! Angle and speed of the spindle by regression: the encoder resolution of 0.09 deg causes jitter of both.

use control_blocks::{AnchoredLine, Unwrapper};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Least-squares line through the last `spindle.window` s of unwrapped angles.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Spindle {
    period: f64,
    quantum: f64,
    unwrapper: Unwrapper,
    unwrapped: f64,
    line: AnchoredLine,
}

impl Spindle {
    /// Before the first sample.
    pub fn new(p: &Parameters) -> Self {
        Self {
            period: p.sample_period,
            quantum: p.spindle_resolution,
            unwrapper: Unwrapper::default(),
            unwrapped: 0.0,
            line: AnchoredLine::new(p.ticks(p.spindle_window).max(2) as usize),
        }
    }

    /// Adds the next angle (rad, wrapped or not); the change since the last one.
    pub fn update(&mut self, raw: f64) -> f64 {
        let moved = self.unwrapper.step(raw);
        self.unwrapped = moved.map_or(raw, |moved| self.unwrapped + moved);
        self.line.update(self.unwrapped);
        moved.unwrap_or(0.0)
    }

    /// Discards all samples: the encoder has jumped.
    pub fn restart(&mut self) {
        self.line.clear();
        self.unwrapper = Unwrapper::default();
    }

    /// Speed, rad/s; 0 before two samples.
    pub fn speed(&self) -> f64 {
        self.line.slope(1.0) / self.period
    }

    /// Smoothed unwrapped angle now, rad: the end of the line, within one step of the encoder.
    pub fn angle(&self) -> f64 {
        let (low, high) = (self.unwrapped - self.quantum, self.unwrapped + self.quantum);
        self.line.end().map_or(self.unwrapped, |end| end.clamp(low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::wrap;
    use std::f64::consts::TAU;

    const QUANTUM: f64 = TAU / 4000.0;

    fn encoder(angle: f64) -> f64 {
        (angle / QUANTUM).round() * QUANTUM
    }

    /// Largest errors of speed (relative) and angle (rad) after the window is full.
    fn errors(speed: f64, seconds: u32, read: impl Fn(f64) -> f64) -> (f64, f64) {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        let (mut of_speed, mut of_angle) = (0.0, 0.0);
        for k in 0..seconds * 1000 {
            let angle = 0.3 + speed * f64::from(k) * 1e-3;
            spindle.update(read(encoder(angle)));
            if spindle.line.full() {
                of_speed = f64::max(of_speed, (spindle.speed() / speed - 1.0).abs());
                of_angle = f64::max(of_angle, wrap(spindle.angle() - angle).abs());
            }
        }
        (of_speed, of_angle)
    }

    #[test]
    fn quantised_angle_and_speed_are_smoothed_in_both_directions() {
        // 20 and 45 rpm: the quantum is 1.6 mrad, half of it the error of one sample
        for (speed, ratio) in [(2.0944, 0.25), (-2.0944, 0.25), (4.6, 0.25), (4.712, 0.8), (-4.712, 0.8)] {
            let (of_speed, of_angle) = errors(speed, 20, |angle| angle);
            assert!(of_speed < 2e-3, "{speed} rad/s: speed {of_speed}");
            // 45 rpm are three quanta per sample: the rounding is the same for many samples
            assert!(of_angle < ratio * QUANTUM, "{speed} rad/s: angle {of_angle} rad");
        }
    }

    #[test]
    fn wrapped_angles_give_the_same() {
        let plain = errors(2.0944, 20, |angle| angle);
        for read in [wrap as fn(f64) -> f64, |angle| angle.rem_euclid(TAU)] {
            let wrapped = errors(2.0944, 20, read);
            assert!((wrapped.0 - plain.0).abs() < 1e-9 && (wrapped.1 - plain.1).abs() < 1e-9);
        }
    }

    #[test]
    fn sums_stay_exact_for_an_hour() {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        for k in 0..3_600_000 {
            spindle.update(1e-3 * f64::from(k));
        }
        assert!((spindle.speed() - 1.0).abs() < 1e-9, "{}", spindle.speed());
        assert!((spindle.angle() - 3599.999).abs() < 1e-9, "{}", spindle.angle());
    }

    #[test]
    fn a_change_of_speed_leaves_the_angle_within_a_quantum() {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        let mut angle = 0.0;
        for k in 0..3000 {
            let speed = if k < 1500 { 2.0 } else { -3.0 };
            angle += 1e-3 * speed;
            spindle.update(encoder(angle));
            assert!((spindle.angle() - angle).abs() <= 1.5 * QUANTUM);
        }
        assert!((spindle.speed() + 3.0).abs() < 0.01);
    }

    #[test]
    fn at_rest_it_does_not_move() {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        for _ in 0..2000 {
            spindle.update(1.0);
        }
        assert_eq!((spindle.speed(), spindle.angle()), (0.0, 1.0));
    }

    #[test]
    fn the_first_sample_is_an_angle_without_a_speed() {
        let mut spindle = Spindle::new(&Parameters::PAPER);
        assert_eq!(spindle.update(2.5), 0.0);
        assert_eq!((spindle.angle(), spindle.speed(), spindle.line.full()), (2.5, 0.0, false));
    }
}
