//! Geometry of one block of the path: a line or an arc between two path point, with the tool turning along.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::fingerprint::Fingerprint;

/// Position or direction in the base frame.
pub type Vector = Vector3<f64>;

/// Shortest block, m.
const LENGTH_MIN: f64 = 1e-4;
/// Largest difference of the radii at both ends of an arc by its center, m.
const RADIUS_TOLERANCE: f64 = 1e-6;
/// Sine below which two directions are parallel.
const PARALLEL: f64 = 1e-6;

/// Tip of the tool and direction in which the tool points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Tip, m.
    pub tip: Vector,
    /// Unit vector from the wrist to the tip.
    pub axis: Vector,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
enum Curve {
    Line {
        from: Vector,
        direction: Vector,
    },
    /// center + radius (u cos + v sin)
    Arc {
        centre: Vector,
        radius: f64,
        u: Vector,
        v: Vector,
    },
}

/// The curve from one path point to the next.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Block {
    curve: Curve,
    /// Length, m.
    pub length: f64,
    axes: [Vector; 2],
    /// programmed positions: both ends, and the third one of an arc
    programmed: [Vector; 3],
}

impl Block {
    /// Straight block.
    ///
    /// # Errors
    /// Message for the user.
    pub fn line(from: &Pose, to: &Pose) -> Result<Self, String> {
        let chord = to.tip - from.tip;
        let length = chord.norm();
        if length < LENGTH_MIN {
            return Err(format!("line: length is `{length} m`, must be at least `{LENGTH_MIN} m`"));
        }
        Self::new(Curve::Line { from: from.tip, direction: chord / length }, length, from, to.tip, to)
    }

    /// Arc through the position `via`.
    ///
    /// # Errors
    /// Message for the user.
    pub fn arc_via(from: &Pose, via: Vector, to: &Pose) -> Result<Self, String> {
        let (a, b) = (via - from.tip, to.tip - from.tip);
        let normal = a.cross(&b);
        let (square, product) = (normal.norm_squared(), a.norm() * b.norm());
        if square.sqrt() <= PARALLEL * product.max(LENGTH_MIN * LENGTH_MIN) {
            return Err("arc: `via_m` is on the line through both ends, or at one of them".to_owned());
        }
        let offset = (b * a.norm_squared() - a * b.norm_squared()).cross(&normal) / (2.0 * square);
        Self::arc(from, from.tip + offset, normal / square.sqrt(), via, to)
    }

    /// Arc about `centre`, the short way round.
    ///
    /// # Errors
    /// Message for the user.
    pub fn arc_about(from: &Pose, centre: Vector, to: &Pose) -> Result<Self, String> {
        let (a, b) = (from.tip - centre, to.tip - centre);
        let difference = (a.norm() - b.norm()).abs();
        if difference > RADIUS_TOLERANCE {
            return Err(format!("arc: radii at both ends differ by `{difference} m`, limit `{RADIUS_TOLERANCE} m`"));
        }
        let normal = a.cross(&b);
        if normal.norm() <= PARALLEL * a.norm() * b.norm() {
            return Err("arc: half or full circles about `centre_m` have no plane; use `via_m`".to_owned());
        }
        Self::arc(from, centre, normal.normalize(), centre, to)
    }

    fn arc(from: &Pose, centre: Vector, normal: Vector, programmed: Vector, to: &Pose) -> Result<Self, String> {
        let (a, b) = (from.tip - centre, to.tip - centre);
        let radius = a.norm();
        let u = a / radius;
        let v = normal.cross(&u);
        let angle = b.dot(&v).atan2(b.dot(&u)).rem_euclid(std::f64::consts::TAU);
        let length = radius * angle;
        if length < LENGTH_MIN {
            return Err(format!("arc: length is `{length} m`, must be at least `{LENGTH_MIN} m`"));
        }
        Self::new(Curve::Arc { centre, radius, u, v }, length, from, programmed, to)
    }

    fn new(curve: Curve, length: f64, from: &Pose, third: Vector, to: &Pose) -> Result<Self, String> {
        if from.axis.dot(&to.axis) < -1.0 + PARALLEL {
            return Err("`axis` rotates by 180 degrees, the direction is not defined, must be less".to_owned());
        }
        Ok(Self { curve, length, axes: [from.axis, to.axis], programmed: [from.tip, third, to.tip] })
    }

    /// Pose at the distance `s` (m) from the beginning of the block.
    pub fn at(&self, s: f64) -> Pose {
        let tip = match &self.curve {
            Curve::Line { from, direction } => from + direction * s,
            Curve::Arc { centre, radius, u, v } => {
                let (sin, cos) = (s / radius).sin_cos();
                centre + (u * cos + v * sin) * *radius
            }
        };
        Pose { tip, axis: self.axis(s / self.length) }
    }

    /// Unit tangent at the distance `s` (m).
    pub fn tangent(&self, s: f64) -> Vector {
        match &self.curve {
            Curve::Line { direction, .. } => *direction,
            Curve::Arc { radius, u, v, .. } => {
                let (sin, cos) = (s / radius).sin_cos();
                v * cos - u * sin
            }
        }
    }

    /// Adds the programmed values to a fingerprint; nothing that is computed with functions that differ between machines.
    pub fn fingerprint(&self, print: &mut Fingerprint) {
        let kind = match self.curve {
            Curve::Line { .. } => 1.0,
            Curve::Arc { .. } => 2.0,
        };
        print.add(kind);
        self.programmed.iter().chain(&self.axes).flatten().for_each(|value| print.add(*value));
    }

    /// Tool direction: both ends joined on a great circle.
    fn axis(&self, fraction: f64) -> Vector {
        let [from, to] = self.axes;
        let (sin, cos) = (from.cross(&to).norm(), from.dot(&to));
        if sin < PARALLEL {
            return from;
        }
        let angle = sin.atan2(cos);
        (from * ((1.0 - fraction) * angle).sin() + to * (fraction * angle).sin()) / sin
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    const DOWN: Vector = Vector::new(0.0, 0.0, -1.0);

    fn pose(x: f64, y: f64, z: f64) -> Pose {
        Pose { tip: Vector::new(x, y, z), axis: DOWN }
    }

    fn close(a: Vector, b: Vector) -> bool {
        (a - b).norm() < 1e-12
    }

    #[test]
    fn a_line_is_the_shortest_path() {
        let block = Block::line(&pose(1.0, 0.0, 0.0), &pose(1.0, 0.3, 0.4)).unwrap();
        assert!((block.length - 0.5).abs() < 1e-15);
        assert!(close(block.at(0.25).tip, Vector::new(1.0, 0.15, 0.2)));
        assert!(close(block.tangent(0.1), Vector::new(0.0, 0.6, 0.8)));
    }

    #[test]
    fn an_arc_by_center_takes_the_short_side() {
        let block = Block::arc_about(&pose(1.0, 0.0, 0.0), Vector::zeros(), &pose(0.0, -1.0, 0.0)).unwrap();
        assert!((block.length - 0.5 * PI).abs() < 1e-12);
        let middle = block.at(0.25 * PI).tip;
        assert!(close(middle, Vector::new(FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0)));
        assert!(close(block.at(block.length).tip, Vector::new(0.0, -1.0, 0.0)));
    }

    #[test]
    fn an_arc_by_via_passes_through_it_also_on_the_long_side() {
        let (from, to) = (pose(1.0, 0.0, 0.2), pose(0.0, -1.0, 0.2));
        let via = Vector::new(-FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.2);
        let block = Block::arc_via(&from, via, &to).unwrap();
        assert!((block.length - 1.5 * PI).abs() < 1e-12, "{}", block.length);
        assert!(close(block.at(0.75 * PI).tip, via));
        assert!(close(block.at(block.length).tip, to.tip));
    }

    #[test]
    fn a_fillet_of_half_a_millimetre_is_an_arc() {
        let (from, to) = (pose(0.7005, 0.0, 0.0), pose(0.7, 0.0005, 0.0));
        let centre = Vector::new(0.7, 0.0, 0.0);
        let via = centre + Vector::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0) * 5e-4;
        for block in [Block::arc_via(&from, via, &to).unwrap(), Block::arc_about(&from, centre, &to).unwrap()] {
            assert!((block.length - 2.5e-4 * PI).abs() < 1e-9, "{}", block.length);
            assert!((block.at(0.5 * block.length).tip - via).norm() < 1e-9);
        }
    }

    #[test]
    fn shapes_are_taken_and_rejected_at_their_limits() {
        let here = pose(1.0, 0.0, 0.0);
        let line = |length: f64| Block::line(&here, &pose(1.0, length, 0.0));
        assert!(line(1.0001e-4).is_ok() && line(0.9999e-4).is_err());
        let arc = |angle: f64| Block::arc_about(&here, Vector::zeros(), &pose(angle.cos(), angle.sin(), 0.0));
        assert!(arc(1.0001e-4).is_ok() && arc(0.9999e-4).is_err());
        // just this length, of an eighth of a radian
        let [from, to] = [0.0f64, 0.125].map(|angle| pose(8e-4 * angle.cos(), 8e-4 * angle.sin(), 0.0));
        assert_eq!(Block::arc_about(&from, Vector::zeros(), &to).map(|block| block.length), Ok(1e-4));
        let other = |radius: f64| Block::arc_about(&here, Vector::zeros(), &pose(0.0, radius, 0.0));
        assert!(other(1.0 + 0.9e-6).is_ok() && other(1.0 - 0.9e-6).is_ok());
        assert!(other(1.0 + 1.1e-6).is_err() && other(1.0 - 1.1e-6).is_err());
        // the sine of the angle between both chords
        let via = |height: f64| Block::arc_via(&here, Vector::new(1.5, height, 0.0), &pose(2.0, 0.0, 0.0));
        assert!(via(0.6e-6).is_ok() && via(0.4e-6).is_err());
    }

    #[test]
    fn a_block_has_the_fingerprint_of_its_shape_and_its_tool() {
        let print = |block: Block| {
            let mut print = Fingerprint::default();
            block.fingerprint(&mut print);
            print.value()
        };
        let (from, to) = (pose(1.0, 0.0, 0.0), pose(0.0, 1.0, 0.0));
        let tilted = Pose { axis: Vector::new(0.6, 0.0, -0.8), ..to };
        let via = |x: f64| Block::arc_via(&from, Vector::new(x, x, 0.0), &to).unwrap();
        let blocks = [
            Block::line(&from, &to).unwrap(),
            Block::line(&from, &tilted).unwrap(),
            Block::arc_about(&from, Vector::zeros(), &to).unwrap(),
            via(FRAC_1_SQRT_2),
            via(0.8),
        ];
        let prints = blocks.map(print);
        assert!((0..5).all(|i| (0..i).all(|k| prints[i] != prints[k])), "{prints:?}");
        assert_eq!(print(via(0.8)), prints[4]);
    }

    #[test]
    fn the_tangent_is_the_derivative_and_the_tool_turns_evenly() {
        let tilted = Pose { axis: Vector::new(0.6, 0.0, -0.8), ..pose(0.0, 1.0, 0.5) };
        let block = Block::arc_via(&pose(1.0, 0.0, 0.0), Vector::new(0.8, 0.6, 0.3), &tilted).unwrap();
        let angle = (0.8_f64).acos();
        for k in 1..20 {
            let (s, h) = (0.05 * f64::from(k) * block.length, 1e-6);
            let difference = (block.at(s + h).tip - block.at(s - h).tip) / (2.0 * h);
            assert!((difference - block.tangent(s)).norm() < 1e-8);
            let axis = block.at(s).axis;
            assert!((axis.norm() - 1.0).abs() < 1e-12);
            assert!((axis.dot(&DOWN).acos() - angle * s / block.length).abs() < 1e-9);
        }
    }

    #[test]
    fn what_has_no_shape_is_rejected_with_numbers() {
        let here = pose(1.0, 0.0, 0.0);
        let there = pose(-1.0, 0.0, 0.0);
        let up = Pose { axis: -DOWN, ..there };
        let cases = [
            (Block::line(&here, &here), "length is `0 m`"),
            (Block::arc_about(&here, Vector::zeros(), &there), "half or full circles"),
            (Block::arc_about(&here, Vector::new(0.1, 0.0, 0.0), &there), "differ by `0.2"),
            (Block::arc_via(&here, Vector::zeros(), &there), "on the line"),
            (Block::arc_via(&here, Vector::new(0.0, 1.0, 0.0), &here), "on the line"),
            (Block::line(&here, &up), "180 degrees"),
        ];
        for (block, part) in cases {
            let message = block.unwrap_err();
            assert!(message.contains(part), "{message}");
        }
    }
}
