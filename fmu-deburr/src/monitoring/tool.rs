//! The tool's speed while it cuts: too slow, or the same all along the path.

use control_blocks::Consecutive;
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::finding::Finding;

/// What is seen of the tool along one path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolMonitor {
    slow: Consecutive,
    /// slowest and fastest, rad/s
    seen: Option<(f64, f64)>,
}

impl ToolMonitor {
    /// Begins a path.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Takes the tool speed (rad/s) of a sample in which the tool cuts.
    pub fn update(&mut self, p: &Parameters, speed: f64) -> Finding {
        let (slowest, fastest) = self.seen.unwrap_or((speed, speed));
        self.seen = Some((slowest.min(speed), fastest.max(speed)));
        let least = p.limits.spindle_speed_min;
        if self.slow.update(speed < least) > p.limits.lost_samples.unsigned_abs() {
            return Finding::beyond(Fault::SpindleSlow, speed, least);
        }
        Finding::NONE
    }

    /// What is wrong with a path that has come to its end: nothing was cut.
    pub fn after_run(&self, p: &Parameters) -> Finding {
        let change = self.seen.map_or(0.0, |(slowest, fastest)| fastest - slowest);
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
        tool.update(&p, 1860.0);
        assert_eq!(tool.after_run(&p).fault, Fault::None);
        tool.restart();
        assert_eq!(tool.after_run(&p).fault, Fault::NoCut);
    }
}
