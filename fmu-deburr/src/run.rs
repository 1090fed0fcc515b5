//! One run along the path: rest, feed, rest; the feed is known some samples before the reference follows it.

use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, PathOutput};
use crate::learning::lookup::PatternLookup;
use crate::learning::pattern::Pattern;
use crate::path::feed::{FeedPlanner, Point};
use crate::path::kinematics::Joints;
use crate::path::programmed_path::ProgrammedPath;

/// Most samples by which the feed is known in advance.
pub const PREVIEW_MAX: usize = 8;

/// A run between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    feed: FeedPlanner,
    /// newest first
    ahead: [Point; PREVIEW_MAX + 1],
    /// whole samples by which the feed is known in advance, and those that the lookup of each axis wants
    preview: usize,
    requested: Joints,
    /// samples since the run began
    time: usize,
    /// rest before the start, samples
    rest: usize,
    /// samples since the feed came to the end
    beyond: usize,
    /// samples since the reference came to the end
    left: usize,
    /// Full laps of a cyclic path.
    pub laps: usize,
}

impl Parameters {
    /// By how many samples the feed is known in advance: `expert.lookup.preview` beyond `io_delay`, and what a drive is
    /// later (s) than the nominal one.
    fn preview(&self, later: f64) -> f64 {
        ((self.lookup.preview + later) / self.sample_period + f64::from(self.io_delay)).clamp(0.0, PREVIEW_MAX as f64)
    }
}

impl Run {
    /// Before the first sample; each drive is `later` than the nominal one, s.
    pub fn new(p: &Parameters, path: &ProgrammedPath, later: &Joints) -> Self {
        let requested = later.map(|later| p.preview(later));
        let preview = requested.into_iter().fold(0.0, f64::max).ceil() as usize;
        let rest = if path.cyclic { preview } else { p.learn.lead_in as usize };
        let ahead = [Point::default(); PREVIEW_MAX + 1];
        Self { feed: FeedPlanner::START, ahead, preview, requested, time: 0, rest, beyond: 0, left: 0, laps: 0 }
    }

    /// One sample with the desired speed (m/s); false after the last one.
    pub fn step(&mut self, p: &Parameters, path: &ProgrammedPath, target: f64) -> bool {
        let before = self.point();
        if self.time + self.preview >= self.rest {
            self.advance(p, path, target);
        }
        self.time += 1;
        let now = self.point();
        let length = path.length();
        self.beyond += usize::from(self.ahead[0].distance >= length);
        self.left += usize::from(now.distance >= length);
        if now.distance < before.distance {
            self.laps += 1;
        }
        path.cyclic || self.left <= p.learn.lead_out as usize
    }

    fn advance(&mut self, p: &Parameters, path: &ProgrammedPath, target: f64) {
        let mut point = self.feed.step(&p.feed, path, target, p.sample_period);
        if path.cyclic && point.distance >= path.length() {
            self.feed = FeedPlanner::START;
            point = self.feed.step(&p.feed, path, target, p.sample_period);
        }
        self.ahead.copy_within(0..PREVIEW_MAX, 1);
        self.ahead[0] = point;
    }

    /// Where the reference is, and its speed until the next sample.
    pub fn point(&self) -> Point {
        self.ahead[self.preview]
    }

    /// Outputs of the path; before the run the reference is at the start of the path.
    pub fn report(&self, path: &ProgrammedPath, runs: bool, done: bool) -> PathOutput {
        let Point { distance, speed } = if runs { self.point() } else { Point::default() };
        let location = path.locate(distance);
        PathOutput {
            distance,
            speed,
            block: location.block as i32 + 1,
            block_distance: location.distance,
            length: path.length(),
            laps: self.laps as i32,
            done,
            tip: path.at(distance).tip.into(),
        }
    }

    /// Speed of the feed, m/s.
    pub fn speed(&self) -> f64 {
        self.ahead[0].speed
    }

    /// Whether the reference is in the second half of its rest after the path.
    pub fn rests(&self, p: &Parameters) -> bool {
        2 * self.left > p.learn.lead_out as usize
    }

    /// Whether neither feed nor reference move.
    pub fn stopped(&self) -> bool {
        self.ahead[..=self.preview].iter().all(|point| point.speed == 0.0)
    }

    /// Number of the sample in a pattern that was planned for this run; none before it begins.
    pub fn index(&self, pattern: &Pattern) -> Option<usize> {
        // samples of the pattern begin with its rest
        let index = (self.time - 1).checked_sub(self.rest - pattern.lead_in)?;
        Some(if pattern.cyclic { index % pattern.len() } else { index.min(pattern.len() - 1) })
    }

    /// The feed at the required preview, between two samples, and this preview.
    fn previewed(&self, requested: f64) -> (Point, f64) {
        let late = self.preview as f64 - requested;
        let whole = late.floor();
        let (newest, fraction) = (self.ahead[whole as usize], late - whole);
        if fraction == 0.0 {
            return (newest, requested);
        }
        let before = self.ahead[whole as usize + 1];
        // a new lap begins between both
        if newest.distance < before.distance {
            return (newest, self.preview as f64 - whole);
        }
        let mix = |a: f64, b: f64| a + fraction * (b - a);
        let point = Point { distance: mix(newest.distance, before.distance), speed: mix(newest.speed, before.speed) };
        (point, requested)
    }

    /// Compensation in pulses from patterns at other speeds, the fastest first; not rounded.
    pub fn compensation(&self, p: &Parameters, path: &ProgrammedPath, patterns: &[Pattern]) -> Joints {
        match patterns.first() {
            // at rest the time counts, not the distance
            Some(fastest) if !path.cyclic && self.time + self.preview <= self.rest + 1 => {
                fastest.compensation(self.time as isize - 1)
            }
            Some(fastest) if !path.cyclic && self.beyond > 0 => {
                let end = fastest.lead_in + fastest.run + self.beyond - 1;
                fastest.compensation(end as isize - self.preview as isize)
            }
            _ => self.look_up(p, path, patterns),
        }
    }

    /// Eq. 2 to 4 for each axis, where and when it wants them.
    fn look_up(&self, p: &Parameters, path: &ProgrammedPath, patterns: &[Pattern]) -> Joints {
        let nominal = (!p.lookup.recorded_speed).then_some(path.speed);
        let look = |requested: f64| {
            let (point, back) = self.previewed(requested);
            PatternLookup { point, back, length: path.length(), nominal }.compensation(patterns)
        };
        let mut found = look(self.requested[0]);
        for (axis, requested) in self.requested.into_iter().enumerate().skip(1) {
            if requested != self.requested[0] {
                found[axis] = look(requested)[axis];
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;
    use crate::path::kinematics::AXES;

    /// Pattern whose compensation is the number of its sample.
    fn numbered(p: &Parameters, path: &ProgrammedPath) -> Pattern {
        let mut pattern = Pattern::plan(p, path, 1.0).unwrap();
        for (k, sample) in pattern.samples.iter_mut().enumerate() {
            sample.compensation = [k as f64; AXES];
        }
        pattern
    }

    #[test]
    fn a_run_at_a_learned_speed_plays_its_pattern_sample_by_sample() {
        for preview in [0.0, 0.4, 1.0, 1.4, 2.7, 5.0, 8.0] {
            let mut p = Parameters::START;
            (p.io_delay, p.lookup.preview) = (0, 0.01 * preview);
            let path = straight(0.12);
            let pattern = numbered(&p, &path);
            let mut run = Run::new(&p, &path, &[0.0; AXES]);
            let mut count = 0;
            while run.step(&p, &path, path.speed) {
                assert_eq!(run.index(&pattern), Some(count));
                assert_eq!(run.point(), pattern.samples[count].point, "preview {preview}, sample {count}");
                let played = run.compensation(&p, &path, std::slice::from_ref(&pattern))[0];
                assert!((played - count as f64).abs() < 1e-6, "preview {preview}, sample {count}: {played}");
                count += 1;
            }
            assert_eq!(count, pattern.len());
        }
    }

    #[test]
    fn each_axis_is_looked_up_as_early_as_its_drive_needs_it() {
        let p = Parameters::START;
        let path = straight(0.12);
        let [early, late, axes] =
            [[-0.004; AXES], [0.009; AXES], std::array::from_fn(|i| if i < 3 { -0.004 } else { 0.009 })].map(|later| {
                let pattern = Pattern::plan(&p, &path, 1.0).unwrap();
                let mut patterns = [pattern.clone(), Pattern::plan(&p, &path, 0.5).unwrap()];
                for (value, pattern) in [7.0, 3.0].into_iter().zip(&mut patterns) {
                    for (k, sample) in pattern.samples.iter_mut().enumerate() {
                        sample.compensation = [value * (0.2 * k as f64).sin(); AXES];
                    }
                }
                let mut run = Run::new(&p, &path, &later);
                let mut played = Vec::new();
                while run.step(&p, &path, 0.8 * path.speed) {
                    played.push(run.compensation(&p, &path, &patterns));
                }
                played
            });
        // during the motion, where the distance counts
        for k in 40..120 {
            assert_eq!(axes[k][..3], early[k][..3], "{k}");
            assert_eq!(axes[k][3..], late[k][3..], "{k}");
        }
        assert!((40..120).any(|k| (early[k][0] - late[k][0]).abs() > 0.1));
    }

    /// Back and forth, repeatedly.
    fn laps() -> ProgrammedPath {
        let there = straight(0.05);
        let points = [there.at(0.0), there.at(0.05), there.at(0.0)];
        let blocks =
            points.windows(2).map(|pair| crate::path::geometry::Block::line(&pair[0], &pair[1]).unwrap()).collect();
        ProgrammedPath::new(blocks, 0.1, true, 0.2).unwrap()
    }

    #[test]
    fn a_lap_is_compensated_as_the_one_before_at_any_preview() {
        for preview in [0.0, 0.4, 1.0, 2.7] {
            let mut p = Parameters::START;
            (p.io_delay, p.lookup.preview) = (0, 0.01 * preview);
            let path = laps();
            let pattern = numbered(&p, &path);
            let mut run = Run::new(&p, &path, &[0.0; AXES]);
            let rest = preview.ceil() as usize;
            // the path that is looked up has started
            for k in 0..3 * pattern.len() {
                run.step(&p, &path, path.speed);
                let Some(index) = k.checked_sub(rest) else { continue };
                let played = run.compensation(&p, &path, std::slice::from_ref(&pattern))[0];
                let expected = (index % pattern.len()) as f64;
                assert!((played - expected).abs() < 1e-6, "preview {preview}, sample {k}: {played}, {expected}");
            }
        }
    }

    #[test]
    fn laps_follow_each_other_without_a_rest() {
        let mut p = Parameters::START;
        (p.io_delay, p.lookup.preview) = (1, 0.02);
        let path = laps();
        let pattern = numbered(&p, &path);
        let mut run = Run::new(&p, &path, &[0.0; AXES]);
        for k in 0..3 * pattern.len() + 3 {
            assert!(run.step(&p, &path, path.speed));
            if k < 3 {
                assert_eq!(run.index(&pattern), None);
                continue;
            }
            let index = (k - 3) % pattern.len();
            assert_eq!(run.index(&pattern), Some(index));
            assert_eq!(run.point(), pattern.samples[index].point, "{k}");
            assert_eq!(run.laps, (k - 3) / pattern.len());
        }
    }

    #[test]
    fn the_reference_moves_as_the_feed_some_samples_later() {
        let mut p = Parameters::START;
        (p.io_delay, p.lookup.preview) = (0, 0.05);
        let path = straight(0.12);
        let mut run = Run::new(&p, &path, &[0.0; AXES]);
        let speeds: Vec<(f64, f64)> =
            std::iter::from_fn(|| run.step(&p, &path, path.speed).then(|| (run.speed(), run.point().speed))).collect();
        assert!(speeds.windows(6).all(|six| six[0].0 == six[5].1));
        assert!(speeds.iter().any(|(feed, _)| *feed == path.speed));
    }

    #[test]
    fn a_held_run_rests_and_goes_on() {
        let p = Parameters::START;
        let path = straight(0.12);
        let mut run = Run::new(&p, &path, &[0.0; AXES]);
        for k in 0..200 {
            run.step(&p, &path, if (60..150).contains(&k) { 0.0 } else { path.speed });
            assert!(!(100..150).contains(&k) || run.stopped());
        }
        assert!(!run.stopped());
        let goes_on = (0..1000).any(|_| !run.step(&p, &path, path.speed));
        assert!(goes_on);
    }

    #[test]
    fn the_second_half_of_the_rest_is_rest_and_the_run_ends_with_it() {
        let mut p = Parameters::START;
        (p.learn.lead_out, p.learn.lead_in) = (60, 10);
        let path = straight(0.12);
        let mut run = Run::new(&p, &path, &[0.0; AXES]);
        let mut rests = Vec::new();
        while run.step(&p, &path, path.speed) {
            if run.point().distance >= path.length() {
                rests.push(run.rests(&p));
            } else {
                assert!(!run.rests(&p));
            }
        }
        assert_eq!((rests.len(), rests.iter().position(|rests| *rests)), (60, Some(30)));
    }

    #[test]
    fn the_outputs_report_the_position_of_the_reference_while_it_runs() {
        let p = Parameters::START;
        let path = straight(0.12);
        let mut run = Run::new(&p, &path, &[0.0; AXES]);
        for _ in 0..60 {
            run.step(&p, &path, path.speed);
        }
        let Point { distance, speed } = run.point();
        let report = run.report(&path, true, false);
        assert_eq!(
            (report.distance, report.speed, report.block, report.block_distance),
            (distance, speed, 1, distance)
        );
        assert!(distance > 0.0 && speed > 0.0 && !report.done && report.length == path.length());
        let waits = run.report(&path, false, true);
        assert_eq!((waits.distance, waits.speed, waits.done), (0.0, 0.0, true));
    }
}
