//! Feed along the path: acceleration limits, a stop curve that ends on the sample, and a moving average against jerk.

use control_blocks::ramp_between;
use serde::{Deserialize, Serialize};

use crate::interface::Feed;
use crate::path::programmed_path::ProgrammedPath;

/// Most samples of the moving average.
pub const SMOOTHING_MAX: usize = 32;

/// Where the feed is and how fast it goes until the next sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Distance from the start of the path (L), m.
    pub distance: f64,
    /// Speed until the next sample (V), m/s.
    pub speed: f64,
}

/// Distances that differ by less are one, m.
const ROUNDING: f64 = 1e-10;

/// The feed between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FeedPlanner {
    /// before smoothing
    planned: Point,
    /// smoothed
    distance: f64,
    speeds: [f64; SMOOTHING_MAX],
    next: usize,
    /// at rest at a stop until the moving average is, too
    waits: bool,
}

impl FeedPlanner {
    /// At rest at the start of the path.
    pub const START: Self = Self {
        planned: Point { distance: 0.0, speed: 0.0 },
        distance: 0.0,
        speeds: [0.0; SMOOTHING_MAX],
        next: 0,
        waits: false,
    };

    /// This sample's point, during the motion to the speed `target` (m/s); `dt` is the sample period, s.
    pub fn step(&mut self, limits: &Feed, path: &ProgrammedPath, target: f64, dt: f64) -> Point {
        let speed = self.plan(limits.acceleration, path, if self.waits { 0.0 } else { target }, dt);
        let point = Point { distance: self.distance, speed: self.average(speed, limits.smoothing as usize) };
        self.distance += point.speed * dt;
        let lag = self.planned.distance - self.distance;
        if lag.abs() < ROUNDING {
            self.distance = self.planned.distance;
            self.waits = false;
        }
        point
    }

    /// Speed before smoothing (m/s) of this sample; moves the planned point.
    fn plan(&mut self, acceleration: f64, path: &ProgrammedPath, target: f64, dt: f64) -> f64 {
        let stop = path.next_stop(self.planned.distance);
        let speed = limited(self.planned.speed, target, stop - self.planned.distance, acceleration, dt);
        let distance = self.planned.distance + speed * dt;
        let arrives = speed > 0.0 && stop - distance < ROUNDING;
        self.waits |= arrives;
        self.planned = if arrives { Point { distance: stop, speed: 0.0 } } else { Point { distance, speed } };
        speed
    }

    /// Mean of the last `count` speeds, m/s.
    fn average(&mut self, speed: f64, count: usize) -> f64 {
        self.speeds[self.next] = speed;
        self.next = (self.next + 1) % count;
        self.speeds[..count].iter().sum::<f64>() / count as f64
    }
}

/// Next speed (m/s): towards `target`, within the acceleration, and never too fast to stop in `remaining` m.
fn limited(speed: f64, target: f64, remaining: f64, acceleration: f64, dt: f64) -> f64 {
    let change = acceleration * dt;
    // what remains, in the way of one sample at one change of speed: n (n + 1) / 2 for the speeds n, n - 1, ..., 1
    let distance = remaining / (change * dt);
    let n = ((0.5 * (1.0 + 8.0 * distance).sqrt()) - 0.5).floor();
    let curve = change * (0.5 * n + distance / (n + 1.0));
    ramp_between(speed, target, change, change).min(curve).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::geometry::{Block, Pose, Vector};

    const DT: f64 = 0.01;

    fn path(lengths: &[f64]) -> ProgrammedPath {
        let pose = |x: f64, y: f64| Pose { tip: Vector::new(x, y, 0.0), axis: Vector::new(0.0, 0.0, -1.0) };
        let mut blocks = Vec::new();
        let mut from = pose(0.5, 0.0);
        // corners of 90 degrees
        for (i, length) in lengths.iter().enumerate() {
            let distance = if i % 2 == 0 { Vector::x() } else { Vector::y() };
            let to = Pose { tip: from.tip + distance * *length, ..from };
            blocks.push(Block::line(&from, &to).unwrap());
            from = to;
        }
        ProgrammedPath::new(blocks, 0.1, false, 0.1).unwrap()
    }

    fn run(path: &ProgrammedPath, limits: &Feed, target: impl Fn(usize) -> f64) -> Vec<Point> {
        let mut feed = FeedPlanner::START;
        let mut points = Vec::new();
        while points.last().is_none_or(|point: &Point| point.distance < path.length()) && points.len() < 100_000 {
            points.push(feed.step(limits, path, target(points.len()), DT));
        }
        points
    }

    fn keeps_its_limits(points: &[Point], acceleration: f64) {
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            assert!((b.distance - a.distance - a.speed * DT).abs() < 1e-9);
            assert!((b.speed - a.speed).abs() <= acceleration * DT * (1.0 + 1e-9), "{a:?} {b:?}");
        }
    }

    #[test]
    fn ends_exactly_on_the_end_at_rest_for_every_length_and_speed() {
        let limits = Feed::START;
        for k in 0..200 {
            let path = path(&[0.05 + 0.000_37 * f64::from(k)]);
            let points = run(&path, &limits, |_| 0.02 + 0.001 * f64::from(k));
            let end = points.last().unwrap();
            assert_eq!((end.distance, end.speed), (path.length(), 0.0));
            keeps_its_limits(&points, limits.acceleration);
        }
    }

    #[test]
    fn follows_a_target_that_jumps() {
        let limits = Feed::START;
        let points = run(&path(&[0.3]), &limits, |k| if k % 60 < 30 { 0.1 } else { 0.01 });
        keeps_its_limits(&points, limits.acceleration);
        assert!(points.iter().any(|point| point.speed == 0.01) && points.iter().any(|point| point.speed == 0.1));
    }

    #[test]
    fn the_feed_and_the_smoothed_feed_rest_at_corners() {
        for smoothing in [1, 12] {
            let limits = Feed { smoothing, ..Feed::START };
            let path = path(&[0.1, 0.05, 0.07]);
            let points = run(&path, &limits, |_| 0.1);
            keeps_its_limits(&points, limits.acceleration);
            for corner in [0.1, 0.15] {
                let at = points.iter().position(|point| (point.distance - corner).abs() < 1e-9).unwrap();
                // the sample at the corner starts from rest
                assert!(points[at].speed <= limits.acceleration * DT * (1.0 + 1e-9));
            }
        }
    }

    #[test]
    fn a_standing_feed_stays_and_goes_on() {
        let path = path(&[0.1]);
        let points = run(&path, &Feed::START, |k| if (40..80).contains(&k) { 0.0 } else { 0.1 });
        assert!(points[70].speed == 0.0 && points[79].distance == points[70].distance);
        assert_eq!(points.last().unwrap().distance, path.length());
    }
}
