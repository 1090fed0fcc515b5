//! The parts of the velocity and their sum (eq. 1).

use nalgebra::Vector3;

use crate::interface::VelocityOutput;
use crate::path::centre_path::Frame;

/// The parts of the velocity, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VelocityParts {
    /// Along the normal.
    pub normal: f64,
    /// Along the tangent.
    pub tangential: f64,
    /// Of the position feedback, or of a commissioning run in the air.
    pub position: Vector3<f64>,
    /// Of the stick-slip, along `sideways`.
    pub stick_slip: f64,
    /// Unit vector of the stick-slip.
    pub sideways: Vector3<f64>,
}

impl VelocityParts {
    /// The velocity, not faster than `limit` (m/s).
    pub fn sum(&self, frame: &Frame, limit: f64) -> Vector3<f64> {
        // eq. 1 with eqs. 2, 3 and 16: v = v_t + v_n + v_p + v_v
        let velocity = self.tangential * frame.tangent
            + self.normal * frame.normal
            + self.position
            + self.stick_slip * self.sideways;
        // no division by the size at rest: a branch around it may be compiled to compute both travels
        velocity * (limit / velocity.norm().max(limit))
    }

    /// As the FMU shows it, with the sum `velocity`.
    pub fn report(&self, velocity: &Vector3<f64>) -> VelocityOutput {
        VelocityOutput {
            x: velocity.x,
            y: velocity.y,
            z: velocity.z,
            normal: self.normal,
            tangential: self.tangential,
            position: self.position.norm(),
            stick_slip: self.stick_slip,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame {
        centre: Vector3::new(0.0, 0.0, 0.0),
        contact: Vector3::new(0.0, 0.0, 0.0),
        normal: Vector3::new(0.0, 0.0, 1.0),
        tangent: Vector3::new(1.0, 0.0, 0.0),
        ratio: 1.0,
        feed_max: 1.0,
    };

    #[test]
    fn eq_1_adds_the_parts_and_keeps_the_limit() {
        let parts = VelocityParts {
            normal: -1e-3,
            tangential: 2e-3,
            position: Vector3::new(1e-4, 0.0, 0.0),
            stick_slip: -10e-3,
            sideways: Vector3::y(),
        };
        assert_eq!(parts.sum(&FRAME, 1.0), Vector3::new(2.1e-3, -10e-3, -1e-3));
        let slow = parts.sum(&FRAME, 1e-3);
        assert!((slow.norm() - 1e-3).abs() < 1e-15 && slow.cross(&parts.sum(&FRAME, 1.0)).norm() < 1e-15);
        assert_eq!(VelocityParts::default().sum(&FRAME, 1e-3), Vector3::zeros());
    }
}
