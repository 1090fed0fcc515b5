//! Median of three samples: a single wrong sample is no contact, and no motion of the surface.
//!
//! One sample late, which following and contact tolerate; the models of the ring use the unfiltered samples.

use serde::{Deserialize, Serialize};

/// Probe and surface without single spikes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Calm {
    /// Deflection of the probe, m.
    pub probe: f64,
    /// Position of the measuring tip, m.
    pub tip: f64,
}

/// The last samples; by default none.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct CalmFilter(Option<[Calm; 3]>);

impl CalmFilter {
    /// Adds a sample.
    pub fn update(&mut self, now: Calm) -> Calm {
        let [_, a, b] = self.0.unwrap_or([now; 3]);
        self.0 = Some([a, b, now]);
        let middle = |of: fn(&Calm) -> f64| median([of(&a), of(&b), of(&now)]);
        Calm { probe: middle(|calm| calm.probe), tip: middle(|calm| calm.tip) }
    }
}

fn median([a, b, c]: [f64; 3]) -> f64 {
    a.min(b).max(a.max(b).min(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calmed(probes: &[f64]) -> Vec<f64> {
        let mut filter = CalmFilter::default();
        probes.iter().map(|&probe| filter.update(Calm { probe, tip: 0.0 }).probe).collect()
    }

    #[test]
    fn one_bad_sample_vanishes_and_a_motion_is_one_sample_late() {
        assert_eq!(calmed(&[0.0, 0.0, 9.0, 0.0, -9.0, 0.0]), [0.0; 6]);
        assert_eq!(calmed(&[0.0, 1.0, 2.0, 3.0]), [0.0, 0.0, 1.0, 2.0]);
        assert_eq!(calmed(&[5.0]), [5.0]);
    }
}
