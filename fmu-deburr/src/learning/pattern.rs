//! Control pattern: for each sample of a run at one speed the distance, the speed, and the compensation of each axis.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::path::feed::{FeedPlanner, Point};
use crate::path::kinematics::{AXES, Joints};
use crate::path::programmed_path::ProgrammedPath;

/// Distances (m) and speeds (m/s) that differ by less are rounded differently.
const ROUNDING: f64 = 1e-9;

/// Most samples of a pattern.
pub const SAMPLES_MAX: usize = 60_000;

/// One sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Distance from the start of the path and speed until the next sample.
    pub point: Point,
    /// Compensation, pulses.
    pub compensation: Joints,
}

/// The samples of one speed.
///
/// Before the path and after it the distance does not distinguish samples: there the time is used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pattern {
    /// Multiple of the programmed speed.
    pub factor: f64,
    /// All samples in the order of time.
    pub samples: Vec<Sample>,
    /// Number of samples at rest before the start.
    pub lead_in: usize,
    /// Number of samples from the start to the one before the end.
    pub run: usize,
    /// The run repeats without lead-in and lead-out.
    pub cyclic: bool,
}

impl Pattern {
    /// A pattern of zeros for one speed: the feed of the run, planned.
    ///
    /// # Errors
    /// Message for the user if the pattern would be too long.
    pub fn plan(p: &Parameters, path: &ProgrammedPath, factor: f64) -> Result<Self, String> {
        let (lead_in, lead_out) = match path.cyclic {
            true => (0, 0),
            false => (p.learn.lead_in as usize, p.learn.lead_out as usize),
        };
        let mut samples = vec![Sample::default(); lead_in];
        let mut feed = FeedPlanner::START;
        loop {
            let point = feed.step(&p.feed, path, factor * path.speed, p.sample_period);
            if point.distance >= path.length() {
                break;
            }
            samples.push(Sample { point, compensation: [0.0; AXES] });
            if samples.len() > SAMPLES_MAX {
                return Err(format!(
                    "at `{factor}` times the programmed speed it takes more than `{SAMPLES_MAX}` samples"
                ));
            }
        }
        let run = samples.len() - lead_in;
        let end = Sample { point: Point { distance: path.length(), speed: 0.0 }, compensation: [0.0; AXES] };
        samples.resize(samples.len() + lead_out, end);
        Ok(Self { factor, samples, lead_in, run, cyclic: path.cyclic })
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Largest compensation, pulses.
    pub fn largest(&self) -> f64 {
        let values = self.samples.iter().flat_map(|sample| sample.compensation);
        values.fold(0.0, |maximum, value| maximum.max(value.abs()))
    }

    /// Whether another pattern has the same samples, except the compensation.
    pub fn fits(&self, other: &Self) -> bool {
        let close = |(a, b): (&Sample, &Sample)| {
            (a.point.distance - b.point.distance).abs() < ROUNDING && (a.point.speed - b.point.speed).abs() < ROUNDING
        };
        self.factor == other.factor
            && (self.lead_in, self.run, self.cyclic) == (other.lead_in, other.run, other.cyclic)
            && self.len() == other.len()
            && self.samples.iter().zip(&other.samples).all(close)
    }

    /// Compensation of the sample `index`; before the first and after the last it is theirs, or that of the next lap.
    pub fn compensation(&self, index: isize) -> Joints {
        let count = self.len() as isize;
        let inside = if self.cyclic { index.rem_euclid(count) } else { index.clamp(0, count - 1) };
        self.samples[inside as usize].compensation
    }

    /// Adds a value (pulses) to the compensation of an axis, in the two samples around the position `index`; beyond the
    /// ends nothing.
    pub fn add(&mut self, axis: usize, index: f64, value: f64) {
        let (whole, count) = (index.floor(), self.len() as isize);
        for (k, fraction) in [(whole as isize, 1.0 - (index - whole)), (whole as isize + 1, index - whole)] {
            let k = if self.cyclic { k.rem_euclid(count) } else { k };
            if let Some(sample) = usize::try_from(k).ok().and_then(|k| self.samples.get_mut(k)) {
                sample.compensation[axis] += fraction * value;
            }
        }
    }

    /// Compensation between two samples.
    pub fn between(&self, index: f64) -> Joints {
        let whole = index.floor();
        let (a, b) = (self.compensation(whole as isize), self.compensation(whole as isize + 1));
        mix(&a, &b, index - whole)
    }

    /// Eq. 2 and 3: compensation and recorded speed (m/s) at a distance (m), `back` samples before it.
    pub fn at(&self, distance: f64, back: f64, length: f64) -> (Joints, f64) {
        let run = &self.samples[self.lead_in..self.lead_in + self.run];
        // j: the sample at or before the distance, j + 1: the next
        let j = run.partition_point(|sample| sample.point.distance <= distance).saturating_sub(1);
        let here = run[j].point;
        // the run ends at rest at the end of the path
        let next = run.get(j + 1).map_or(Point { distance: length, speed: 0.0 }, |sample| sample.point);
        let fraction =
            ((distance - here.distance) / (next.distance - here.distance).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (self.between((self.lead_in + j) as f64 + fraction - back), here.speed + fraction * (next.speed - here.speed))
    }
}

/// `a + (b - a) fraction` for each axis.
pub fn mix(a: &Joints, b: &Joints, fraction: f64) -> Joints {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * fraction)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::path::geometry::{Block, Pose, Vector};

    /// A straight path.
    pub(crate) fn straight(length: f64) -> ProgrammedPath {
        let pose = |y: f64| Pose { tip: Vector::new(0.75, y, -0.2), axis: Vector::new(0.0, 0.0, -1.0) };
        ProgrammedPath::new(vec![Block::line(&pose(0.0), &pose(length)).unwrap()], 0.1, false, 0.2).unwrap()
    }

    #[test]
    fn a_plan_has_rest_run_and_rest() {
        let (p, path) = (Parameters::START, straight(0.1));
        let pattern = Pattern::plan(&p, &path, 0.5).unwrap();
        assert_eq!(pattern.len(), 10 + pattern.run + 60);
        // 0.1 m at 50 mm/s and the two ramps of 0.1 s
        assert!((pattern.run as f64 - 210.0).abs() <= 2.0, "{}", pattern.run);
        assert_eq!(pattern.samples[10].point.distance, 0.0);
        assert!(pattern.samples[10].point.speed > 0.0 && pattern.samples[9].point.speed == 0.0);
        assert_eq!(pattern.samples[10 + pattern.run].point, Point { distance: 0.1, speed: 0.0 });
        assert!(pattern.samples[9 + pattern.run].point.distance < 0.1);
    }

    #[test]
    fn at_a_recorded_distance_the_recorded_sample_is_restored() {
        let (p, path) = (Parameters::START, straight(0.1));
        let mut pattern = Pattern::plan(&p, &path, 1.0).unwrap();
        for (k, sample) in pattern.samples.iter_mut().enumerate() {
            sample.compensation = [k as f64; AXES];
        }
        for k in 0..pattern.run {
            let point = pattern.samples[10 + k].point;
            let (compensation, speed) = pattern.at(point.distance, 0.0, path.length());
            assert!((compensation[2] - (10 + k) as f64).abs() < 1e-9 && (speed - point.speed).abs() < 1e-12);
            let (earlier, _) = pattern.at(point.distance, 3.0, path.length());
            assert!((earlier[2] - (7 + k) as f64).abs() < 1e-9);
        }
        let middle = 0.5 * (pattern.samples[40].point.distance + pattern.samples[41].point.distance);
        assert!((pattern.at(middle, 0.0, path.length()).0[0] - 40.5).abs() < 1e-9);
        assert!((pattern.at(path.length(), 0.0, path.length()).0[0] - (10 + pattern.run) as f64).abs() < 1e-9);
    }

    #[test]
    fn what_is_added_is_shared_by_two_samples_and_lost_beyond_the_ends_but_of_a_lap() {
        let mut pattern = Pattern::plan(&Parameters::START, &straight(0.1), 1.0).unwrap();
        let last = pattern.len() - 1;
        let of = |pattern: &Pattern, k: usize| pattern.samples[k].compensation[3];
        pattern.add(3, 20.25, 8.0);
        pattern.add(3, 20.0, 1.0);
        pattern.add(3, -0.75, 4.0);
        pattern.add(3, last as f64 + 0.5, 4.0);
        assert_eq!([0, 19, 20, 21, 22, last].map(|k| of(&pattern, k)), [1.0, 0.0, 7.0, 2.0, 0.0, 2.0]);
        assert!(pattern.samples.iter().all(|sample| sample.compensation[2] == 0.0));
        pattern.cyclic = true;
        pattern.add(3, -0.75, 4.0);
        assert_eq!([0, last].map(|k| of(&pattern, k)), [2.0, 5.0]);
    }

    #[test]
    fn a_path_without_end_is_rejected() {
        let message = Pattern::plan(&Parameters::START, &straight(90.0), 1.0).unwrap_err();
        assert!(message.contains("60000"), "{message}");
    }

    #[test]
    fn a_pattern_may_have_all_its_samples_and_not_one_more() {
        let (mut p, path) = (Parameters::START, straight(0.1));
        let run = Pattern::plan(&p, &path, 1.0).unwrap().run;
        p.learn.lead_in = (SAMPLES_MAX - run) as i32;
        assert!(Pattern::plan(&p, &path, 1.0).is_ok());
        p.learn.lead_in += 1;
        assert!(Pattern::plan(&p, &path, 1.0).is_err());
    }

    #[test]
    fn a_pattern_fits_one_with_the_same_samples_except_for_rounding() {
        let (p, path) = (Parameters::START, straight(0.1));
        let pattern = Pattern::plan(&p, &path, 1.0).unwrap();
        let with = |change: fn(&mut Pattern)| {
            let mut other = pattern.clone();
            change(&mut other);
            (pattern.fits(&other), other.fits(&pattern))
        };
        let fits: [fn(&mut Pattern); 3] = [
            |other| other.samples[7].compensation = [9.0; AXES],
            |other| other.samples[0].point.distance += 0.9e-9,
            |other| other.samples[0].point.speed += 0.9e-9,
        ];
        assert!(fits.into_iter().all(|change| with(change) == (true, true)));
        // a difference of the rounding itself is one
        let others: [fn(&mut Pattern); 8] = [
            |other| other.samples[0].point.distance += ROUNDING,
            |other| other.samples[0].point.speed += ROUNDING,
            |other| other.samples[20].point.distance += 1e-6,
            |other| other.factor = 0.99,
            |other| other.lead_in += 1,
            |other| other.run -= 1,
            |other| other.cyclic = true,
            |other| other.samples.truncate(other.samples.len() - 1),
        ];
        assert!(others.into_iter().all(|change| with(change) == (false, false)));
    }

    #[test]
    fn beyond_the_ends_it_is_the_last_sample_or_the_next_lap() {
        let mut pattern = Pattern::plan(&Parameters::START, &straight(0.1), 1.0).unwrap();
        let count = pattern.len();
        for (k, sample) in pattern.samples.iter_mut().enumerate() {
            sample.compensation = [k as f64; AXES];
        }
        let last = count as isize - 1;
        let of = |pattern: &Pattern, index: isize| pattern.compensation(index)[1];
        assert_eq!([-3, 0, last, last + 5].map(|index| of(&pattern, index)), [0.0, 0.0, last as f64, last as f64]);
        assert!((pattern.between(4.25)[0] - 4.25).abs() < 1e-12);
        pattern.cyclic = true;
        assert_eq!([-3, last + 1, last + 5].map(|index| of(&pattern, index)), [last as f64 - 2.0, 0.0, 4.0]);
        assert!(!pattern.is_empty());
    }
}
