//! Delay of the probe relative to the slide, identified while the slide brakes or starts at the ring.
//!
//! The tip is the slide minus the probe, and thus the surface position. With a probe that is d samples late it is the
//! surface plus x_k - x_(k-d) of a slide at x. All d are tried exactly, because the effect of a long delay is not
//! proportional to a velocity. A delayed slide has a negative d, which is known some samples later. A surface that
//! turns by a small angle is a parabola of time. A probe of another scale adds a fraction of x, which is tried as well.

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::sensing::reading::Sample;

/// Longest window (s), and the rotation (rad) in which a surface is a parabola: to 1 um at 1 mm of eccentricity.
const WINDOW: (f64, f64) = (0.2, 0.5);
/// Largest delays of slide and probe in samples (default: 32 delays are tried; a slide with a longer delay hardly
/// stays within `limits.following_error`).
const EARLY: usize = 6;
const LATEST: usize = 25;
const DELAYS: usize = EARLY + 1 + LATEST;
/// Terms 1, k, k^2 of a surface, and x, and the fewest samples: three for each of the surface and one for the delay, in
/// a window of 16 with [`EARLY`].
const SURFACE: usize = 3;
const TERMS: usize = 4;
const FEWEST: f64 = 10.0;
/// Minimum number of samples for a delay between two samples: with fewer, the parabola through three values falls below
/// the noise.
const BETWEEN: f64 = 40.0;
/// A delay is reported above this fraction of a sample, if it explains the residuals by this number of standard
/// deviations better than any scale of the probe: a step of the probe leaves much more than noise, and is no delay.
const LATE: (f64, f64) = (0.5, 12.0);
/// Smallest residual, m: encoders have steps. Larger residuals than those of a coarse probe come from
/// lobes, which look like a delay by chance.
const LOWEST: f64 = 1e-8;
const HIGHEST: f64 = 1e-6;

/// The sums of one window, and the result of the last one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ProbeDelay {
    /// slide positions (m) and tips (m) where they were measured, in a ring buffer, and the present index
    positions: [f64; DELAYS],
    tips: [Option<f64>; DELAYS],
    now: usize,
    /// rotation (rad) in the window, while it is open
    rotation: Option<f64>,
    first: Option<Sample>,
    /// samples since then, and those of them that were measured
    time: u32,
    samples: u32,
    information: SMatrix<f64, TERMS, TERMS>,
    /// for each delay
    products: SMatrix<f64, TERMS, DELAYS>,
    squares: SVector<f64, DELAYS>,
    /// of the slide's steps
    steps: f64,
    late: Option<f64>,
}

impl ProbeDelay {
    /// Opens a window: the probe touches and the slide moves.
    pub fn begin(&mut self) {
        let Self { positions, tips, now, late, .. } = *self;
        *self = Self { positions, tips, now, late, rotation: Some(0.0), ..Self::default() };
    }

    /// Closes a window, at its end or at the start of a push; data that do not determine the delay change nothing.
    pub fn end(&mut self, p: &Parameters) {
        let open = self.rotation.take().is_some();
        if let Some(late) = self.result(p).filter(|_| open && f64::from(self.samples) >= FEWEST) {
            self.late = late;
        }
    }

    /// Adds a sample, `rotation` rad after the one before; the probe is used where it was `measured` and not bridged.
    pub fn update(&mut self, p: &Parameters, rotation: f64, sample: &Sample, measured: bool) {
        self.now = (self.now + 1) % DELAYS;
        self.positions[self.now] = sample.slide;
        self.tips[self.now] = measured.then(|| sample.tip());
        let Some(so_far) = self.rotation else { return };
        if so_far + rotation.abs() > WINDOW.1 {
            return self.end(p);
        }
        self.rotation = Some(so_far + rotation.abs());
        let first = *self.first.get_or_insert(*sample);
        if let Some(tip) = self.tips[self.before(EARLY)].filter(|_| self.time >= EARLY as u32) {
            self.take(p, tip - first.tip(), &first);
        }
        self.time += 1;
        if self.time >= p.ticks(WINDOW.0) {
            self.end(p);
        }
    }

    /// Adds the sample of [`EARLY`] samples ago to the sums, its tip counted from the first.
    fn take(&mut self, p: &Parameters, tip: f64, first: &Sample) {
        let time = f64::from(self.time) * p.sample_period / WINDOW.0;
        let slide = self.positions[self.before(EARLY)];
        let terms = SVector::from([1.0, time, time * time, slide - first.slide]);
        self.information += terms * terms.transpose();
        for delay in 0..DELAYS {
            let distance = slide - self.positions[self.before(delay)];
            self.products.column_mut(delay).axpy(tip - distance, &terms, 1.0);
            self.squares[delay] += (tip - distance).powi(2);
        }
        self.steps += (slide - self.positions[self.before(EARLY + 1)]).powi(2);
        self.samples += 1;
    }

    /// Index in the ring buffer of the sample `ago` samples before.
    fn before(&self, samples: usize) -> usize {
        (self.now + DELAYS - samples) % DELAYS
    }

    /// Delay (s) of the probe relative to the slide, if there is one; negative if the slide is delayed.
    pub fn late(&self) -> Option<f64> {
        self.late
    }

    /// Whether `late` s are the longest delay that is tried: the actual one may be longer.
    pub fn longest(p: &Parameters, late: f64) -> bool {
        let tried = if late > 0.0 { LATEST } else { EARLY } as f64;
        late.abs() > (tried - LATE.0) * p.sample_period
    }

    /// Result of the window, if it has one.
    fn result(&self, p: &Parameters) -> Option<Option<f64>> {
        let all = self.information.cholesky()?.inverse();
        let surface = self.information.fixed_view::<SURFACE, SURFACE>(0, 0).clone_owned().cholesky()?.inverse();
        let left = |delay: usize| {
            let product = self.products.fixed_view::<SURFACE, 1>(0, delay).clone_owned();
            self.squares[delay] - product.dot(&(surface * product))
        };
        let residual = |square: f64, product: SVector<f64, TERMS>| square - product.dot(&(all * product));
        let best = (0..DELAYS).min_by(|&a, &b| left(a).total_cmp(&left(b)))?;
        let (position, between) = lowest(best, left);
        let minimum = if f64::from(self.samples) < BETWEEN { left(best) } else { between };
        let variance = (minimum / (f64::from(self.samples) - TERMS as f64)).max(LOWEST.powi(2));
        let seen = LATE.1.powi(2) * variance;
        // the residual of a sample of delay in addition to any scale
        if variance > HIGHEST.powi(2)
            || residual(self.steps, self.products.column(EARLY) - self.products.column(EARLY + 1)) < seen
        {
            return None;
        }
        let scaled = residual(self.squares[EARLY], self.products.column(EARLY).clone_owned());
        let delay = (position - EARLY as f64) * p.sample_period;
        Some(Some(delay).filter(|_| delay.abs() > LATE.0 * p.sample_period && minimum + seen < scaled))
    }
}

/// Position and value of the minimum of the parabola through the smallest of some values and its neighbors.
fn lowest(best: usize, value: impl Fn(usize) -> f64) -> (f64, f64) {
    if best == 0 || best + 1 == DELAYS {
        return (best as f64, value(best));
    }
    let [before, minimum, after] = [best - 1, best, best + 1].map(value);
    let (slope, bend) = (0.5 * (before - after), before - 2.0 * minimum + after);
    if bend <= 0.0 {
        return (best as f64, minimum);
    }
    (best as f64 + slope / bend, minimum - 0.5 * slope.powi(2) / bend)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Result for a probe that is `late` samples later than the slide and has a `scale`, at a ring of 0.5 mm at 45 rpm,
    /// with a slide that brakes from 80 mm/s.
    fn found(late: i32, scale: f64, speed: f64) -> Option<f64> {
        // 4 m/s2 for 20 ms
        shown_by(late, scale, speed, |k| 8e-4 - 2e-6 * (20.0 - k.min(20.0)).powi(2))
    }

    fn shown_by(late: i32, scale: f64, speed: f64, slide: impl Fn(f64) -> f64) -> Option<f64> {
        let p = Parameters::START;
        let mut delay = ProbeDelay::default();
        let surface = |k: f64| 0.02 + 5e-4 * (4.7e-3 * k + 1.0).sin();
        // the slide was moving before the probe touched
        for k in -30..300 {
            if k == 0 {
                delay.begin();
            }
            let [probe, now] = [late.max(0), (-late).max(0)].map(|late| f64::from(k - late));
            let sample = Sample { angle: 0.0, slide: slide(now), probe: scale * (slide(probe) - surface(probe)) };
            delay.update(&p, 1e-3 * speed, &sample, true);
        }
        delay.late()
    }

    #[test]
    fn a_late_probe_or_slide_is_found_by_its_time() {
        assert_eq!(found(0, 1.0, 4.7), None);
        for late in [-6, -5, -3, -1, 1, 2, 5, 10, 20] {
            let seconds = found(late, 1.0, 4.7).unwrap();
            assert!((seconds - 1e-3 * f64::from(late)).abs() < 2e-5, "{late}: {seconds} s");
        }
    }

    /// A slide that brakes from 120 mm/s with 2.56 m/s2.
    fn braking(time: f64) -> f64 {
        let brake = 0.12 / 2.56;
        0.12 * time.min(0.0) - 1.28 * (brake - time.clamp(0.0, brake)).powi(2)
    }

    /// One that retracts with 120 mm/s.
    fn retracting(time: f64) -> f64 {
        -braking(0.0) - braking(0.12 / 2.56 - time.max(0.0))
    }

    /// Result, in samples of `period` s, for a ring with 20 waves of `lobe` m that turns by `speed` rad/s from `angle`
    /// rad on; probe and slide have steps of 50 nm.
    fn found_in_samples(period: f64, late: f64, speed: f64, lobe: [f64; 2], slide: fn(f64) -> f64) -> Option<f64> {
        let p = Parameters { sample_period: period, ..Parameters::START };
        let mut delay = ProbeDelay::default();
        let [lobe, angle] = lobe;
        let surface = |time: f64| {
            let angle = speed * time + angle;
            0.02 + 5e-4 * angle.sin() + lobe * (20.0 * angle).sin()
        };
        for k in -30..(0.5 / period) as i32 {
            if k == 0 {
                delay.begin();
            }
            let [probe, now] = [late.max(0.0), (-late).max(0.0)].map(|late| period * (f64::from(k) - late));
            let step = |position: f64| (position / 5e-8).round() * 5e-8;
            let probe = step(slide(probe) - surface(probe));
            let sample = Sample { angle: 0.0, slide: step(slide(now)), probe };
            delay.update(&p, speed * period, &sample, true);
        }
        delay.late().map(|late| late / period)
    }

    #[test]
    fn slow_samples_show_it_too_at_the_speeds_of_the_paper() {
        let slow = [1e-3, 3e-3, 5.5e-3, 6e-3, 6.6e-3, 8e-3, 0.01].map(|period| (2.1, period));
        for (speed, period) in slow.into_iter().chain([(4.7, 3e-3), (4.7, 6e-3), (4.7, 6.6e-3)]) {
            assert_eq!(found_in_samples(period, 0.0, speed, [0.0, 1.0], braking), None, "{period}");
            for late in [-6.0, -5.0, -2.0, -1.0, 1.0, 3.0, 8.0] {
                let found = found_in_samples(period, late, speed, [0.0, 1.0], braking);
                assert!(found.is_some_and(|samples| (samples - late).abs() < 0.35), "{period}: {late} {found:?}");
            }
        }
    }

    #[test]
    fn a_delay_between_two_samples_is_found_by_its_time() {
        for late in [-4.5, -1.5, -0.6, 0.7, 1.6, 2.5, 7.5] {
            let found = found_in_samples(1e-3, late, 2.1, [0.0, 1.0], braking);
            assert!(found.is_some_and(|samples| (samples - late).abs() < 5e-3), "{late} {found:?}");
        }
        assert_eq!([-0.4, 0.4].map(|late| found_in_samples(1e-3, late, 2.1, [0.0, 1.0], braking)), [None; 2]);
    }

    #[test]
    fn lobes_of_the_surface_are_no_delay() {
        for lobe in [3e-6, 8e-6, 1.7e-5, 3e-5] {
            for k in 0..20 {
                let found = found_in_samples(1e-3, 0.0, 4.7, [lobe, TAU / 400.0 * f64::from(k)], retracting);
                assert_eq!(found, None, "{lobe} {k}");
            }
        }
    }

    /// Result, in samples of `period` s, for a probe with a noise of `noise` m that is `late` samples later than a
    /// slide that brakes, with a window of at most this number of samples.
    fn found_with_noise(period: f64, late: f64, noise: f64, longest: u32, seed: u64) -> Option<f64> {
        let p = Parameters { sample_period: period, ..Parameters::START };
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let (mut delay, speed) = (ProbeDelay::default(), 2.1);
        // it begins between two samples
        let begin = -30.0 - 0.1 * (seed % 10) as f64;
        for k in 0..30 + longest {
            if k == 30 {
                delay.begin();
            }
            let time = |late: f64| period * (begin + f64::from(k) - late);
            let step = |position: f64| (position / 5e-8).round() * 5e-8;
            let surface = 0.02 + 5e-4 * (speed * time(late) + 1.0).sin();
            let normal: f64 = StandardNormal.sample(&mut random);
            let probe = step(braking(time(late)) - surface + noise * normal);
            delay.update(&p, speed * period, &Sample { angle: 0.0, slide: step(braking(time(0.0))), probe }, true);
        }
        delay.end(&p);
        delay.late().map(|late| late / period)
    }

    /// Delays of 0 to 9 samples, in quarters.
    fn quarters() -> impl Iterator<Item = f64> {
        (0..=36).map(|k| 0.25 * f64::from(k))
    }

    #[test]
    fn noise_of_the_probe_makes_no_delay_and_hides_none() {
        for noise in [3e-8, 2e-7, 5e-7] {
            for (late, seed) in quarters().zip(0..) {
                let found = found_with_noise(1e-3, late, noise, 500, seed);
                // half a sample is the limit
                assert!(found.is_some() == (late > 0.5) || late == 0.5, "{noise} {late} {found:?}");
                assert!(found.is_none_or(|found| (found - late).abs() < 0.05), "{noise} {late} {found:?}");
            }
        }
        // with too much noise there is no result
        assert!(quarters().all(|late| found_with_noise(1e-3, late, 2e-6, 500, 7).is_none()));
        // slow samples may not determine a delay between two; a result is within a fifth
        for period in [2e-3, 3e-3, 5.5e-3, 8e-3, 0.01] {
            for (late, seed) in quarters().zip(0..) {
                let found = found_with_noise(period, late, 5e-7, 500, seed);
                assert!(late != late.round() || found.is_some() == (late > 0.5), "{period} {late} {found:?}");
                assert!(found.is_none_or(|found| (found - late).abs() < 0.2), "{period} {late} {found:?}");
            }
        }
    }

    #[test]
    fn a_short_window_with_noise_gives_no_other_delay() {
        let (mut known, mut wrong) = (0, 0);
        for longest in [15, 16, 17, 18, 20, 22, 26, 30, 34, 45] {
            for period in [1e-3, 2e-3, 3e-3, 5.5e-3, 0.01] {
                for (k, noise) in [3e-8, 2e-7, 8e-7].into_iter().enumerate() {
                    for (late, seed) in quarters().zip(10 * k as u64..) {
                        let found = found_with_noise(period, late, noise, longest, seed);
                        assert!(found.is_none() || longest > 15, "{period} {noise} {late}");
                        known += u32::from(found.is_some());
                        wrong += u32::from(found.is_some_and(|found| (found - late).abs() > 0.55));
                    }
                }
            }
        }
        assert!(known > 500 && 500 * wrong < known, "{wrong} of {known}");
    }

    #[test]
    fn only_the_longest_delays_may_be_longer() {
        let longest = |late: f64| ProbeDelay::longest(&Parameters::START, late);
        assert_eq!([-6e-3, -5.4e-3, 5e-3, 24.4e-3, 25e-3].map(longest), [true, false, false, false, true]);
    }

    #[test]
    fn a_probe_of_another_scale_or_none_is_not_late() {
        for scale in [0.0, 0.7, 1.3] {
            assert_eq!(found(0, scale, 4.7), None, "{scale}");
        }
    }

    #[test]
    fn a_bridged_sample_is_none_of_the_surface() {
        let p = Parameters::START;
        let mut delay = ProbeDelay::default();
        for k in -30..300 {
            if k == 0 {
                delay.begin();
            }
            let slide = braking(1e-3 * f64::from(k) - 5e-3);
            let late = braking(1e-3 * f64::from(k - 5) - 5e-3);
            // one of seven is not measured, and keeps what was there before
            let measured = k % 7 != 3 || k < 0;
            let probe = if measured { late + 0.02 } else { 0.02 };
            delay.update(&p, 2.1e-3, &Sample { angle: 0.0, slide, probe }, measured);
        }
        assert!(delay.late().is_some_and(|late| (late - 5e-3).abs() < 5e-5), "{:?}", delay.late());
    }

    #[test]
    fn a_slide_whose_velocity_is_a_fraction_of_its_travel_shows_nothing() {
        for scale in [0.7, 1.0, 1.3] {
            assert_eq!(shown_by(5, scale, 4.7, |k| 2e-3 * (1.0 - (-k / 25.0).exp())), None, "{scale}");
        }
    }

    #[test]
    fn a_spindle_that_is_too_fast_for_a_parabola_shows_nothing() {
        assert!(found(5, 1.0, 8.0).is_some());
        assert_eq!(found(5, 1.0, 17.0), None);
    }

    #[test]
    fn a_window_without_evidence_keeps_the_result_of_the_one_before() {
        let p = Parameters::START;
        let mut delay = ProbeDelay { late: Some(3e-3), ..ProbeDelay::default() };
        delay.begin();
        (0..50).for_each(|_| delay.update(&p, 4.7e-3, &Sample::default(), true));
        delay.end(&p);
        (0..500).for_each(|_| delay.update(&p, 4.7e-3, &Sample::default(), true));
        assert_eq!(delay.late(), Some(3e-3));
    }
}
