//! Position of the ring center, in the frame that turns with the table.

use serde::{Deserialize, Serialize};

use crate::sine_fit::Sine;

/// Center of the ring in the table frame; at spindle angle 0 its x axis points to the pusher.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Center {
    /// m
    pub x: f64,
    /// m
    pub y: f64,
}

impl Center {
    /// Center from a fit of the tip position, which is smallest where the ring is nearest.
    pub fn from_sine(sine: &Sine) -> Self {
        Self { x: -sine.cosine, y: sine.sine }
    }

    /// Distance B from the spindle axis, m.
    pub fn eccentricity(&self) -> f64 {
        // eq. 26, 30
        self.x.hypot(self.y)
    }

    /// Spindle angle at which the ring is nearest to the pusher, rad.
    pub fn nearest(&self) -> f64 {
        // eq. 27 with both signs: the minimum of y, atan2(-b1, -b2)
        (-self.y).atan2(self.x)
    }

    /// Distance of the center towards the pusher at the spindle angle `angle` rad, m.
    pub fn along(&self, angle: f64) -> f64 {
        self.eccentricity() * (angle - self.nearest()).cos()
    }

    /// Distance to another center, m.
    pub fn distance(&self, other: &Self) -> f64 {
        // eq. 39 in cartesian coordinates
        (self.x - other.x).hypot(self.y - other.y)
    }

    /// Distance by which the center has moved beyond the axis, starting from `before`, m.
    pub fn overshoot(&self, before: &Self) -> f64 {
        let along = (self.x * before.x + self.y * before.y) / before.eccentricity();
        if along < 0.0 { -along } else { 0.0 }
    }
}

/// Estimate of a model of the ring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Center of the ring.
    pub center: Center,
    /// Mean tip position b0: the tip at the surface of the centered ring, m.
    pub mean: f64,
    /// Standard deviation of each coordinate of the center, m.
    pub sigma: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sine_fit::SineSums;
    use control_blocks::wrap;
    use std::f64::consts::TAU;

    #[test]
    fn the_angle_is_recovered_in_all_quadrants_and_both_directions() {
        for direction in [1.0, -1.0] {
            for step in 0..16 {
                let nearest = TAU * f64::from(step) / 16.0 + 0.1;
                let mut sums = SineSums::default();
                for k in 0..200 {
                    let theta = direction * TAU * f64::from(k) / 200.0;
                    // nearest: the surface is closest to the pusher, the tip furthest back
                    sums.add(theta, 0.1 - 1e-4 * (theta - nearest).cos());
                }
                let center = Center::from_sine(&sums.fit().unwrap());
                assert!(wrap(center.nearest() - nearest).abs() < 1e-9, "{nearest}");
                assert!((center.eccentricity() - 1e-4).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn at_angle_zero_the_table_frame_is_the_world() {
        let center = Center { x: 1e-3, y: 0.0 };
        assert_eq!(center.nearest(), 0.0);
        // a quarter revolution before, the ring is on the -y side of the world: it arrives by rotation
        let ahead = Center { x: 0.0, y: -1e-3 };
        assert!((ahead.nearest() - TAU / 4.0).abs() < 1e-12);
    }

    #[test]
    fn the_distance_of_two_centers_is_that_of_points() {
        let (a, b) = (Center { x: 5e-4, y: 1e-4 }, Center { x: 2e-4, y: 5e-4 });
        assert!((a.distance(&b) - 5e-4).abs() < 1e-15);
    }

    #[test]
    fn towards_the_pusher_it_is_the_projection_at_every_angle() {
        let center = Center { x: 3e-4, y: 4e-4 };
        for k in 0..16 {
            let angle = 0.5 * f64::from(k);
            let expected = 3e-4 * angle.cos() - 4e-4 * angle.sin();
            assert!((center.along(angle) - expected).abs() < 1e-15, "{angle} rad");
        }
    }

    #[test]
    fn only_what_went_through_the_axis_is_overshoot() {
        let before = Center { x: 3e-4, y: 4e-4 };
        assert_eq!(Center { x: 3e-5, y: 4e-5 }.overshoot(&before), 0.0);
        let through = Center { x: -3e-6, y: -4e-6 };
        assert!((through.overshoot(&before) - 5e-6).abs() < 1e-18);
        // sideways is no overshoot
        assert!(Center { x: -4e-6, y: 3e-6 }.overshoot(&before) < 1e-20);
        assert_eq!(through.overshoot(&Center::default()), 0.0);
    }
}
