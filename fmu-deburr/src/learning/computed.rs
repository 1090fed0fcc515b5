//! Patterns computed from the nominal drive, without a run: what learning has to be better than.
//!
//! The loop makes T (r + c) of reference and compensation, so c is right where T (r + c) = r. It is found as norm-optimal
//! learning finds it, on the model in place of the machine; what a renewal leaves of the error is lambda / (T'T + lambda).

use crate::interface::Parameters;
use crate::learning::nominal::Nominal;
use crate::learning::norm_optimal::{Work, solve};
use crate::learning::pattern::Pattern;
use crate::path::kinematics::{AXES, Joints};
use crate::path::taught_path::TaughtPath;

/// Renewals on the model: from 7 mm of lag three leave a hundredth of a count at lambda = 0.01.
const RENEWALS: usize = 3;
/// Laps of a cyclic path, of which the middle one is taken.
const LAPS: usize = 3;

/// Fills a pattern with what the nominal loop needs; `start` are the axes at the start of the path, rad or m.
pub fn compute(p: &Parameters, path: &TaughtPath, start: &Joints, pattern: &mut Pattern) {
    let laps = if pattern.cyclic { LAPS } else { 1 };
    let ways = ways(p, path, start, pattern, laps);
    let (count, from) = (pattern.len(), laps / 2 * pattern.len());
    let room = || vec![0.0; laps * count];
    let (mut error, [mut a, mut b, mut c]) = (room(), [room(), room(), room()]);
    for axis in 0..AXES {
        let nominal = Nominal::new(p, axis);
        let mut compensation = room();
        for _ in 0..RENEWALS {
            let way = ways.iter().map(|way| way[axis]);
            error.iter_mut().zip(&compensation).zip(way.clone()).for_each(|((e, c), way)| *e = way + c);
            nominal.apply(&mut error, false);
            error.iter_mut().zip(way).for_each(|(e, way)| *e = way - *e);
            let mut work = Work { residual: &mut a, direction: &mut b, product: &mut c };
            solve(&nominal, p.learn.weight, &mut error, &mut work);
            compensation.iter_mut().zip(&error).for_each(|(c, change)| *c += change);
        }
        let samples = pattern.samples.iter_mut().zip(&compensation[from..]);
        samples.for_each(|(sample, value)| sample.compensation[axis] = *value);
    }
}

/// Way of the axes from the start of the path in each sample, counts.
fn ways(p: &Parameters, path: &TaughtPath, start: &Joints, pattern: &Pattern, laps: usize) -> Vec<Joints> {
    let mut joints = *start;
    let mut way = |distance: f64| {
        joints = p.arm.inverse(&path.at(distance), &joints).unwrap_or(joints);
        std::array::from_fn(|i| (joints[i] - start[i]) / p.axis[i].pulse)
    };
    let samples = pattern.samples.iter().cycle().take(laps * pattern.len());
    samples.map(|sample| way(sample.point.distance)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;
    use crate::path::feasible;
    use crate::path::geometry::Block;

    /// Largest error of the nominal loops along a pattern with its compensation, in counts, after the first lap.
    fn left(p: &Parameters, path: &TaughtPath, laps: usize) -> f64 {
        let start = feasible::start(p, path).unwrap();
        let mut pattern = Pattern::plan(p, path, 0.8).unwrap();
        compute(p, path, &start, &mut pattern);
        let ways = ways(p, path, &start, &pattern, laps);
        let mut most: f64 = 0.0;
        for axis in 0..AXES {
            let compensated = ways.iter().enumerate();
            let mut signal: Vec<f64> = compensated
                .map(|(k, way)| way[axis] + pattern.compensation(k as isize % pattern.len() as isize)[axis])
                .collect();
            Nominal::new(p, axis).apply(&mut signal, false);
            let errors = signal.iter().zip(&ways).skip((laps - 1) * pattern.len());
            most = errors.fold(most, |most, (position, way)| most.max((position - way[axis]).abs()));
        }
        assert!(pattern.samples.iter().any(|sample| sample.compensation[0].abs() > 100.0));
        most
    }

    #[test]
    fn the_nominal_loop_follows_within_a_count_with_and_without_delay() {
        for io_delay in [0, 1, 3] {
            let mut p = Parameters::START;
            p.io_delay = io_delay;
            let left = left(&p, &straight(0.1), 1);
            assert!(left < 1.0, "{io_delay}: {left}");
        }
    }

    #[test]
    fn laps_follow_each_other() {
        let (p, there) = (Parameters::START, straight(0.1));
        let ends = [there.at(0.0), there.at(0.1), there.at(0.0)];
        let blocks = ends.windows(2).map(|pair| Block::line(&pair[0], &pair[1]).unwrap()).collect();
        let left = left(&p, &TaughtPath::new(blocks, 0.1, true, 0.2).unwrap(), 2);
        assert!(left < 1.0, "{left}");
    }
}
