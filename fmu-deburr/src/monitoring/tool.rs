//! The tool's speed while it cuts: too slow, or the same all along the path.
//!
//! A speed counts only where it holds: of each block of one sample more than are bridged the slowest block is known by its
//! fastest sample, and the fastest block by its slowest one. So neither a bad sample nor noise is a cut.

use control_blocks::Consecutive;
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::finding::Finding;

/// What is seen of the tool along one path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolMonitor {
    slow: Consecutive,
    /// slowest and fastest of the present block, rad/s, and its samples
    block: Option<(f64, f64)>,
    count: u32,
    /// slowest and fastest that held for a block, rad/s
    held: Option<(f64, f64)>,
}

impl ToolMonitor {
    /// Begins a path.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Takes the tool speed (rad/s) of a sample in which the tool cuts.
    pub fn update(&mut self, p: &Parameters, speed: f64) -> Finding {
        let (least, bridged) = (p.limits.spindle_speed_min, p.limits.lost_samples.unsigned_abs());
        self.hold(speed, bridged);
        if self.slow.update(speed < least) > bridged {
            return Finding::beyond(Fault::SpindleSlow, speed, least);
        }
        Finding::NONE
    }

    fn hold(&mut self, speed: f64, bridged: u32) {
        let (slowest, fastest) = self.block.unwrap_or((speed, speed));
        let block = (slowest.min(speed), fastest.max(speed));
        (self.block, self.count) = (Some(block), self.count + 1);
        if self.count > bridged {
            let (slowest, fastest) = self.held.unwrap_or((block.1, block.0));
            self.held = Some((slowest.min(block.1), fastest.max(block.0)));
            (self.block, self.count) = (None, 0);
        }
    }

    /// What is wrong with a path that has come to its end: nothing was cut.
    pub fn after_run(&self, p: &Parameters) -> Finding {
        let change = self.held.map_or(0.0, |(slowest, fastest)| (fastest - slowest).max(0.0));
        let least = p.limits.spindle_change;
        if change < least { Finding::beyond(Fault::NoCut, change, least) } else { Finding::NONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_tool_is_told_after_the_samples_that_are_bridged() {
        let p = Parameters::START;
        let mut tool = ToolMonitor::default();
        let speeds = [1800.0, 1600.0, 1600.0, 1600.0, 1800.0, 1600.0, 1600.0, 1600.0, 1600.0];
        let faults = speeds.map(|speed| tool.update(&p, speed).fault);
        assert!(faults[..8].iter().all(|fault| *fault == Fault::None));
        assert_eq!(faults[8], Fault::SpindleSlow);
    }

    #[test]
    fn a_path_without_a_change_was_not_cut() {
        let mut p = Parameters::START;
        let mut tool = ToolMonitor::default();
        for k in 0..500 {
            // the last bit flickers
            tool.update(&p, 1880.0 + 0.51 * f64::from(k % 2));
        }
        assert_eq!(tool.after_run(&p).fault, Fault::NoCut);
        p.limits.spindle_change = 0.0;
        assert_eq!(tool.after_run(&p).fault, Fault::None);
        p.limits.spindle_change = 2.0;
        for _ in 0..8 {
            tool.update(&p, 1860.0);
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
                tool.update(&p, if (201..201 + bad).contains(&k) { 1860.0 } else { 1880.0 });
            }
            assert_eq!(tool.after_run(&p).fault, Fault::NoCut, "{bad}");
        }
        let mut tool = ToolMonitor::default();
        for k in 0..500 {
            tool.update(&p, 1880.0 + 30.0 * (2.3 * f64::from(k)).sin());
        }
        assert_eq!(tool.after_run(&p).fault, Fault::NoCut);
    }
}
