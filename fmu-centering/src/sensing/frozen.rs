//! A probe that keeps one value although it cannot: a broken encoder would else look like a ring that is centred.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::sensing::reading::Sample;

/// Motion of the slide on the ring that must change what the probe reads, m (ten times the coarsest resolution).
const MOVED: f64 = 2e-4;
/// Uncertainty of the probe position at which the pusher touches, m (our choice: three times that of the first push).
const PRESSED: f64 = 1e-4;
/// Resolution of the probe, in tolerances, with which no ring reads the same for a whole revolution.
const FINE: f64 = 0.2;

/// Since when the probe has kept its value.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Frozen {
    probe: f64,
    /// slide position when the probe read something else, m
    slide: f64,
    /// turning since then, rad
    turned: f64,
    /// smallest change that was ever read, m
    finest: f64,
}

impl Default for Frozen {
    /// Nothing read.
    fn default() -> Self {
        Self { probe: 0.0, slide: 0.0, turned: 0.0, finest: f64::MAX }
    }
}

impl Frozen {
    /// Takes a sample and the turning (rad) since the one before; whether the probe is broken.
    pub fn update(&mut self, p: &Parameters, sample: &Sample, turned: f64) -> bool {
        // a ring at the pusher goes with the slide, and without contact there is nothing to read
        let rests = !(p.probe.contact..p.probe.at_pusher - PRESSED).contains(&sample.probe);
        let change = (sample.probe - self.probe).abs();
        if change > 0.0 {
            self.finest = self.finest.min(change);
        }
        if rests || change > 0.0 {
            (self.probe, self.slide, self.turned) = (sample.probe, sample.slide, 0.0);
        }
        self.turned += turned;
        let moved = (sample.slide - self.slide).abs() > MOVED;
        moved || (self.finest < FINE * p.tolerance && self.turned.abs() >= TAU)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// Angle at which the probe counts as broken, in samples of 0.01 rad of a probe that has read steps of `finest` m.
    fn broken(finest: f64, sample: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
        let mut frozen = Frozen { finest, ..Frozen::default() };
        (0..3000).map(|k| 0.01 * f64::from(k)).find(|&angle| {
            let (slide, probe) = sample(angle);
            frozen.update(&P, &Sample { angle, slide, probe }, 0.01)
        })
    }

    #[test]
    fn a_live_probe_is_not_broken() {
        assert_eq!(broken(1e-7, |angle| (0.1, 5e-3 + 1e-6 * angle.sin())), None);
        assert_eq!(broken(1e-7, |angle| (0.1 + 1e-3 * angle, 5e-3 + 1e-3 * angle)), None);
    }

    #[test]
    fn a_slide_that_moves_or_a_whole_turn_shows_a_frozen_one() {
        let moved = broken(1e-7, |angle| (0.1 + 1e-3 * angle, 5e-3)).unwrap();
        assert!((moved - 0.2).abs() < 0.02, "{moved} rad");
        let turned = broken(1e-7, |_| (0.1, 5e-3)).unwrap();
        assert!((turned - TAU).abs() < 0.02, "{turned} rad");
    }

    #[test]
    fn a_coarse_probe_may_read_the_same_for_long() {
        assert_eq!(broken(1e-6, |_| (0.1, 5e-3)), None);
    }

    #[test]
    fn without_contact_and_at_the_pusher_it_may_rest() {
        for probe in [0.0, P.probe.at_pusher - 3e-5, P.probe.at_pusher + 3e-5] {
            assert_eq!(broken(1e-7, |angle| (1e-3 * angle, probe)), None);
        }
    }
}
