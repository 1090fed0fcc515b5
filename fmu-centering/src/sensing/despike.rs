//! Median of five samples: single spikes of dirt or electricity vanish, a slow surface stays as it is.

use serde::{Deserialize, Serialize};

/// Samples in the window.
const WINDOW: usize = 5;

/// Age of what comes out, in samples: that of the middle of the window.
pub const LAG: f64 = 2.0;

/// One sample of spindle, slide and surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Spindle angle, rad.
    pub angle: f64,
    /// Slide position, m.
    pub slide: f64,
    /// Position of the measuring tip, m.
    pub tip: f64,
}

impl Measurement {
    /// Deflection of the probe, m.
    pub fn probe(&self) -> f64 {
        self.slide - self.tip
    }
}

/// The last samples; by default none.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Despiker {
    window: [Measurement; WINDOW],
    count: usize,
}

impl Despiker {
    /// Takes a sample; the sample of [`LAG`] samples ago with the median tip, once there are enough.
    pub fn update(&mut self, seen: Measurement) -> Option<Measurement> {
        self.window.rotate_left(1);
        self.window[WINDOW - 1] = seen;
        self.count = (self.count + 1).min(WINDOW);
        let mut tips = self.window.map(|seen| seen.tip);
        tips.sort_unstable_by(f64::total_cmp);
        (self.count == WINDOW).then_some(Measurement { tip: tips[WINDOW / 2], ..self.window[WINDOW / 2] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(k: i32, tip: f64) -> Measurement {
        Measurement { angle: f64::from(k), slide: f64::from(2 * k), tip }
    }

    #[test]
    fn a_monotone_surface_is_only_delayed() {
        let mut despiker = Despiker::default();
        for k in 0..50 {
            let seen = despiker.update(at(k, f64::from(k).powi(3)));
            assert_eq!(seen, (k >= 4).then(|| at(k - 2, f64::from(k - 2).powi(3))));
        }
    }

    #[test]
    fn two_spikes_in_five_samples_vanish() {
        let mut despiker = Despiker::default();
        for (k, tip) in (0..).zip([0.0, 9.0, 0.1, -9.0, 0.2, 0.3, 9.0, 9.0, 0.4]) {
            if let Some(seen) = despiker.update(at(k, tip)) {
                assert!((0.0..=0.4).contains(&seen.tip));
            }
        }
    }

    #[test]
    fn the_collapse_of_the_probe_is_slide_less_tip() {
        assert_eq!(Measurement { angle: 9.0, slide: 0.5, tip: 0.25 }.probe(), 0.25);
    }
}
