//! Whether the drive has the torque for a path, known before anything moves.

use crate::interface::Parameters;
use crate::path::path_table::PathTable;

/// Largest torque (N.m) that the path needs anywhere at a spindle speed (rad/s): inertia and viscous friction.
pub fn needed_torque(p: &Parameters, path: &PathTable, speed: f64) -> f64 {
    p.servo.inertia * speed * speed * path.acceleration + p.servo.viscous_friction * speed.abs() * path.velocity
}

/// Torque (N.m) that a path may need.
pub fn available_torque(p: &Parameters) -> f64 {
    p.limits.torque_ratio * p.servo.torque_max
}

/// Whether a path needs more than it may at a spindle speed (rad/s).
pub fn infeasible(p: &Parameters, path: &PathTable, speed: f64) -> bool {
    needed_torque(p, path, speed) > available_torque(p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::SurfaceKind;
    use crate::path::depth_table::DepthTable;
    use crate::path::kinematics::Arm;

    const RPM: f64 = std::f64::consts::PI / 30.0;

    fn torque(p: &Parameters, rpm: f64) -> f64 {
        let path = PathTable::new(Arm::new(p), &DepthTable::of_surface(p).unwrap(), 24);
        needed_torque(p, &path, rpm * RPM)
    }

    #[test]
    fn five_hundred_metres_per_second_squared_need_5_newton_metres() {
        let mut p = Parameters::START;
        p.surface.kind = SurfaceKind::Wave;
        p.path.harmonics = 50;
        p.servo.viscous_friction = 0.0;
        assert!((torque(&p, 600.0) - 5.0).abs() < 0.01, "{}", torque(&p, 600.0));
    }

    #[test]
    fn the_0x4_is_feasible_at_600_rpm_and_at_the_rim_not_at_2400() {
        let p = Parameters::START;
        assert!(torque(&p, 600.0) < 1.2);
        assert!(torque(&p, 2400.0) > 2.0 * available_torque(&p));
        let mut p = Parameters::START;
        p.surface.outer_radius = 0.031;
        let torque = torque(&p, 2400.0);
        assert!(torque > 4.5 && torque < available_torque(&p), "{torque}");
    }

    #[test]
    fn only_what_needs_more_torque_than_it_may_have_is_infeasible() {
        let p = Parameters::START;
        let path = PathTable::new(Arm::new(&p), &DepthTable::of_surface(&p).unwrap(), 24);
        for (rpm, rejected) in [(0.0, false), (600.0, false), (-600.0, false), (2400.0, true), (-2400.0, true)] {
            assert_eq!(infeasible(&p, &path, rpm * RPM), rejected, "{rpm}");
        }
    }
}
