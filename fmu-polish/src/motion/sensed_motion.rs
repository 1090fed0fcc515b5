//! The travel of the axes through the lag of the sensor, for the work against the lateral force: otherwise a bent tip
//! would seem to do work.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Between two samples; by default before the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SensedMotion {
    /// last force (N) and last position of the axes (m)
    before: Option<(Vector3<f64>, Vector3<f64>)>,
    /// travel that the sensor has not sensed yet, m
    unsensed: Vector3<f64>,
}

impl SensedMotion {
    /// Takes the force (N) and the position (m) of a sample; returns the mean force since the last one, and the sensed
    /// travel in that time.
    pub fn step(
        &mut self,
        p: &Parameters,
        force: &Vector3<f64>,
        position: &Vector3<f64>,
    ) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let (last, from) = self.before.replace((*force, *position))?;
        Some((0.5 * (last + force), self.sensed(p, &(position - from))))
    }

    /// The part of a travel (m) that is sensed in this sample: first-order lag of a steady motion between two samples.
    fn sensed(&mut self, p: &Parameters, displacement: &Vector3<f64>) -> Vector3<f64> {
        let lag = p.sensor_bandwidth * p.sample_period;
        let keep = (-lag).exp();
        let unsensed = self.unsensed * keep + displacement * ((1.0 - keep) / lag);
        let sensed = displacement + self.unsensed - unsensed;
        self.unsensed = unsensed;
        sensed
    }
}

/// White noise of the position after the lag, over its standard deviation. With the lag 1 / l in samples, a = exp(-l)
/// and c = (1 - a) / l the position is sensed by 1 - c in its own sample and by c (1 - a) a^(k-1) k samples later.
pub fn sensed_noise(p: &Parameters) -> f64 {
    let lag = p.sensor_bandwidth * p.sample_period;
    let keep = (-lag).exp();
    let late = (1.0 - keep) / lag;
    ((1.0 - late).powi(2) + late * late * (1.0 - keep) / (1.0 + keep)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_of_the_position_is_reduced_in_proportion() {
        for bandwidth in [300.0, 1256.6, 1e4] {
            let p = Parameters { sensor_bandwidth: bandwidth, ..Parameters::START };
            // the response to one outlier is the travel sensed since the start
            let (mut motion, mut position, mut squares) = (SensedMotion::default(), 0.0, 0.0);
            motion.step(&p, &Vector3::zeros(), &Vector3::zeros());
            for k in 0..200 {
                let off = if k == 0 { Vector3::x() } else { Vector3::zeros() };
                let (_, displacement) = motion.step(&p, &Vector3::zeros(), &off).unwrap();
                position += displacement.x;
                squares += position * position;
            }
            assert!((squares.sqrt() / sensed_noise(&p) - 1.0).abs() < 1e-9, "{bandwidth}: {squares}");
        }
    }

    #[test]
    fn a_steady_motion_is_sensed_a_time_constant_late() {
        let p = Parameters::START;
        let (mut motion, mut sensed) = (SensedMotion::default(), 0.0);
        let force = Vector3::y();
        assert_eq!(motion.step(&p, &force, &Vector3::zeros()), None);
        for k in 1..=50 {
            let (mean, displacement) =
                motion.step(&p, &(force * f64::from(k + 1)), &(Vector3::x() * f64::from(k))).unwrap();
            assert_eq!(mean, force * (f64::from(k) + 0.5));
            sensed += displacement.x;
        }
        let late = 1.0 / (p.sensor_bandwidth * p.sample_period);
        assert!((sensed - (50.0 - late)).abs() < 1e-9, "{sensed}");
    }
}
