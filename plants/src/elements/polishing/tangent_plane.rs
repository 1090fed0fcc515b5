//! Plane that touches a mold where it is nearest to a ball: exact contact geometry for a moving ball.

use super::mold::{Local, Mold};
use crate::element::{Element, Ports};

/// movement of the foot point that counts as none, m
const EXACT: f64 = 1e-12;
/// most iterations; three are enough for a ball that was near the foot point before
const ITERATIONS: u32 = 30;

/// Where the mold stands in the room: `room = shift + rotation mold`.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// origin of the mold, m
    shift: [f64; 3],
    /// columns are the axes of the mold
    rotation: [[f64; 3]; 3],
}

impl Pose {
    /// A mold at `shift` m, turned by the rotation vector `tilt` rad.
    pub fn new(shift: [f64; 3], tilt: [f64; 3]) -> Self {
        let angle = dot(tilt, tilt).sqrt();
        let axis = tilt.map(|t| if angle > 0.0 { t / angle } else { 0.0 });
        let (sin, cos) = angle.sin_cos();
        let turned = |e: [f64; 3]| {
            // Rodrigues
            let (across, along) = (cross(axis, e), dot(axis, e) * (1.0 - cos));
            [0, 1, 2].map(|i| cos * e[i] + sin * across[i] + along * axis[i])
        };
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(turned);
        Self { shift, rotation: [0, 1, 2].map(|row| axes.map(|axis| axis[row])) }
    }

    fn to_room(self, direction: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| dot(row, direction))
    }

    fn to_mold(self, place: [f64; 3]) -> [f64; 3] {
        let from = [0, 1, 2].map(|i| place[i] - self.shift[i]);
        [0, 1, 2].map(|column| (0..3).map(|row| self.rotation[row][column] * from[row]).sum())
    }
}

/// Foot of the perpendicular from the centre of a ball to the mold, and the plane that touches the mold there.
///
/// `lift` moves the mold along its axis. The plane is a place and a quaternion (w, x, y, z) in the room, its z axis
/// the normal out of the material; the contact point is in the frame of the mold, `distance` from the centre.
#[derive(Clone, Debug)]
pub struct TangentPlane {
    mold: Mold,
    pose: Pose,
    /// foot point of the step before, m
    foot: [f64; 2],
}

impl TangentPlane {
    /// A mold somewhere in the room.
    pub fn new(mold: Mold, pose: Pose) -> Self {
        Self { mold, pose, foot: [0.0; 2] }
    }

    /// The surface at the foot point, by Newton's method on the squared distance, from the foot point of the step before.
    fn nearest(&mut self, centre: [f64; 3]) -> Local {
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
fn towards(foot: [f64; 2], here: Local, centre: [f64; 3]) -> [f64; 2] {
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
        let distance = dot([dx, dy, dz], normal);
        [centre[0] - distance * normal[0], centre[1] - distance * normal[1]]
    }
}

/// Shortest rotation from z to a unit vector with positive z, as a quaternion.
fn quaternion(normal: [f64; 3]) -> [f64; 4] {
    let w = (0.5 * (1.0 + normal[2])).max(f64::MIN_POSITIVE).sqrt();
    [w, -0.5 * normal[1] / w, 0.5 * normal[0] / w, 0.0]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
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

    fn reset(&mut self) {
        self.foot = [0.0; 2];
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let &[x, y, z, lift] = inputs else { return };
        let mut centre = self.pose.to_mold([x, y, z]);
        centre[2] -= lift;
        let here = self.nearest(centre);
        let normal = self.pose.to_room(here.normal());
        let contact = [self.foot[0], self.foot[1], here.z];
        let offset = self.pose.to_room([contact[0], contact[1], contact[2] + lift]);
        let distance = dot([0, 1, 2].map(|i| centre[i] - contact[i]), here.normal());
        outputs[..3].copy_from_slice(&[0, 1, 2].map(|i| self.pose.shift[i] + offset[i]));
        outputs[3..7].copy_from_slice(&quaternion(normal));
        outputs[7..10].copy_from_slice(&normal);
        outputs[10..13].copy_from_slice(&contact);
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
            let from = [centre[0], centre[1], centre[2] - 3e-3];
            let away = dot(from, from).sqrt();
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
        let (w, u) = (out[3], [out[4], out[5], out[6]]);
        assert!((w * w + dot(u, u) - 1.0).abs() < 1e-15);
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
        let turned = pose.to_room([0, 1, 2].map(|i| centre[i] + lift[i]));
        let moved = [0, 1, 2].map(|i| turned[i] + pose.shift[i]);
        let out = place(&mut TangentPlane::new(rough(), pose), moved, lift[2]);
        for i in 10..14 {
            assert!((out[i] - still[i]).abs() < 1e-12, "{i}: {} and {}", out[i], still[i]);
        }
        // the plane is as far from the ball as the surface is
        let away = dot([0, 1, 2].map(|i| moved[i] - out[i]), [out[7], out[8], out[9]]);
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
