//! Whether the slide keeps its feed, evaluated per revolution.
//!
//! The slide has an external drive and may rest. `limits.feed` configures its travel per revolution. A position that
//! moved with it for one revolution and is more than half of it off in a later one is frozen, drifts or slips. Half a
//! feed per revolution distinguishes a slide at rest from one that moves, at any finer resolution.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// The turn in progress; by default before the first.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct FeedWatch {
    /// where it began: spindle angle (rad) and slide position (m)
    begin: Option<(f64, f64)>,
    fed: bool,
    /// travel of a revolution out of tolerance, m
    lost: Option<f64>,
}

impl FeedWatch {
    /// Takes the spindle angle without wraps (rad) and the slide position (m) of a sample.
    pub fn update(&mut self, p: &Parameters, spindle_angle: f64, slide_position: f64) {
        let (angle, position) = *self.begin.get_or_insert((spindle_angle, slide_position));
        if p.limits.feed > 0.0 && (spindle_angle - angle).abs() >= TAU {
            let travel = (slide_position - position).abs();
            let right = (travel - p.limits.feed).abs() <= 0.5 * p.limits.feed;
            if self.fed && !right {
                self.lost.get_or_insert(travel);
            }
            self.fed |= right;
            self.begin = Some((spindle_angle, slide_position));
        }
    }

    /// Travel (m) of the first revolution out of tolerance, after one with the feed.
    pub fn lost(&self) -> Option<f64> {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The revolution in which the slide is lost, with a feed of 10 um per revolution.
    fn lost_in(feed: f64, position: impl Fn(f64) -> f64) -> Option<u32> {
        let (mut p, mut watch) = (Parameters::START, FeedWatch::default());
        p.limits.feed = feed;
        (0..3000).find_map(|k| {
            let revolutions = 0.0105 * f64::from(k);
            watch.update(&p, -TAU * revolutions, (position(revolutions) * 1e7).round() * 1e-7);
            watch.lost().map(|_| revolutions as u32)
        })
    }

    #[test]
    fn a_slide_that_feeds_either_way_or_never_did_is_not_lost() {
        assert_eq!(lost_in(1e-5, |revolutions| 1e-5 * revolutions), None);
        assert_eq!(lost_in(1e-5, |revolutions| -1.4e-5 * revolutions), None);
        assert_eq!(lost_in(1e-5, |_| 0.03), None);
        assert_eq!(lost_in(0.0, |revolutions| 1e-5 * revolutions.min(5.0)), None);
    }

    #[test]
    fn one_that_is_frozen_or_drifts_after_that_is_lost_within_two_revolutions() {
        for drift in [0.0, 0.3, 2.0] {
            let lost =
                lost_in(1e-5, |revolutions| 1e-5 * (revolutions.min(10.0) + drift * (revolutions - 10.0).max(0.0)));
            assert!(matches!(lost, Some(10..=12)), "{drift}: {lost:?}");
        }
    }
}
