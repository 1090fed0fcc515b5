//! Edge of a part: two straight lines and the arc that rounds the corner between them.

use nalgebra::Vector3;

use crate::element::{Element, Ports};

type Vector = Vector3<f64>;

/// lines that differ by less are one line, sine of the angle
const STRAIGHT: f64 = 1e-9;

/// Position of a point relative to the edge: `foot`, `tangent` and `outward` are those of the nearest point of the edge.
#[derive(Clone, Copy, Debug)]
pub struct Clearance {
    /// path from the start to the nearest point, m
    pub distance: f64,
    /// distance of the point from the edge along `outward`, m
    pub normal: f64,
    /// and along `tangent x outward` reversed, the side from which the corner turns left, m
    pub across: f64,
    /// direction of travel
    pub tangent: Vector,
    /// away from the inside of the corner
    pub outward: Vector,
}

/// Line, arc, line from `start` over `corner` to `end`; the burr is on the outside of the corner.
///
/// x, y, z of a point -> distance, normal, across, tangent and outward of its nearest point.
#[derive(Clone, Debug)]
pub struct Edge {
    start: Vector,
    /// directions of both lines
    lines: [Vector; 2],
    /// normal of the plane of both lines, about which the arc turns left
    axis: Vector,
    /// lengths of line, arc, line, m
    lengths: [f64; 3],
    radius: f64,
    centre: Vector,
    /// end of the arc
    leave: Vector,
}

impl Edge {
    /// An edge with a corner of `radius` m, or none if the lines are too short for the arc.
    pub fn new(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> Option<Self> {
        let [start, corner, end] = [start, corner, end].map(Vector::from);
        let [first, second] = [corner - start, end - corner];
        let [l1, l2] = [first, second].map(|line| line.norm());
        let lines = [first * (1.0 / l1), second * (1.0 / l2)];
        let turn = lines[0].cross(&lines[1]);
        let angle = turn.norm().atan2(lines[0].dot(&lines[1]));
        // a straight edge lies flat: its outside is on the right
        let axis = if turn.norm() > STRAIGHT { turn * (1.0 / turn.norm()) } else { Vector::z() };
        let taken = radius * (angle / 2.0).tan();
        let lengths = [l1 - taken, radius * angle, l2 - taken];
        let enter = start + lines[0] * lengths[0];
        let leave = corner + lines[1] * taken;
        let centre = enter + axis.cross(&lines[0]) * radius;
        let fits = lengths.iter().all(|&length| length >= 0.0) && lengths.iter().sum::<f64>() > 0.0;
        fits.then_some(Self { start, lines, axis, lengths, radius, centre, leave })
    }

    /// Length of the edge, m.
    pub fn length(&self) -> f64 {
        self.lengths.iter().sum()
    }

    /// The nearest point of the edge.
    pub fn place(&self, point: [f64; 3]) -> Clearance {
        let point = Vector::from(point);
        let [l1, l2, l3] = self.lengths;
        let mut nearest = self.on_line(point, self.start, 0, 0.0, l1);
        let others = [self.on_arc(point), self.on_line(point, self.leave, 1, l1 + l2, l3)];
        for candidate in others {
            if candidate.0 < nearest.0 {
                nearest = candidate;
            }
        }
        nearest.1
    }

    /// distance to a line that starts at `from`, and the nearest point
    fn on_line(&self, point: Vector, from: Vector, line: usize, before: f64, length: f64) -> (f64, Clearance) {
        let tangent = self.lines[line];
        let along = (point - from).dot(&tangent).clamp(0.0, length);
        self.seen_from(point, from + tangent * along, tangent, before + along)
    }

    fn on_arc(&self, point: Vector) -> (f64, Clearance) {
        // angle of the point about the centre, from where the arc begins
        let outward = self.lines[0].cross(&self.axis);
        let from_centre = point - self.centre;
        let turned = from_centre.dot(&self.lines[0]).atan2(from_centre.dot(&outward));
        let angle = turned.clamp(0.0, if self.radius > 0.0 { self.lengths[1] / self.radius } else { 0.0 });
        let (sin, cos) = angle.sin_cos();
        let tangent = self.lines[0] * cos - outward * sin;
        let foot = self.centre + tangent.cross(&self.axis) * self.radius;
        self.seen_from(point, foot, tangent, self.lengths[0] + angle * self.radius)
    }

    fn seen_from(&self, point: Vector, foot: Vector, tangent: Vector, distance: f64) -> (f64, Clearance) {
        let (away, outward) = (point - foot, tangent.cross(&self.axis));
        let (normal, across) = (away.dot(&outward), away.dot(&self.axis));
        (away.norm(), Clearance { distance, normal, across, tangent, outward })
    }
}

impl Element for Edge {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["x", "y", "z"],
            outputs: &["distance", "normal", "across", "tx", "ty", "tz", "nx", "ny", "nz"],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let &[x, y, z] = inputs else { return };
        let Clearance { distance, normal, across, tangent, outward } = self.place([x, y, z]);
        outputs[..3].copy_from_slice(&[distance, normal, across]);
        outputs[3..6].copy_from_slice(tangent.as_slice());
        outputs[6..].copy_from_slice(outward.as_slice());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    /// 120 mm along x, a left turn of 90 degrees with 15 mm, 120 mm along y
    fn square() -> Edge {
        Edge::new([0.0; 3], [0.135, 0.0, 0.0], [0.135, 0.135, 0.0], 0.015).expect("fits")
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12, "{a} instead of {b}");
    }

    #[test]
    fn line_arc_line_has_the_length_of_its_parts() {
        close(square().length(), 0.24 + 0.015 * PI / 2.0);
    }

    #[test]
    fn a_point_beside_each_part_is_seen_from_its_foot() {
        let edge = square();
        // 1 mm to the right of the first line, 2 mm above
        let place = edge.place([0.05, -1e-3, 2e-3]);
        for (value, wanted) in [(place.distance, 0.05), (place.normal, 1e-3), (place.across, 2e-3)] {
            close(value, wanted);
        }
        // inside of the middle of the arc, whose centre is (0.12, 0.015)
        let out = 0.014 * FRAC_1_SQRT_2;
        let place = edge.place([0.12 + out, 0.015 - out, 0.0]);
        close(place.distance, 0.12 + 0.015 * PI / 4.0);
        close(place.normal, -1e-3);
        close(place.tangent[0], FRAC_1_SQRT_2);
        close(place.outward[1], -FRAC_1_SQRT_2);
        // left of the second line
        let place = edge.place([0.134, 0.1, 0.0]);
        close(place.distance, 0.12 + 0.015 * PI / 2.0 + 0.085);
        close(place.normal, -1e-3);
    }

    #[test]
    fn before_the_start_and_beyond_the_end_the_ends_are_nearest() {
        let edge = square();
        close(edge.place([-0.02, 1e-3, 0.0]).distance, 0.0);
        close(edge.place([0.135, 0.2, 0.0]).distance, edge.length());
    }

    #[test]
    fn places_follow_each_other_without_a_jump() {
        // a tool 0.3 mm outside, in a corner that rises
        let edge = Edge::new([0.0; 3], [0.1, 0.0, 0.04], [0.1, 0.1, 0.0], 0.02).expect("fits");
        let mut before = edge.place([0.0; 3]);
        for k in 1..=2000 {
            let t = f64::from(k) / 2000.0;
            let place = edge.place([
                0.1 * (2.0 * t).min(1.0),
                0.1 * (2.0 * t - 1.0).max(0.0),
                0.04 * (2.0 * t).min(2.0 - 2.0 * t),
            ]);
            assert!((place.distance - before.distance).abs() < 2.5e-4, "at {t}");
            assert!((place.normal - before.normal).abs() < 1.5e-4, "at {t}");
            assert!(place.across.abs() < 1e-12);
            before = place;
        }
    }

    #[test]
    fn a_right_turn_has_its_outside_on_the_left_and_a_straight_edge_on_the_right() {
        let right = Edge::new([0.0; 3], [0.1, 0.0, 0.0], [0.1, -0.1, 0.0], 0.01).expect("fits");
        close(right.place([0.05, 1e-3, 0.0]).normal, 1e-3);
        let straight = Edge::new([0.0; 3], [0.1, 0.0, 0.0], [0.2, 0.0, 0.0], 0.01).expect("fits");
        close(straight.place([0.15, 1e-3, 0.0]).normal, -1e-3);
        close(straight.length(), 0.2);
    }

    #[test]
    fn a_sharp_corner_is_an_edge_and_one_too_round_is_none() {
        let sharp = Edge::new([0.0; 3], [0.1, 0.0, 0.0], [0.1, 0.1, 0.0], 0.0).expect("fits");
        close(sharp.length(), 0.2);
        assert!(sharp.place([0.11, -0.01, 0.0]).normal.is_finite());
        assert!(Edge::new([0.0; 3], [0.1, 0.0, 0.0], [0.1, 0.1, 0.0], 0.11).is_none());
        assert!(Edge::new([0.0; 3], [0.0; 3], [0.0; 3], 0.0).is_none());
    }
}
