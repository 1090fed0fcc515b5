//! Early contact of the pusher with the ring: `probe.at_pusher` is configured too large.
//!
//! In a stroke the probe is deflected until the pusher touches. A ring that is hit early moves ahead of the slide, and
//! the probe extends although the slide still moves in; a jammed probe stays, and one of another scale moves in. The
//! hit cannot be detected before it has happened, and no stop reduces its effect; but the probe position at the hit is
//! that of the pusher.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Extension of the probe above which it is detected, m (default: five times the coarsest resolution).
const OUT: f64 = 1e-4;

/// The probe in the last stroke, m; by default before the first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct EarlyContact {
    deepest: f64,
    now: f64,
}

impl EarlyContact {
    /// Adds the position (m) of the probe in a stroke, without single spikes.
    pub fn update(&mut self, probe: f64) {
        (self.deepest, self.now) = (self.deepest.max(probe), probe);
    }

    /// Position of the probe (m) at the hit, if the probe has extended since and the position was nearer to the
    /// configured one of the pusher than to that of following.
    pub fn met(&self, p: &Parameters) -> Option<f64> {
        let out = self.deepest - self.now > OUT && self.deepest > 0.5 * (p.null() + p.probe.at_pusher);
        out.then_some(self.deepest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    fn met(probes: &[f64]) -> Option<f64> {
        let mut contact = EarlyContact::default();
        probes.iter().for_each(|&probe| contact.update(probe));
        contact.met(&P)
    }

    #[test]
    fn a_ring_that_runs_ahead_of_the_slide_was_met_where_the_probe_was_deepest() {
        assert_eq!(met(&[4.5e-3, 16e-3, 17e-3, 16.95e-3, 16.89e-3]), Some(17e-3));
    }

    #[test]
    fn a_probe_that_stays_or_goes_in_has_met_nothing() {
        for probes in [&[4.5e-3, 16e-3, 17e-3, 17e-3, 16.91e-3][..], &[4.5e-3, 10e-3, 16e-3], &[]] {
            assert_eq!(met(probes), None, "{probes:?}");
        }
    }

    #[test]
    fn a_surface_that_has_turned_away_at_the_begin_was_not_met() {
        // the probe is at 4.5 mm as it follows, and the pusher at 20 mm
        assert_eq!(met(&[12.2e-3, 12e-3]), None);
        assert_eq!(met(&[12.3e-3, 12.1e-3]), Some(12.3e-3));
    }
}
