//! How much later than the slide the probe tells, found from a slide that brakes or starts in front of the ring.
//!
//! The tip is the slide less the probe, and the place of the surface. A probe that is t late leaves t x' of a slide at x with
//! the velocity x', one of another scale a share of x, and a surface that turns by a small angle a parabola of time: least
//! squares over the terms 1, k, k^2, x' and x, and without x where its share is none. Means and differences of neighbours belong to the same moment between them.

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::sensing::reading::Sample;

/// Longest window (s), and the turning (rad) in which a surface is a parabola: to 1 um at 1 mm of eccentricity.
const WINDOW: (f64, f64) = (0.2, 0.5);
/// Terms, the last ones x' and x, and the fewest samples for them.
const TERMS: usize = 5;
const DELAY: usize = 3;
const SCALE: usize = 4;
const FEWEST: f64 = 30.0;
/// What is left of the information of x' or x with the other terms free, relative; less is none, as of a slide that stops
/// like exp(-t), whose x' is a share of x.
const INFORMATION_MIN: f64 = 1e-6;
/// Most of x that is left where the scale of the probe is right.
const SCALE_ERROR: f64 = 0.2;
/// A probe is late by more than this share of a sample, and this many standard deviations of white noise: a step of the probe leaves
/// much more than noise, and is not late.
const LATE: (f64, f64) = (0.5, 12.0);

/// The sums of one window, and what the last one has told.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ProbeDelay {
    /// turning (rad) in the window, while it is open
    turned: Option<f64>,
    first: Option<Sample>,
    before: Sample,
    samples: u32,
    information: SMatrix<f64, TERMS, TERMS>,
    product: SVector<f64, TERMS>,
    square: f64,
    late: Option<f64>,
}

impl ProbeDelay {
    /// Opens a window, for the probe touches and the slide moves.
    pub fn begin(&mut self) {
        *self = Self { turned: Some(0.0), late: self.late, ..Self::default() };
    }

    /// Closes a window, at its end or as a push begins; what does not tell the delay changes nothing.
    pub fn end(&mut self, p: &Parameters) {
        let open = self.turned.take().is_some();
        if let Some(late) = self.told(p).filter(|_| open && f64::from(self.samples) >= FEWEST) {
            self.late = late;
        }
    }

    /// Takes a sample that was measured, `turned` rad after the one before.
    pub fn update(&mut self, p: &Parameters, turned: f64, sample: &Sample) {
        let Some(so_far) = self.turned else { return };
        if so_far + turned.abs() > WINDOW.1 {
            return self.end(p);
        }
        self.turned = Some(so_far + turned.abs());
        let Some(first) = self.first else {
            (self.first, self.before) = (Some(*sample), *sample);
            return;
        };
        let now = 0.5 * (sample.tip() + self.before.tip()) - first.tip();
        let place = 0.5 * (sample.slide + self.before.slide) - first.slide;
        let velocity = (sample.slide - self.before.slide) / p.sample_period;
        let time = f64::from(self.samples) * p.sample_period / WINDOW.0;
        let terms = SVector::from([1.0, time, time * time, velocity, place]);
        self.information += terms * terms.transpose();
        self.product += terms * now;
        self.square += now * now;
        self.before = *sample;
        self.samples += 1;
        if self.samples >= p.ticks(WINDOW.0) {
            self.end(p);
        }
    }

    /// Time (s) by which the probe is later than the slide, where it is.
    pub fn late(&self) -> Option<f64> {
        self.late
    }

    /// What the window tells, if it does.
    fn told(&self, p: &Parameters) -> Option<Option<f64>> {
        let all = self.information.cholesky()?.inverse();
        let told = |i: usize| all[(i, i)] * self.information[(i, i)] * INFORMATION_MIN <= 1.0;
        if !(told(DELAY) && told(SCALE)) {
            return None;
        }
        if (all * self.product)[SCALE].abs() > SCALE_ERROR {
            return Some(None);
        }
        // the scale is right
        let covariance = self.information.fixed_view::<SCALE, SCALE>(0, 0).clone_owned().cholesky()?.inverse();
        let product = self.product.fixed_rows::<SCALE>(0);
        let factors = covariance * product;
        let variance = (self.square - factors.dot(&product)).max(0.0) / (f64::from(self.samples) - SCALE as f64);
        let least = f64::max(LATE.0 * p.sample_period, LATE.1 * (variance * covariance[(DELAY, DELAY)]).sqrt());
        Some(Some(factors[DELAY]).filter(|delay| *delay > least))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told of a probe that is `late` samples late and has a `scale`, in front of a ring of 0.5 mm at 45 rpm, by a
    /// slide that brakes from 80 mm/s.
    fn told(late: usize, scale: f64, speed: f64) -> Option<f64> {
        // 4 m/s2 for 20 ms
        told_by(late, scale, speed, |k| 8e-4 - 2e-6 * (20.0 - k.min(20.0)).powi(2))
    }

    fn told_by(late: usize, scale: f64, speed: f64, slide: impl Fn(f64) -> f64) -> Option<f64> {
        let p = Parameters::START;
        let mut delay = ProbeDelay::default();
        delay.begin();
        let surface = |k: f64| 0.02 + 5e-4 * (4.7e-3 * k + 1.0).sin();
        for k in 0..300 {
            let then = f64::from(k) - late as f64;
            let probe = scale * (slide(then) - surface(then));
            delay.update(&p, 1e-3 * speed, &Sample { angle: 0.0, slide: slide(f64::from(k)), probe });
        }
        delay.late()
    }

    #[test]
    fn a_late_probe_is_told_by_its_time() {
        assert_eq!(told(0, 1.0, 4.7), None);
        for late in [1, 2, 5] {
            let seconds = told(late, 1.0, 4.7).unwrap();
            assert!((seconds / (1e-3 * late as f64) - 1.0).abs() < 0.15, "{late}: {seconds} s");
        }
    }

    #[test]
    fn a_probe_of_another_scale_or_none_is_not_late() {
        for scale in [0.0, 0.7, 1.3] {
            assert_eq!(told(0, scale, 4.7), None, "{scale}");
        }
    }

    #[test]
    fn a_slide_whose_velocity_is_a_share_of_its_way_tells_nothing() {
        for scale in [0.7, 1.0, 1.3] {
            assert_eq!(told_by(5, scale, 4.7, |k| 2e-3 * (1.0 - (-k / 25.0).exp())), None, "{scale}");
        }
    }

    #[test]
    fn a_spindle_that_is_too_fast_for_a_parabola_tells_nothing() {
        assert!(told(5, 1.0, 8.0).is_some());
        assert_eq!(told(5, 1.0, 17.0), None);
    }

    #[test]
    fn a_window_that_tells_nothing_keeps_what_the_one_before_has_told() {
        let p = Parameters::START;
        let mut delay = ProbeDelay { late: Some(3e-3), ..ProbeDelay::default() };
        delay.begin();
        (0..50).for_each(|_| delay.update(&p, 4.7e-3, &Sample::default()));
        delay.end(&p);
        (0..500).for_each(|_| delay.update(&p, 4.7e-3, &Sample::default()));
        assert_eq!(delay.late(), Some(3e-3));
    }
}
