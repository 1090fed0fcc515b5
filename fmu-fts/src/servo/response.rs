//! Frequency response T of the position loop, set-point to arm angle, as a table over the frequency.

use control_blocks::wrap_half_open;
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::lists::frequencies::COUNT_MAX;

/// One frequency of the table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Frequency, rad/s.
    pub frequency: f64,
    /// Magnitude of T, 1.
    pub magnitude: f64,
    /// Phase of T, rad; it continues without jumps from 0 at rest.
    pub phase: f64,
}

/// T(w) between the points: logarithm of the magnitude and phase are linear in w, T(0) = 1, and beyond the
/// last point T stays as it is there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrequencyResponse {
    points: [Point; COUNT_MAX],
    count: usize,
}

impl FrequencyResponse {
    /// T = 1 everywhere.
    pub const EMPTY: Self = Self { points: [Point::REST; COUNT_MAX], count: 0 };

    /// The table of a model T(w) at ascending frequencies (rad/s).
    pub fn from_model(frequencies: &[f64], model: impl Fn(f64) -> Complex<f64>) -> Self {
        let mut response = Self::EMPTY;
        frequencies.iter().for_each(|w| response.push(*w, model(*w)));
        response
    }

    /// Adds a frequency (rad/s) above all others, with its phase within half a revolution of the point before.
    /// A point too many, of a lower frequency, or of no finite magnitude above 0 is left out.
    pub fn push(&mut self, frequency: f64, t: Complex<f64>) {
        let last = self.points().last().copied().unwrap_or(Point::REST);
        let magnitude = t.norm();
        let usable = magnitude.is_finite() && magnitude > 0.0 && frequency > last.frequency;
        if usable && self.count < COUNT_MAX {
            let phase = last.phase + wrap_half_open(t.arg() - last.phase);
            self.points[self.count] = Point { frequency, magnitude, phase };
            self.count += 1;
        }
    }

    /// The points, frequency ascending.
    pub fn points(&self) -> &[Point] {
        &self.points[..self.count]
    }

    /// T at `frequency` (rad/s, not negative).
    pub fn at(&self, frequency: f64) -> Complex<f64> {
        let points = self.points();
        let above = points.partition_point(|point| point.frequency < frequency);
        let before = above.checked_sub(1).map_or(Point::REST, |i| points[i]);
        let Some(after) = points.get(above) else { return before.value() };
        let fraction = (frequency - before.frequency) / (after.frequency - before.frequency);
        let magnitude = before.magnitude * (after.magnitude / before.magnitude).powf(fraction);
        Complex::from_polar(magnitude, before.phase + fraction * (after.phase - before.phase))
    }
}

impl Point {
    /// T(0) = 1.
    pub const REST: Self = Self { frequency: 0.0, magnitude: 1.0, phase: 0.0 };

    /// T as a complex number.
    pub fn value(&self) -> Complex<f64> {
        Complex::from_polar(self.magnitude, self.phase)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A damped resonance with a pure delay: its phase turns far beyond -180 degrees.
    fn model(w: f64) -> Complex<f64> {
        let s = Complex::new(0.0, w / 600.0);
        (s * s + s + 1.0).inv() * Complex::new(0.0, -w * 2e-3).exp()
    }

    fn grid(step: f64, count: usize) -> Vec<f64> {
        (1..=count).map(|i| step * i as f64).collect()
    }

    #[test]
    fn points_are_restored_and_the_phase_is_continuous() {
        let response = FrequencyResponse::from_model(&grid(120.0, 32), model);
        assert_eq!(response.points().len(), 32);
        for point in response.points() {
            assert!((response.at(point.frequency) - model(point.frequency)).norm() < 1e-12);
        }
        let steps = response.points().windows(2).map(|pair| pair[1].phase - pair[0].phase);
        assert!(steps.into_iter().all(|step| step < 0.0 && step > -1.0));
        assert!(response.points()[31].phase < -TAU);
    }

    #[test]
    fn between_points_it_is_near_the_model() {
        let response = FrequencyResponse::from_model(&grid(60.0, 32), model);
        for i in 0..320 {
            let w = 6.0 * f64::from(i);
            let error = (response.at(w) / model(w) - 1.0).norm();
            assert!(error < 6e-3, "{error} at {w} rad/s");
        }
    }

    #[test]
    fn one_at_rest_and_held_beyond_the_last_point() {
        let response = FrequencyResponse::from_model(&[50.0, 100.0], model);
        assert_eq!(response.at(0.0), Complex::new(1.0, 0.0));
        assert_eq!(response.at(1e6), response.at(100.0));
        assert_eq!(FrequencyResponse::EMPTY.at(30.0), Complex::new(1.0, 0.0));
    }

    #[test]
    fn what_is_no_next_point_is_left_out() {
        let mut response = FrequencyResponse::from_model(&[50.0], model);
        for (w, t) in [(50.0, 1.0), (40.0, 1.0), (60.0, 0.0), (60.0, f64::NAN), (f64::NAN, 1.0)] {
            response.push(w, Complex::new(t, 0.0));
        }
        assert_eq!(response.points().len(), 1);
        let full = FrequencyResponse::from_model(&grid(1.0, 100), model);
        assert_eq!(full.points().len(), COUNT_MAX);
    }
}
