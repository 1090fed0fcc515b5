//! Whether the axes stand, whoever moves them.

use control_blocks::ticks;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::monitoring::axis::BAND;

/// Time (s) without motion of axes at rest: with steps of 1 um they are slower than 150 um/s, a hundredth of an excitation.
const REST: f64 = 0.01;

/// Compares the measurements with a rest position.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct RestMonitor {
    origin: Vector3<f64>,
    samples: u32,
}

impl RestMonitor {
    /// Takes the measurements of a sample, m; the last bit may flicker.
    pub fn update(&mut self, p: &Parameters, position: &Vector3<f64>) {
        self.samples = self.samples.saturating_add(1);
        if (position - self.origin).amax() > BAND * p.encoder_resolution {
            (self.origin, self.samples) = (*position, 0);
        }
    }

    /// Whether all axes have been at rest for long enough.
    pub fn at_rest(&self, p: &Parameters) -> bool {
        self.samples >= ticks(REST, p.sample_period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// Samples until the axes are at rest that move by `step` encoder steps in each, for at most 1000.
    fn rests(step: impl Fn(u32) -> f64) -> Option<u32> {
        let (mut rest, mut origin) = (RestMonitor::default(), Vector3::new(0.1, 0.2, 0.3));
        (1..1000).find(|k| {
            origin.y += step(*k) * P.encoder_resolution;
            rest.update(&P, &origin);
            rest.at_rest(&P)
        })
    }

    #[test]
    fn axes_that_are_constant_or_flicker_are_at_rest_and_slow_ones_are_not() {
        let time = ticks(REST, P.sample_period);
        assert_eq!(rests(|_| 0.0), Some(time + 1));
        assert_eq!(rests(|k| if k % 2 == 0 { 1.0 } else { -1.0 }), Some(time + 1));
        assert_eq!(rests(|_| 2.0 / f64::from(time)), None);
        // from where they have come to
        assert_eq!(rests(|k| if k < 100 { 5.0 } else { 0.0 }), Some(99 + time));
    }
}
