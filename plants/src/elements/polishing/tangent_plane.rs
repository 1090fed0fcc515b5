//! Plane that touches a mold where it is nearest to a ball: exact contact geometry for a moving ball.

use nalgebra::{Matrix3, Vector3};

use super::mold::{Local, Mold};
use crate::element::{Element, Ports};

/// movement of the foot point that ends the iteration, m
const EXACT: f64 = 1e-12;
/// maximum number of iterations; three are enough for a ball that was near the foot point before
const ITERATIONS: u32 = 30;

/// Pose of the mold in the world frame: `world = shift + rotation mold`.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// origin of the mold, m
    shift: Vector3<f64>,
    /// columns are the axes of the mold
    rotation: Matrix3<f64>,
}

impl Pose {
    /// A mold at `shift` m, turned by the rotation vector `tilt` rad.
    pub fn new(shift: [f64; 3], tilt: [f64; 3]) -> Self {
        let tilt = Vector3::from(tilt);
        let angle = tilt.norm();
        let axis = if angle > 0.0 { tilt / angle } else { Vector3::zeros() };
        let (sin, cos) = angle.sin_cos();
        // Rodrigues
        let turned = |e: Vector3<f64>| e * cos + axis.cross(&e) * sin + axis * (axis.dot(&e) * (1.0 - cos));
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(turned);
        Self { shift: shift.into(), rotation: Matrix3::from_columns(&axes) }
    }

    fn to_room(self, direction: Vector3<f64>) -> Vector3<f64> {
        self.rotation * direction
    }

    fn to_mold(self, place: Vector3<f64>) -> Vector3<f64> {
        self.rotation.transpose() * (place - self.shift)
    }
}

/// Foot of the perpendicular from the center of a ball to the mold, and the plane that touches the mold there.
///
/// `lift` moves the mold along its axis. The plane is a position and a quaternion (w, x, y, z) in the world frame, its z
/// axis the normal out of the material; the contact point is in the frame of the mold, `distance` from the center.
#[derive(Clone, Debug)]
pub struct TangentPlane {
    mold: Mold,
    pose: Pose,
    /// foot point of the step before, m
    foot: [f64; 2],
}

impl TangentPlane {
    /// A mold with a pose in the world frame.
    pub fn new(mold: Mold, pose: Pose) -> Self {
        Self { mold, pose, foot: [0.0; 2] }
    }

    /// The surface at the foot point, by Newton's method on the squared distance, from the foot point of the step before.
    fn nearest(&mut self, centre: Vector3<f64>) -> Local {
        for _ in 0..ITERATIONS {
            let here = self.mold.at(self.foot[0], self.foot[1]);
            let next = self.mold.inside(towards(self.foot, here, centre));
            let moved = (next[0] - self.foot[0]).hypot(next[1] - self.foot[1]);
            self.foot = next;
            if moved < EXACT {
                break;
            }
        }
        self.mold.at(self.foot[0], self.foot[1])
    }
}

/// Better foot point than `foot`, where the surface is `here`.
fn towards(foot: [f64; 2], here: Local, centre: Vector3<f64>) -> [f64; 2] {
    let [dx, dy, dz] = [centre[0] - foot[0], centre[1] - foot[1], centre[2] - here.z];
    // half the squared distance: its gradient and its second derivatives
    let (gx, gy) = (-dx - dz * here.zx, -dy - dz * here.zy);
    let hxx = 1.0 + here.zx * here.zx - dz * here.zxx;
    let hxy = here.zx * here.zy - dz * here.zxy;
    let hyy = 1.0 + here.zy * here.zy - dz * here.zyy;
    let determinant = hxx * hyy - hxy * hxy;
    if hxx > 0.0 && determinant > 0.0 {
        [foot[0] - (hyy * gx - hxy * gy) / determinant, foot[1] - (hxx * gy - hxy * gx) / determinant]
    } else {
        // beyond the centre of curvature: along the normal
        let normal = here.normal();
        let distance = Vector3::new(dx, dy, dz).dot(&normal);
        [centre[0] - distance * normal[0], centre[1] - distance * normal[1]]
    }
}

/// Shortest rotation from z to a unit vector with positive z, as a quaternion.
fn quaternion(normal: Vector3<f64>) -> [f64; 4] {
    let w = (0.5 * (1.0 + normal[2])).max(f64::MIN_POSITIVE).sqrt();
    [w, -0.5 * normal[1] / w, 0.5 * normal[0] / w, 0.0]
}

impl Element for TangentPlane {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["x", "y", "z", "lift"],
            outputs: &[
                "plane_x",
                "plane_y",
                "plane_z",
                "quat_w",
                "quat_x",
                "quat_y",
                "quat_z",
                "normal_x",
                "normal_y",
                "normal_z",
                "contact_x",
                "contact_y",
                "contact_z",
                "distance",
            ],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let &[x, y, z, lift] = inputs else { return };
        let mut centre = self.pose.to_mold(Vector3::new(x, y, z));
        centre.z -= lift;
        let here = self.nearest(centre);
        let normal = self.pose.to_room(here.normal());
        let contact = Vector3::new(self.foot[0], self.foot[1], here.z);
        let offset = self.pose.to_room(Vector3::new(contact.x, contact.y, contact.z + lift));
        let distance = (centre - contact).dot(&here.normal());
        outputs[..3].copy_from_slice((self.pose.shift + offset).as_slice());
        outputs[3..7].copy_from_slice(&quaternion(normal));
        outputs[7..10].copy_from_slice(normal.as_slice());
        outputs[10..13].copy_from_slice(contact.as_slice());
        outputs[13] = distance;
    }
}

#[cfg(test)]
mod tests {
    use super::super::mold::tests::{rough, sphere};
    use super::*;

    const HOME: [f64; 3] = [0.0; 3];

    fn place(plane: &mut TangentPlane, centre: [f64; 3], lift: f64) -> [f64; 14] {
        let mut out = [0.0; 14];
        plane.step(&[centre[0], centre[1], centre[2], lift], &mut out, 1e-4);
        out
    }

    #[test]
    fn in_a_sphere_the_foot_is_on_the_radius() {
        let mut plane = TangentPlane::new(sphere(), Pose::new(HOME, HOME));
        for centre in [[0.5e-3, 0.2e-3, 0.6e-3], [-1e-3, 0.9e-3, 1.1e-3], [1.2e-3, 0.0, 0.7e-3]] {
            let out = place(&mut plane, centre, 0.0);
            let from = Vector3::new(centre[0], centre[1], centre[2] - 3e-3);
            let away = from.norm();
            assert!((out[13] - (3e-3 - away)).abs() < 1e-15, "{centre:?}: {}", out[13]);
            for i in 0..3 {
                assert!((out[7 + i] + from[i] / away).abs() < 1e-9, "{out:?}");
            }
        }
    }

    #[test]
    fn on_any_surface_centre_minus_contact_is_along_the_normal() {
        let mut plane = TangentPlane::new(rough(), Pose::new(HOME, HOME));
        for k in 0..200 {
            let angle = f64::from(k) * 0.1;
            let (x, y) = (1.3e-3 * angle.cos(), 1.3e-3 * angle.sin());
            let foot = plane.mold.at(x, y);
            let normal = foot.normal();
            let centre = [x + 0.5e-3 * normal[0], y + 0.5e-3 * normal[1], foot.z + 0.5e-3 * normal[2]];
            let out = place(&mut plane, centre, 0.0);
            assert!((out[13] - 0.5e-3).abs() < 1e-15, "{k}: {}", out[13]);
            assert!((out[10] - x).hypot(out[11] - y) < 1e-11, "{k}");
        }
    }

    #[test]
    fn the_quaternion_turns_z_into_the_normal() {
        let mut plane = TangentPlane::new(rough(), Pose::new(HOME, [0.02, -0.01, 0.3]));
        let out = place(&mut plane, [1.2e-3, -0.8e-3, 0.9e-3], 0.0);
        let (w, u) = (out[3], Vector3::new(out[4], out[5], out[6]));
        assert!((w * w + u.norm_squared() - 1.0).abs() < 1e-15);
        let z =
            [2.0 * (u[0] * u[2] + w * u[1]), 2.0 * (u[1] * u[2] - w * u[0]), 1.0 - 2.0 * (u[0] * u[0] + u[1] * u[1])];
        for i in 0..3 {
            assert!((z[i] - out[7 + i]).abs() < 1e-15);
        }
    }

    #[test]
    fn a_mold_that_moves_with_the_ball_keeps_its_contact() {
        let pose = Pose::new([0.05e-3, -0.02e-3, 0.07e-3], [0.03, -0.015, 0.2]);
        let [centre, lift] = [[0.9e-3, -0.4e-3, 0.75e-3], [0.0, 0.0, 0.1e-3]];
        let still = place(&mut TangentPlane::new(rough(), Pose::new(HOME, HOME)), centre, 0.0);
        let moved = pose.to_room(Vector3::from(centre) + Vector3::from(lift)) + pose.shift;
        let out = place(&mut TangentPlane::new(rough(), pose), moved.into(), lift[2]);
        for i in 10..14 {
            assert!((out[i] - still[i]).abs() < 1e-12, "{i}: {} and {}", out[i], still[i]);
        }
        // the plane is as far from the ball as the surface is
        let away = (moved - Vector3::new(out[0], out[1], out[2])).dot(&Vector3::new(out[7], out[8], out[9]));
        assert!((away - still[13]).abs() < 1e-15);
    }

    #[test]
    fn far_away_it_stays_on_the_mold_and_finds_back() {
        let mut plane = TangentPlane::new(rough(), Pose::new(HOME, HOME));
        for centre in [[0.0, 0.0, 0.05], [0.3, -0.2, 0.05], [1e-3, 1e-3, -0.02]] {
            let out = place(&mut plane, centre, 0.0);
            assert!(out.iter().all(|v| v.is_finite()) && out[10].hypot(out[11]) <= 2e-3 + 1e-15, "{out:?}");
        }
        let fresh = place(&mut TangentPlane::new(rough(), Pose::new(HOME, HOME)), [0.5e-3, 0.0, 0.7e-3], 0.0);
        let back = place(&mut plane, [0.5e-3, 0.0, 0.7e-3], 0.0);
        assert!((fresh[13] - back[13]).abs() < 1e-15);
    }
}
