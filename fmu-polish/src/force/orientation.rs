//! How the force sensor is mounted: turned about z, and with axes that count the other way.
//!
//! It shows S R(-a) F of a force F, with the rotation R(a) about z and the signs S = diag(1, +-1, +-1), so F = R(a) S f.

use nalgebra::Vector3;

use crate::interface::Parameters;

/// The mounting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    cos: f64,
    sin: f64,
    signs: Vector3<f64>,
}

impl Orientation {
    /// That of the parameters.
    pub fn of(p: &Parameters) -> Self {
        let (sin, cos) = p.sensor_rotation.sin_cos();
        let [y, z] = [p.sensor_direction_y, p.sensor_direction_z].map(f64::from);
        Self { cos, sin, signs: Vector3::new(1.0, y, z) }
    }

    /// The vector in the work frame for a vector of the sensor.
    pub fn work(&self, shown: &Vector3<f64>) -> Vector3<f64> {
        let f = shown.component_mul(&self.signs);
        Vector3::new(f.x * self.cos - f.y * self.sin, f.y * self.cos + f.x * self.sin, f.z)
    }

    /// The vector of the sensor for a vector in the work frame.
    pub fn shown(&self, f: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(f.x * self.cos + f.y * self.sin, f.y * self.cos - f.x * self.sin, f.z).component_mul(&self.signs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mounted(rotation: f64, y: i32, z: i32) -> Orientation {
        let mut p = Parameters::START;
        (p.sensor_rotation, p.sensor_direction_y, p.sensor_direction_z) = (rotation, y, z);
        Orientation::of(&p)
    }

    #[test]
    fn a_sensor_as_the_axes_changes_no_bit() {
        let f = Vector3::new(0.1, -0.7, 4.983);
        assert_eq!(mounted(0.0, 1, 1).work(&f), f);
        assert_eq!(mounted(0.0, 1, 1).shown(&f), f);
    }

    #[test]
    fn a_sensor_turned_by_a_quarter_shows_a_force_along_x_at_minus_y() {
        let f = mounted(std::f64::consts::FRAC_PI_2, 1, 1).shown(&Vector3::x());
        assert!((f + Vector3::y()).norm() < 1e-15, "{f}");
        let f = mounted(std::f64::consts::FRAC_PI_2, -1, -1).shown(&Vector3::new(1.0, 0.0, 2.0));
        assert!((f - Vector3::new(0.0, 1.0, -2.0)).norm() < 1e-15, "{f}");
    }

    #[test]
    fn what_is_shown_is_taken_back() {
        for (rotation, y, z) in [(0.4, 1, -1), (-2.0, -1, 1), (3.1, -1, -1)] {
            let (sensor, f) = (mounted(rotation, y, z), Vector3::new(1.0, -2.0, 3.0));
            assert!((sensor.work(&sensor.shown(&f)) - f).norm() < 1e-14);
        }
    }
}
