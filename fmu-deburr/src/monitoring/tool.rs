//! Tool speed in the cut: too slow, or constant along a distance or the whole path.
//!
//! A speed is used only if it persists. Of each block of one sample more than are bridged, the slowest block is
//! represented by its fastest sample, and the fastest block by its slowest one. So neither a bad sample nor noise is a
//! cut.

use control_blocks::Consecutive;
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::finding::{Finding, Numbers};

/// Monitor of the tool speed in the cut along one run or lap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolMonitor {
    slow: Consecutive,
    /// slowest and fastest of the present block, rad/s, and its samples
    block: Option<(f64, f64)>,
    count: u32,
    /// slowest and fastest that held for a block, rad/s
    held: Option<(f64, f64)>,
    /// distance since the tool was last loaded, m; none before the first load, because the start may be cut already
    idle: Option<f64>,
}

impl ToolMonitor {
    /// Begins a path.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Whether the tool was loaded since the path began.
    pub fn loaded(&self) -> bool {
        self.idle.is_some()
    }

    /// Takes the tool speed (rad/s) of a sample in which the tool cuts, and the distance since the last one (m).
    pub fn update(&mut self, p: &Parameters, speed: f64, distance: f64) -> Finding {
        let (minimum, bridged) = (p.load.scale * p.limits.spindle_speed_min, p.limits.lost_samples.unsigned_abs());
        self.hold(p, speed, distance);
        if self.slow.update(speed < minimum) > bridged {
            return Finding::beyond(Fault::SpindleSlow, speed, minimum);
        }
        let band = p.limits.spindle_change;
        let maximum = p.limits.idle_travel;
        if band > 0.0 && maximum > 0.0 && self.idle.is_some_and(|distance| distance > maximum) {
            return Finding {
                fault: Fault::NoCut,
                numbers: Numbers { ratio: self.idle, limit: maximum, ..Numbers::START },
            };
        }
        Finding::NONE
    }

    fn hold(&mut self, p: &Parameters, speed: f64, distance: f64) {
        let (slowest, fastest) = self.block.unwrap_or((speed, speed));
        let block = (slowest.min(speed), fastest.max(speed));
        (self.block, self.count) = (Some(block), self.count + 1);
        self.idle = self.idle.map(|idle| idle + distance);
        if self.count > p.limits.lost_samples.unsigned_abs() {
            let (slowest, fastest) = self.held.unwrap_or((block.1, block.0));
            let held = (slowest.min(block.1), fastest.max(block.0));
            (self.block, self.count, self.held) = (None, 0, Some(held));
            if held.1 - block.1 >= p.limits.spindle_change {
                self.idle = Some(0.0);
            }
        }
    }

    /// `NoCut` at the end of a run or lap in which the tool speed changed by less than `limits.spindle_change`;
    /// otherwise none.
    pub fn after_run(&self, p: &Parameters) -> Finding {
        let change = self.held.map_or(0.0, |(slowest, fastest)| (fastest - slowest).max(0.0));
        let minimum = p.limits.spindle_change;
        if change < minimum { Finding::beyond(Fault::NoCut, change, minimum) } else { Finding::NONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_tool_is_reported_after_the_samples_that_are_bridged() {
        let p = Parameters::START;
        let mut tool = ToolMonitor::default();
        let speeds = [1800.0, 1600.0, 1600.0, 1600.0, 1800.0, 1600.0, 1600.0, 1600.0, 1600.0];
        let faults = speeds.map(|speed| tool.update(&p, speed, 0.0).fault);
        assert!(faults[..8].iter().all(|fault| *fault == Fault::None));
        assert_eq!(faults[8], Fault::SpindleSlow);
    }

    #[test]
    fn a_path_without_a_change_was_not_cut() {
        let mut p = Parameters::START;
        let mut tool = ToolMonitor::default();
        for k in 0..500 {
            // the last bit flickers
            tool.update(&p, 1880.0 + 0.51 * f64::from(k % 2), 0.0);
        }
        assert_eq!(tool.after_run(&p).fault, Fault::NoCut);
        p.limits.spindle_change = 0.0;
        assert_eq!(tool.after_run(&p).fault, Fault::None);
        p.limits.spindle_change = 2.0;
        for _ in 0..8 {
            tool.update(&p, 1860.0, 0.0);
        }
        assert_eq!(tool.after_run(&p).fault, Fault::None);
        tool.restart();
        assert_eq!(tool.after_run(&p).fault, Fault::NoCut);
    }

    #[test]
    fn bad_samples_and_noise_are_no_cut() {
        let p = Parameters::START;
        for bad in 1..=3 {
            let mut tool = ToolMonitor::default();
            for k in 0..500 {
                tool.update(&p, if (201..201 + bad).contains(&k) { 1860.0 } else { 1880.0 }, 0.0);
            }
            assert_eq!(tool.after_run(&p).fault, Fault::NoCut, "{bad}");
        }
        let mut tool = ToolMonitor::default();
        for k in 0..500 {
            tool.update(&p, 1880.0 + 30.0 * (2.3 * f64::from(k)).sin(), 0.0);
        }
        assert_eq!(tool.after_run(&p).fault, Fault::NoCut);
    }

    /// The fault, and in which sample, of a tool that runs idle, then at a speed as a function of its samples of 1 mm.
    fn cutting(p: &Parameters, speed: impl Fn(usize) -> f64) -> (Fault, usize) {
        let mut tool = ToolMonitor::default();
        (0..8).for_each(|_| assert!(!tool.update(p, 1884.0, 0.0).is_fault()));
        let faults = (0..400).map(|k| (tool.update(p, speed(k), 1e-3).fault, k));
        faults.into_iter().find(|(fault, _)| *fault != Fault::None).unwrap_or((Fault::None, 400))
    }

    #[test]
    fn a_distance_without_a_cut_is_reported_where_it_is_longer_than_the_longest_gap() {
        let mut p = Parameters::START;
        p.limits.idle_travel = 0.1;
        // cuts for 50 mm
        let gap = |length: usize| move |k: usize| if k % (50 + length) < 50 { 1850.0 - (k % 7) as f64 } else { 1884.0 };
        assert_eq!(cutting(&p, gap(90)).0, Fault::None);
        let (fault, after) = cutting(&p, gap(200));
        assert_eq!(fault, Fault::NoCut);
        assert!((147..=154).contains(&after), "{after}");
        p.limits.idle_travel = 0.0;
        assert_eq!(cutting(&p, gap(200)).0, Fault::None);
    }

    #[test]
    fn the_limits_themselves_are_good() {
        let mut p = Parameters::START;
        let mut tool = ToolMonitor::default();
        for _ in 0..20 {
            assert!(!tool.update(&p, p.limits.spindle_speed_min, 0.0).is_fault());
        }
        (p.limits.spindle_change, p.limits.idle_travel) = (2.0, 1.0);
        let mut tool = ToolMonitor::default();
        (0..4).for_each(|_| assert!(!tool.update(&p, 1884.0, 0.5).is_fault()));
        // as much slower as it must be
        (0..4).for_each(|_| assert!(!tool.update(&p, 1882.0, 0.5).is_fault()));
        assert!(!tool.after_run(&p).is_fault());
        assert!(!tool.update(&p, 1884.0, 0.5).is_fault());
        let found = [(); 4].map(|()| tool.update(&p, 1884.0, 0.5));
        assert_eq!(found.map(|found| found.fault), [Fault::None, Fault::NoCut, Fault::NoCut, Fault::NoCut]);
        assert_eq!((found[1].numbers.ratio, found[1].numbers.limit), (Some(1.5), 1.0));
    }

    #[test]
    fn a_distance_without_a_cut_is_none_where_no_change_is_requested() {
        let mut p = Parameters::START;
        (p.limits.spindle_change, p.limits.idle_travel) = (0.0, 0.01);
        let mut tool = ToolMonitor::default();
        for k in 0..200 {
            let speed = if k < 4 { 1884.0 } else { 1884.0 + f64::from(k % 4) };
            assert_eq!(tool.update(&p, speed, 1e-3), Finding::NONE, "{k}");
        }
    }
}
