//! End mill that sinks into a face: every tooth cuts the floor left by the tooth before.

use std::f64::consts::TAU;

use crate::element::{Element, Ports};

/// Points of the floor per revolution.
const BINS: usize = 400;

/// Two teeth, half a revolution apart, on springs; each takes a chip from the floor under it.
///
/// A tooth at the depth `z` meets a floor at `f`. The spring `k` of tool, spindle and workpiece and the chip, whose force
/// is `c` times its thickness, carry the same force: `F = k c / (k + c) (z - f)`, and the tooth leaves the floor `F / c`
/// deeper. At a constant feed per tooth the chip in the end is that feed, and the force `c` times it, however deep.
///
/// A point is cut when the tooth leaves it, so a tool at rest only presses.
#[derive(Clone, Debug)]
pub struct Plunge {
    /// tool, spindle and workpiece in series, N/m
    stiffness: f64,
    /// force per thickness of the chip, N/m
    chip: f64,
    /// depth of the face under every point, m
    floor: Vec<f64>,
}

impl Plunge {
    /// Teeth on springs of `stiffness` N/m whose chips take `chip` N per m of thickness, on a fresh face.
    pub fn new(stiffness: f64, chip: f64) -> Self {
        Self { stiffness, chip, floor: vec![0.0; BINS] }
    }

    /// force of a tooth at `depth` that turns from `from` to `to`; the points that it leaves are cut
    fn tooth(&mut self, depth: f64, from: f64, to: f64) -> f64 {
        let bin = |angle: f64| (angle.rem_euclid(TAU) / TAU * BINS as f64) as usize % BINS;
        let (first, last) = (bin(from), bin(to));
        let left = (last + BINS - first) % BINS;
        let share = self.stiffness / (self.stiffness + self.chip);
        let mut sum = 0.0;
        for i in 0..=left {
            let floor = &mut self.floor[(first + i) % BINS];
            let uncut = (depth - *floor).max(0.0);
            sum += uncut;
            if i < left {
                *floor += share * uncut;
            }
        }
        share * self.chip * sum / (left + 1) as f64
    }
}

impl Element for Plunge {
    fn ports(&self) -> Ports {
        Ports { inputs: &["depth", "retreat_1", "retreat_2", "angle", "angle_next"], outputs: &["force", "floor"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let &[depth, retreat_1, retreat_2, from, to] = inputs else { return };
        let first = self.tooth(depth - retreat_1, from, to);
        let second = self.tooth(depth - retreat_2, from + TAU / 2.0, to + TAU / 2.0);
        outputs[0] = first + second;
        outputs[1] = self.floor.iter().copied().fold(0.0, f64::max);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const K: f64 = 2e5;
    const C: f64 = 5e5;
    /// a step is a fortieth of a revolution: ten points
    const STEP: f64 = TAU / 40.0;

    fn step(plunge: &mut Plunge, depth: f64, second: f64, at: f64, turned: f64) -> [f64; 2] {
        let mut out = [9.0; 2];
        plunge.step(&[depth, 0.0, second, at, at + turned], &mut out, 5e-5);
        out
    }

    #[test]
    fn a_tool_that_stands_presses_on_springs_in_series_and_leaves_no_mark() {
        let mut plunge = Plunge::new(K, C);
        for depth in [1e-7, 3e-7, 1e-7] {
            let [force, floor] = step(&mut plunge, depth, 1.0, 0.3, 0.0);
            assert!((force - K * C / (K + C) * depth).abs() < 1e-15);
            assert_eq!(floor, 0.0);
        }
        assert_eq!(step(&mut plunge, -1e-9, 1.0, 0.3, 0.0)[0], 0.0);
    }

    #[test]
    fn at_constant_feed_the_force_is_that_of_the_feed_per_tooth() {
        // 0.1 um a tooth: two teeth of C times that; a tooth that is 1 um short leaves it all to the other
        for (short, force) in [(0.0, 2.0 * C * 1e-7), (1.0, C * 2e-7)] {
            let mut plunge = Plunge::new(K, C);
            let mut last = [0.0; 2];
            for i in 0..40 * 60 {
                let turned = f64::from(i);
                last = step(&mut plunge, 2e-7 / 40.0 * turned, short, STEP * turned, STEP);
            }
            assert!((last[0] / force - 1.0).abs() < 0.02, "{short}: {} instead of {force} N", last[0]);
            // the spring lags behind the tool by force over stiffness
            let floor = 2e-7 * 60.0 - C * (if short > 0.0 { 2e-7 } else { 1e-7 }) / K;
            assert!((last[1] - floor).abs() < 1e-8, "{} instead of {floor} m", last[1]);
        }
    }

    #[test]
    fn what_is_cut_stays_cut() {
        let mut plunge = Plunge::new(K, C);
        for i in 0..80 {
            step(&mut plunge, 1e-6, 1.0, STEP * f64::from(i), STEP);
        }
        // two passes of the only tooth: what is left falls by c / (k + c) each time
        let left = 1e-6 * (C / (K + C)).powi(2);
        let [force, floor] = step(&mut plunge, 1e-6, 1.0, 0.0, 0.0);
        assert!((floor - (1e-6 - left)).abs() < 1e-15);
        assert!((force - K * C / (K + C) * left).abs() < 1e-12);
        assert_eq!(step(&mut plunge, 1e-6 - 1.01 * left, 1.0, 0.0, 0.0)[0], 0.0);
    }

    #[test]
    fn it_turns_through_zero() {
        let mut plunge = Plunge::new(K, C);
        step(&mut plunge, 1e-6, 1.0, TAU - 0.45 * STEP, STEP);
        let cut = plunge.floor.iter().filter(|floor| **floor > 0.0).count();
        assert_eq!(cut, 10);
        assert!(plunge.floor[0] > 0.0 && plunge.floor[BINS - 1] > 0.0);
    }
}
