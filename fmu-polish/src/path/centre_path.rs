//! The path of the ball center: where it is, how it points and how fast it may go at an arc length.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::cl_data::Point;
use super::feed::CREEP;
use crate::interface::{ErrorOutput, Parameters};

/// Smaller turns than this never slow the feed, rad.
const ROTATION_MIN: f64 = 1e-9;

/// A point of the path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Knot {
    /// ball center, m
    centre: Vector3<f64>,
    /// unit normal out of the material
    normal: Vector3<f64>,
    /// arc length of the contact points up to here, m
    s: f64,
    /// fastest feed here that can still brake for all that comes, m/s
    feed_max: f64,
}

/// The path as a polyline of ball centers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CentrePath {
    radius: f64,
    knots: Vec<Knot>,
}

/// A position on the path; by default its start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PathPosition {
    /// Arc length of the contact point, m.
    pub s: f64,
    /// number of the knot before
    knot: usize,
}

/// The path at one position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Desired ball center, m.
    pub centre: Vector3<f64>,
    /// Contact point, m.
    pub contact: Vector3<f64>,
    /// Unit normal out of the material, o_d.
    pub normal: Vector3<f64>,
    /// Unit tangent of the path of the ball center, orthogonal to the normal.
    pub tangent: Vector3<f64>,
    /// Travel of the ball center over travel of the contact point.
    pub ratio: f64,
    /// Fastest feed, m/s.
    pub feed_max: f64,
}

impl Frame {
    /// The parts of the position error `offset` = x_d - x (m).
    pub fn error(&self, offset: &Vector3<f64>) -> ErrorOutput {
        ErrorOutput {
            tangential: offset.dot(&self.tangent),
            lateral: offset.dot(&self.normal.cross(&self.tangent)),
            normal: offset.dot(&self.normal),
        }
    }
}

impl ErrorOutput {
    /// Distance from the normal, m.
    pub fn in_plane(&self) -> f64 {
        self.tangential.hypot(self.lateral)
    }
}

impl CentrePath {
    /// The path of a ball that touches the checked `points`.
    pub fn new(p: &Parameters, points: &[Point]) -> Self {
        let radius = p.tool_radius;
        let mut knots: Vec<Knot> = Vec::with_capacity(points.len());
        let mut s = 0.0;
        for (i, point) in points.iter().enumerate() {
            if i > 0 {
                s += (point.contact - points[i - 1].contact).norm();
            }
            let feed_max = if p.feed.uses_file() { point.feed } else { f64::MAX };
            knots.push(Knot { centre: point.contact + radius * point.normal, normal: point.normal, s, feed_max });
        }
        limit_by_curvature(&mut knots, p.feed.turn_rate_max);
        limit_by_braking(&mut knots, p.feed.acceleration);
        Self { radius, knots }
    }

    /// Its length along the contact points, m.
    pub fn length(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.s)
    }

    /// Planned time along it without overrides, s.
    pub fn time(&self, p: &Parameters) -> f64 {
        let configured = if p.feed.uses_file() { f64::MAX } else { p.feed.velocity };
        let piece = |pair: &[Knot]| {
            let fastest = 0.5 * (pair[0].feed_max + pair[1].feed_max);
            (pair[1].s - pair[0].s) / fastest.min(configured).max(CREEP)
        };
        let cruise: f64 = self.knots.windows(2).map(piece).sum();
        cruise + p.feed.velocity / p.feed.acceleration
    }

    /// The position at the arc length `s` (m), looked for from `path_position` on, at most the end.
    pub fn seek(&self, path_position: PathPosition, s: f64) -> PathPosition {
        let s = s.clamp(0.0, self.length());
        let mut knot = path_position.knot.min(self.knots.len() - 2);
        while knot > 0 && self.knots[knot].s > s {
            knot -= 1;
        }
        while knot + 2 < self.knots.len() && self.knots[knot + 1].s < s {
            knot += 1;
        }
        PathPosition { s, knot }
    }

    /// The path at `path_position`.
    pub fn frame(&self, path_position: PathPosition) -> Frame {
        let i = path_position.knot.min(self.knots.len() - 2);
        let (a, b) = (&self.knots[i], &self.knots[i + 1]);
        let along = b.s - a.s;
        let u = ((path_position.s - a.s) / along).clamp(0.0, 1.0);
        let centre = a.centre.lerp(&b.centre, u);
        let normal = a.normal.lerp(&b.normal, u).normalize();
        let chord = self.direction(i).lerp(&self.direction(i + 1), u);
        let tangent = (chord - normal * normal.dot(&chord)).normalize();
        Frame {
            centre,
            contact: centre - self.radius * normal,
            normal,
            tangent,
            ratio: (b.centre - a.centre).norm() / along,
            // v^2 is linear in s while braking
            feed_max: (a.feed_max.powi(2) * (1.0 - u) + b.feed_max.powi(2) * u).sqrt(),
        }
    }

    /// Direction of motion at knot `i`: from its previous to its next neighbor.
    fn direction(&self, i: usize) -> Vector3<f64> {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(self.knots.len() - 1));
        (self.knots[after].centre - self.knots[before].centre).normalize()
    }
}

/// The direction of motion turns at most with `rate` rad/s.
fn limit_by_curvature(knots: &mut [Knot], rate: f64) {
    for i in 1..knots.len() - 1 {
        let (before, after) = (knots[i].centre - knots[i - 1].centre, knots[i + 1].centre - knots[i].centre);
        let angle = before.angle(&after);
        let distance = 0.5 * (knots[i + 1].s - knots[i - 1].s);
        knots[i].feed_max = knots[i].feed_max.min(rate * distance / angle.max(ROTATION_MIN));
    }
    knots[0].feed_max = knots[0].feed_max.min(knots[1].feed_max);
}

/// From every knot the feed can fall with `acceleration` (m/s2) to what comes; at the end it is 0.
fn limit_by_braking(knots: &mut [Knot], acceleration: f64) {
    let last = knots.len() - 1;
    knots[last].feed_max = 0.0;
    for i in (0..last).rev() {
        let gain = 2.0 * acceleration * (knots[i + 1].s - knots[i].s);
        knots[i].feed_max = knots[i].feed_max.min((knots[i + 1].feed_max.powi(2) + gain).sqrt());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::FeedSource;

    const P: Parameters = Parameters::START;
    const RADIUS: f64 = 1e-3;

    /// A whole circle on a plane, 10 um from point to point.
    fn circle() -> Vec<Point> {
        let at = |a: f64| Vector3::new(RADIUS * a.cos(), RADIUS * a.sin(), 0.0);
        let point = |k: u32| Point { contact: at(0.01 * f64::from(k)), normal: Vector3::z(), feed: 1.0, line: 0 };
        (0..628).map(point).collect()
    }

    #[test]
    fn in_plane_are_the_two_parts_across_the_normal() {
        let error = ErrorOutput { tangential: 3e-6, lateral: -4e-6, normal: 1.0 };
        assert!((error.in_plane() - 5e-6).abs() < 1e-18);
    }

    #[test]
    fn the_tangent_is_in_a_bent_surface_from_end_to_end() {
        let up = |k: u32| Vector3::new((0.05 * f64::from(k)).sin(), 0.0, (0.05 * f64::from(k)).cos());
        let point = |k: u32| Point { contact: RADIUS * up(k), normal: up(k), feed: 1.0, line: 0 };
        let path = CentrePath::new(&P, &(0..20).map(point).collect::<Vec<_>>());
        for k in 0..=100 {
            let frame = path.frame(path.seek(PathPosition::default(), 0.01 * f64::from(k) * path.length()));
            assert!(frame.tangent.dot(&frame.normal).abs() < 1e-12 && frame.tangent.x > 0.0, "{k}: {frame:?}");
        }
    }

    #[test]
    fn the_feed_keeps_the_turn_rate_and_can_always_brake() {
        let mut p = P;
        (p.feed.turn_rate_max, p.feed.acceleration) = (2.0, 0.05);
        let path = CentrePath::new(&p, &circle());
        let middle = path.frame(path.seek(PathPosition::default(), 0.5 * path.length()));
        assert!((middle.feed_max / (2.0 * RADIUS) - 1.0).abs() < 1e-3, "{}", middle.feed_max);
        p.feed.turn_rate_max = 1e3;
        let path = CentrePath::new(&p, &circle());
        for left in [0.0, 1e-4, 1e-3, 3e-3] {
            let here = path.frame(path.seek(PathPosition::default(), path.length() - left));
            assert!((here.feed_max - (2.0 * 0.05 * left).sqrt()).abs() < 1e-6, "{left}: {}", here.feed_max);
        }
    }

    #[test]
    fn speeding_up_and_braking_are_planned_exactly_on_a_straight_path() {
        // 5 mm at 2 mm/s with 2 mm/s2, of which braking takes the last 1 mm: 2 s, 1 s, and 1 s more for the start
        let at = |x: f64| Point { contact: Vector3::new(x, 0.0, 0.0), normal: Vector3::z(), feed: 2e-3, line: 0 };
        let points: Vec<Point> = (0..=50).map(|k| at(1e-4 * f64::from(k))).collect();
        for source in [FeedSource::Parameter, FeedSource::File] {
            let mut p = P;
            (p.feed.source, p.feed.velocity, p.feed.acceleration) = (source, 2e-3, 2e-3);
            let path = CentrePath::new(&p, &points);
            assert!((path.time(&p) - 4.0).abs() < 1e-6, "{source:?}: {}", path.time(&p));
        }
    }

    #[test]
    fn the_planned_time_is_way_over_feed_and_what_braking_costs() {
        let path = CentrePath::new(&P, &circle());
        // v / a more: speeding up and braking take half of it each, and the way of both is counted
        let expected = path.length() / P.feed.velocity + 1.5 * P.feed.velocity / P.feed.acceleration;
        assert!((path.time(&P) / expected - 1.0).abs() < 0.02, "{} {expected}", path.time(&P));
    }
}
