//! Counts that an encoder loses: steps of the position that no command explains, each too small for a jump.
//!
//! The position minus all commanded motion drifts with an offset or the gain of the drive, and bends where it
//! accelerates. Least squares over four samples before a sample and four after it, with one slope for both, leaves the
//! step between them. A bend in its middle contributes nothing, noise s 1.45 s. A step is used from eight counts and
//! ten standard deviations of the residual on, at its peak. Alternating steps are noise or samples that were held;
//! steps that add up in one direction are lost counts.

use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::finding::{Finding, Numbers};

/// Samples on either side.
const SIDE: usize = 4;
/// Samples from the middle of their side.
const FROM_MIDDLE: [f64; SIDE] = [-1.5, -0.5, 0.5, 1.5];
/// Sum of their squares, both sides.
const SQUARES: f64 = 10.0;
/// Samples less the unknowns: two means and a slope.
const FREE: f64 = 5.0;
/// Smallest step that is used, in counts and in standard deviations (default; nominal drives leave 4 counts, drives of
/// 0.4 of their bandwidth 7).
const STEP_MIN: (f64, f64) = (8.0, 10.0);
/// Deviation of what the fit leaves, in counts, from which it is noise that steps.
const NOISY: f64 = 2.0;
/// Steps to one side more than to the other that are no accident.
const STEPS: i32 = 3;

/// The steps of one measurement since a run began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Slips {
    /// measurement less all commanded motion, rad or m, the newest last, and how many there are
    left: [f64; 2 * SIDE],
    count: usize,
    commanded: f64,
    /// largest step of those that overlap (rad or m), and samples since
    peak: f64,
    since: usize,
    /// all steps, rad or m, and how many more go up than down
    sum: f64,
    up: i32,
}

impl Slips {
    /// Begins a run.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Takes a measurement of the axis `axis` (from 0) and the motion that was commanded for the sample that it ends,
    /// rad or m; what is wrong.
    pub fn update(&mut self, p: &Parameters, axis: usize, position: f64, commanded: f64) -> Finding {
        self.commanded += commanded;
        self.left.rotate_left(1);
        self.left[2 * SIDE - 1] = position - self.commanded;
        self.count = (self.count + 1).min(2 * SIDE);
        if self.count == 2 * SIDE {
            self.find(p.axis[axis].pulse);
        }
        let limit = p.limits.axis[axis].error_max;
        if self.up.abs() < STEPS || self.sum.abs() <= limit {
            return Finding::NONE;
        }
        let numbers = Numbers { axis: axis as i32 + 1, value: self.sum.abs(), limit, ratio: None };
        Finding { fault: Fault::PositionJump, numbers }
    }

    /// Whether there is a step in the middle; it is used if no larger one followed on the same samples.
    fn find(&mut self, pulse: f64) {
        let (step, deviation) = self.step();
        if deviation < NOISY * pulse
            && step.abs() > (STEP_MIN.0 * pulse).max(STEP_MIN.1 * deviation).max(self.peak.abs())
        {
            (self.peak, self.since) = (step, 0);
        } else if self.peak != 0.0 {
            self.since += 1;
            if self.since == SIDE {
                self.sum += self.peak;
                self.up += self.peak.signum() as i32;
                self.peak = 0.0;
            }
        }
    }

    /// The step between both sides and the deviation of what the fit leaves, rad or m.
    fn step(&self) -> (f64, f64) {
        let (mut mean, mut slope, mut square) = ([0.0; 2], 0.0, 0.0);
        // from the oldest: the position itself is as far as all commands have led
        let left = self.left.map(|left| left - self.left[0]);
        for (side, mean) in left.chunks_exact(SIDE).zip(&mut mean) {
            *mean = side.iter().sum::<f64>() / SIDE as f64;
            slope += side.iter().zip(FROM_MIDDLE).map(|(left, from)| from * left).sum::<f64>() / SQUARES;
            square += side.iter().map(|left| (left - *mean).powi(2)).sum::<f64>();
        }
        let free = (square - SQUARES * slope * slope).max(0.0) / FREE;
        (mean[1] - mean[0] - SIDE as f64 * slope, free.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// Finding for axis 3 that moves by ten counts in a sample, with `offset` as the error of its position in counts,
    /// and its sample.
    fn first_finding(offset: impl Fn(u32) -> f64) -> Option<(u32, Finding)> {
        let (mut slips, pulse) = (Slips::default(), P.axis[2].pulse);
        (0..1000).find_map(|k| {
            let position = 10.0 * f64::from(k) + offset(k);
            let found = slips.update(&P, 2, position.round() * pulse, 10.0 * pulse);
            found.is_fault().then_some((k, found))
        })
    }

    fn noise(k: u32) -> f64 {
        [0.7, -0.4, 0.1, -0.9, 0.5, 0.3, -0.6, 0.9, -0.2, -0.4, 0.8][(k % 11) as usize]
    }

    #[test]
    fn counts_that_are_lost_again_and_again_are_reported_where_they_add_up_to_the_limit() {
        for (lost, every) in [(40.0, 10), (-40.0, 10), (20.0, 10), (80.0, 40), (10.0, 5)] {
            let (k, found) = first_finding(|k| noise(k) + lost * f64::from(k / every)).unwrap();
            assert_eq!((found.fault, found.numbers.axis, found.numbers.limit), (Fault::PositionJump, 3, 1e-3));
            // 200 counts, with the last one found eight samples later
            let steps = (200.0 / f64::abs(lost)).ceil() as u32;
            assert!((steps * every..(steps + 3) * every + 9).contains(&k), "{lost} {every}: {k}");
            assert!(found.numbers.value > 1e-3 && found.numbers.value < 1.5e-3, "{found:?}");
        }
    }

    #[test]
    fn fewer_than_three_steps_or_less_than_the_limit_are_bridged() {
        assert_eq!(first_finding(|k| noise(k) + 150.0 * f64::from((k / 100).min(2))), None);
        assert!(first_finding(|k| noise(k) + 150.0 * f64::from((k / 100).min(3))).is_some());
        assert_eq!(first_finding(|k| noise(k) + 45.0 * f64::from((k / 100).min(4))), None);
        // back and forth
        assert_eq!(first_finding(|k| noise(k) + 300.0 * f64::from(k / 50 % 2)), None);
    }

    #[test]
    fn an_offset_a_gain_that_bends_noise_and_single_samples_lose_nothing() {
        assert_eq!(first_finding(|k| noise(k) + 2.6 * f64::from(k)), None);
        // 0.3 of 0.5 m/s2 up and down
        let speed = |k: u32| 3.0 * f64::from((k % 60).min(60 - k % 60));
        assert_eq!(first_finding(|k| noise(k) + (0..k).map(speed).sum::<f64>()), None);
        assert_eq!(first_finding(|k| 40.0 * noise(k)), None);
        // steps of a measurement that is as noisy
        assert_eq!(first_finding(|k| 20.0 * noise(k) + 300.0 * f64::from(k / 20)), None);
        // held for a sample of three
        assert_eq!(first_finding(|k| if k % 3 == 0 { -10.0 } else { 0.0 }), None);
    }

    #[test]
    fn a_run_begins_with_nothing_lost() {
        let (mut slips, pulse) = (Slips::default(), P.axis[2].pulse);
        let mut found = false;
        for k in 0..1000u32 {
            if k % 40 == 0 {
                slips.restart();
            }
            found |= slips.update(&P, 2, 40.0 * f64::from(k / 10) * pulse, 0.0).is_fault();
        }
        assert!(!found);
    }
}
