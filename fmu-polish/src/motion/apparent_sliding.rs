//! Apparent sliding: through a sensor that is faster than configured, a tip that only bends on a circle seems to slide.
//!
//! The force of a tip that rotates with the axes is in phase with their position. Through a sensor with less lag than
//! configured it leads the sensed travel by an angle e. It seems to do the work of a ball that slides at sin e of the
//! speed of the axes. A ball never slides backwards. So sin e is at most the minimum fraction in the cycle, for any
//! sensor, and at most that of a sensor twice as fast as configured: e = atan(w / b) - atan(w / 2 b) at w rad/s of
//! rotation and b rad/s of bandwidth.

use std::f64::consts::PI;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::interface::{Mode, Parameters};

/// Maximum bandwidth of a sensor, over the configured one.
const FASTER: f64 = 2.0;

/// Speed of the axes, and how much of it may be apparent; by default at the start of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ApparentSliding {
    /// way of the axes since the last window, m
    distance: f64,
    /// minimum fraction of the speed of the axes at which the ball seemed to slide
    minimum: Option<f64>,
}

impl ApparentSliding {
    /// Adds the sensed travel (m) of a sample.
    pub fn add(&mut self, sensed: &Vector3<f64>) {
        self.distance += sensed.norm();
    }

    /// Ends a window of `time` s: the mean speed of the axes in it, m/s.
    pub fn round(&mut self, time: f64) -> f64 {
        std::mem::take(&mut self.distance) / time
    }

    /// The sliding speed (m/s) without the apparent part, where the axes rotate at `round` m/s.
    pub fn certain(&mut self, p: &Parameters, speed: f64, round: f64) -> f64 {
        if p.stick_slip.mode != Mode::Circular || round == 0.0 {
            return speed;
        }
        let ratio = self.minimum.unwrap_or_else(|| maximum(p)).min(speed / round).max(0.0);
        self.minimum = Some(ratio);
        speed - ratio * round
    }
}

/// The maximum apparent sliding, as a fraction of the speed of the axes.
fn maximum(p: &Parameters) -> f64 {
    let turning = PI / (f64::from(p.stick_slip.half_period.max(1)) * p.sample_period * p.sensor_bandwidth);
    (turning.atan() - (turning / FASTER).atan()).sin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::stick_slip::tests::circular;

    const P: Parameters = Parameters::START;

    #[test]
    fn a_bent_tip_seems_to_slide_as_derived() {
        // 50 Hz through 200 Hz that are configured and 400 Hz that are true
        let (configured, actual) = (P.sensor_bandwidth, 2.0 * P.sensor_bandwidth);
        let (omega, count) = (PI / (10.0 * P.sample_period), 2000);
        let through = |bandwidth: f64, k: u32| {
            let angle = omega * P.sample_period * f64::from(k) - (omega / bandwidth).atan();
            Vector3::new(angle.cos(), angle.sin(), 0.0)
        };
        let work: f64 = (0..count)
            .map(|k| {
                let force = -0.5 * (through(actual, k) + through(actual, k + 1));
                -force.dot(&(through(configured, k + 1) - through(configured, k))) / force.norm()
            })
            .sum();
        let distance: f64 = (0..count).map(|k| (through(configured, k + 1) - through(configured, k)).norm()).sum();
        assert!((work.abs() / distance / maximum(&P) - 1.0).abs() < 1e-9, "{} {}", work / distance, maximum(&P));
    }

    #[test]
    fn it_is_taken_off_up_to_what_has_been_seen_in_the_cycle() {
        let (p, mut apparent) = (circular(), ApparentSliding::default());
        apparent.add(&Vector3::new(3e-3, 4e-3, 0.0));
        let round = apparent.round(0.2);
        assert!((round - 25e-3).abs() < 1e-15 && apparent.round(0.2) == 0.0);
        // certain except for the apparent part of the fastest sensor, then that of the observed one
        assert!((apparent.certain(&p, 10e-3, round) - (10e-3 - maximum(&p) * round)).abs() < 1e-15);
        assert!(apparent.certain(&p, 1e-3, round).abs() < 1e-15);
        assert!((apparent.certain(&p, 10e-3, round) - 9e-3).abs() < 1e-15);
        // a sensor slower than configured has no apparent sliding, and nothing is subtracted
        assert_eq!([-1e-3, 10e-3].map(|speed| apparent.certain(&p, speed, round)), [-1e-3, 10e-3]);
    }

    #[test]
    fn a_sweep_back_and_forth_and_axes_at_rest_are_left_as_measured() {
        let mut apparent = ApparentSliding::default();
        assert_eq!([apparent.certain(&P, 5e-3, 15e-3), apparent.certain(&circular(), 5e-3, 0.0)], [5e-3, 5e-3]);
    }
}
