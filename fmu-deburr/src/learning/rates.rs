//! How far the reference of each axis moves from one sample of a pattern to the next.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::learning::pattern::Pattern;
use crate::path::kinematics::{AXES, Joints};
use crate::path::programmed_path::ProgrammedPath;

/// Rates of one pattern at a time, with memory for the longest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Rates {
    samples: Vec<Joints>,
    count: usize,
    cyclic: bool,
}

impl Rates {
    /// With memory for patterns of up to `samples` samples.
    pub fn new(samples: usize) -> Self {
        Self { samples: vec![[0.0; AXES]; samples], count: 0, cyclic: false }
    }

    /// Walks the path as a pattern does; `start` are the axes at the start of the path, rad or m.
    pub fn walk(&mut self, p: &Parameters, path: &ProgrammedPath, start: &Joints, pattern: &Pattern) {
        (self.count, self.cyclic) = (pattern.len(), pattern.cyclic);
        let mut joints = *start;
        for k in 0..self.count {
            let next = match pattern.samples.get(k + 1) {
                Some(sample) => sample.point.distance,
                None if self.cyclic => 0.0,
                None => pattern.samples[k].point.distance,
            };
            let before = joints;
            joints = p.arm.inverse(&path.at(next), &joints).unwrap_or(joints);
            self.samples[k] = std::array::from_fn(|i| (joints[i] - before[i]) / p.axis[i].pulse);
        }
    }

    /// Rates (counts) of one axis, for tests.
    #[cfg(test)]
    pub fn of(axis: usize, rates: &[f64], cyclic: bool) -> Self {
        let sample = |rate: &f64| std::array::from_fn(|i| if i == axis { *rate } else { 0.0 });
        Self { samples: rates.iter().map(sample).collect(), count: rates.len(), cyclic }
    }

    /// Number of samples.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether one lap follows the other.
    pub fn cyclic(&self) -> bool {
        self.cyclic
    }

    /// The sample that stands for the sample `index`: that of another lap, else none outside the pattern.
    pub fn inside(&self, index: isize) -> Option<usize> {
        let count = self.count as isize;
        let inside = if self.cyclic { index.rem_euclid(count) } else { index };
        (0..count).contains(&inside).then_some(inside as usize)
    }

    /// Rates in the sample `index`, counts; none before and after the path.
    pub fn at(&self, index: isize) -> Joints {
        self.inside(index).map_or([0.0; AXES], |k| self.samples[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;
    use crate::path::feasible;
    use crate::path::geometry::Block;

    fn walked(path: &ProgrammedPath) -> (Rates, Pattern) {
        let p = Parameters::START;
        let pattern = Pattern::plan(&p, path, 0.8).unwrap();
        let mut rates = Rates::new(pattern.len() + 7);
        rates.walk(&p, path, &feasible::start(&p, path).unwrap(), &pattern);
        (rates, pattern)
    }

    #[test]
    fn their_sum_is_the_travel_and_outside_there_are_none() {
        let (p, path) = (Parameters::START, straight(0.1));
        let (rates, pattern) = walked(&path);
        let start = feasible::start(&p, &path).unwrap();
        let end = p.arm.inverse(&path.at(path.length()), &start).unwrap();
        for axis in 0..AXES {
            let distance: f64 = (-5..400).map(|k| rates.at(k)[axis]).sum();
            assert!((start[axis] + distance * p.axis[axis].pulse - end[axis]).abs() < 1e-12, "{axis}: {distance}");
        }
        assert!(rates.at(-1) == [0.0; AXES] && rates.at(pattern.len() as isize) == [0.0; AXES]);
        // the tip goes at 80 mm/s in the plane
        let middle = rates.at(pattern.len() as isize / 2 - 25);
        let radius = start[2].min(end[2])..start[2].max(end[2]) + 1e-9;
        let turning = middle[0] * p.axis[0].pulse / p.sample_period;
        let across = (0.08_f64.powi(2) - (middle[2] * p.axis[2].pulse / p.sample_period).powi(2)).sqrt();
        assert!(radius.contains(&(across / turning.abs())), "{middle:?}");
    }

    #[test]
    fn a_lap_ends_where_the_next_one_begins() {
        let there = straight(0.1);
        let ends = [there.at(0.0), there.at(0.1), there.at(0.0)];
        let blocks = ends.windows(2).map(|pair| Block::line(&pair[0], &pair[1]).unwrap()).collect();
        let (rates, pattern) = walked(&ProgrammedPath::new(blocks, 0.1, true, 0.2).unwrap());
        let count = pattern.len() as isize;
        let distance: f64 = (0..count).map(|k| rates.at(k)[2]).sum();
        assert!(distance.abs() < 1e-6, "{distance}");
        assert_eq!(rates.at(-3), rates.at(count - 3));
    }
}
