//! Feed along the path: desired velocity, override, curvature, braking at the end.

use control_blocks::ramp_between;

use crate::interface::{Feed, FeedSource, Parameters};

/// Slowest feed that still arrives, m/s.
pub const CREEP: f64 = 2e-5;

impl Feed {
    /// Whether the feed comes from the CL file.
    pub fn uses_file(&self) -> bool {
        self.source == FeedSource::File
    }
}

/// The next velocity (m/s) of the contact point along the path: from `velocity` towards the desired feed times `ratio`, at
/// most `limit` (m/s) that the path allows here.
pub fn next_feed(p: &Parameters, velocity: f64, ratio: f64, limit: f64) -> f64 {
    let change = p.feed.acceleration * p.sample_period;
    // a feed from the file is part of the limit, and only slowed down
    let target = if p.feed.uses_file() { limit * ratio.min(1.0) } else { (p.feed.velocity * ratio).min(limit) };
    let target = if ratio > 0.0 { target.max(CREEP) } else { 0.0 };
    ramp_between(velocity, target, 2.0 * change, change)
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// The feed after `count` samples.
    fn after(count: u32, velocity: f64, ratio: f64, limit: f64) -> f64 {
        (0..count).fold(velocity, |velocity, _| next_feed(&P, velocity, ratio, limit))
    }

    #[test]
    fn the_feed_rises_with_its_acceleration_and_keeps_the_limit() {
        for k in 1..=40 {
            assert!((after(k, 0.0, 1.0, 1.0) - 0.05e-3 * f64::from(k)).abs() < 1e-12);
        }
        assert_eq!(after(41, 0.0, 1.0, 1.0), P.feed.velocity);
        assert_eq!(after(100, P.feed.velocity, 1.0, 0.5e-3), 0.5e-3);
    }

    #[test]
    fn it_falls_twice_as_fast_as_it_rises() {
        assert!((after(1, 2e-3, 0.0, 1.0) - 1.9e-3).abs() < 1e-12);
        assert!((after(15, 2e-3, 1.0, 0.5e-3) - 0.5e-3).abs() < 1e-12);
        assert!((after(1, 0.5e-3, 1.0, 1.0) - 0.55e-3).abs() < 1e-12);
    }

    #[test]
    fn a_feed_of_the_file_is_only_slowed_down() {
        let mut p = P;
        p.feed.source = FeedSource::File;
        let next = |ratio: f64| next_feed(&p, 1e-3, ratio, 1e-3);
        assert_eq!((next(1.0), next(2.0)), (1e-3, 1e-3));
        assert!((next(0.95) - 0.95e-3).abs() < 1e-12);
    }

    #[test]
    fn the_override_stops_it_and_it_always_arrives() {
        assert_eq!(after(100, 1e-3, 0.0, 1.0), 0.0);
        assert_eq!(after(100, 0.0, 1.0, 0.0), CREEP);
    }
}
