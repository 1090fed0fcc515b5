//! Feed along the path: wanted velocity, override, curvature, braking at the end.

use serde::{Deserialize, Serialize};

use crate::parameters::Parameters;

/// Slowest feed that still arrives, m/s.
const CREEP: f64 = 2e-5;

/// The feed between two samples; by default at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Feed {
    /// Velocity of the contact point along the path, m/s.
    pub velocity: f64,
}

impl Feed {
    /// Moves towards the wanted feed times `share`, at most `limit` (m/s) that the path allows here.
    pub fn step(&mut self, p: &Parameters, share: f64, limit: f64) {
        let change = p.feed.acceleration * p.sample_period;
        // a feed from the file is part of the limit, and only slowed down
        let wanted = if p.feed.uses_file() { limit * share.min(1.0) } else { (p.feed.velocity * share).min(limit) };
        let wanted = if share > 0.0 { wanted.max(CREEP) } else { 0.0 };
        self.velocity = wanted.clamp(self.velocity - 2.0 * change, self.velocity + change);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::DEFAULT;

    #[test]
    fn the_feed_rises_with_its_acceleration_and_keeps_the_limit() {
        let mut feed = Feed::default();
        for k in 1..=40 {
            feed.step(&P, 1.0, 1.0);
            assert!((feed.velocity - 0.05e-3 * f64::from(k)).abs() < 1e-12);
        }
        feed.step(&P, 1.0, 1.0);
        assert_eq!(feed.velocity, P.feed.velocity);
        (0..100).for_each(|_| feed.step(&P, 1.0, 0.5e-3));
        assert_eq!(feed.velocity, 0.5e-3);
    }

    #[test]
    fn the_override_stops_it_and_it_always_arrives() {
        let mut feed = Feed { velocity: 1e-3 };
        (0..100).for_each(|_| feed.step(&P, 0.0, 1.0));
        assert_eq!(feed.velocity, 0.0);
        (0..100).for_each(|_| feed.step(&P, 1.0, 0.0));
        assert_eq!(feed.velocity, CREEP);
    }
}
