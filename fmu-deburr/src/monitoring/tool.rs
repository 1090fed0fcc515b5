//! The tool's speed while it cuts: too slow, standing under load, or the same along a way or the whole path.
//!
//! A speed counts only where it holds: of each block of one sample more than are bridged the slowest block is known by its
//! fastest sample, and the fastest block by its slowest one. So neither a bad sample nor noise is a cut.
//!
//! Under load a speed moves with the burr; where it stands all the same, the burr is even or the reading is frozen. So the
//! tool is asked: the feed stops, and the load with it. From a slip of four times the band a tool of time constant tau has
//! left the band after 0.29 tau, and its reading a lag later; one that has not by then is frozen.

use control_blocks::{Consecutive, Frozen, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::finding::{Finding, Numbers};

/// Slip under load, in bands within which a reading stands.
const LOADED: f64 = 4.0;
/// Time after which a reading that stands under load is asked, s.
const STANDS: f64 = 0.2;
/// Time in which the tool answers once the feed stands, s: more than the longest time constant of the paper, 0.25 s.
const ANSWERS: f64 = 0.3;

/// What is seen of the tool along one path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolMonitor {
    slow: Consecutive,
    /// slowest and fastest of the present block, rad/s, and its samples
    block: Option<(f64, f64)>,
    count: u32,
    /// slowest and fastest that held for a block, rad/s
    held: Option<(f64, f64)>,
    /// way since the tool was loaded, m; none before the first time, because a part may be begun again
    idle: Option<f64>,
    reading: Frozen,
    asked: bool,
    /// samples without feed in which the tool did not answer
    silent: Consecutive,
}

impl ToolMonitor {
    /// Begins a path.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Takes the tool speed (rad/s) of a sample in which the tool cuts, and the way since the last one (m).
    pub fn update(&mut self, p: &Parameters, speed: f64, way: f64) -> Finding {
        let (least, bridged) = (p.limits.spindle_speed_min, p.limits.lost_samples.unsigned_abs());
        self.hold(p, speed, way);
        if self.slow.update(speed < least) > bridged {
            return Finding::beyond(Fault::SpindleSlow, speed, least);
        }
        let band = p.limits.spindle_change;
        self.reading.update(speed, 0.0, band);
        let slip = self.held.map_or(0.0, |(_, fastest)| fastest - speed);
        self.asked = band > 0.0 && slip > LOADED * band && self.reading.still() > ticks(STANDS, p.sample_period);
        if self.silent.update(self.asked && way == 0.0) > ticks(ANSWERS, p.sample_period) {
            return Finding {
                fault: Fault::FrozenReading,
                numbers: Numbers { value: slip, limit: band, ..Numbers::START },
            };
        }
        let most = p.limits.idle_way;
        if band > 0.0 && most > 0.0 && self.idle.is_some_and(|way| way > most) {
            return Finding {
                fault: Fault::NoCut,
                numbers: Numbers { share: self.idle, limit: most, ..Numbers::START },
            };
        }
        Finding::NONE
    }

    /// Whether the feed has to stop, so that the tool shows that its reading lives.
    pub fn asks(&self) -> bool {
        self.asked
    }

    fn hold(&mut self, p: &Parameters, speed: f64, way: f64) {
        let (slowest, fastest) = self.block.unwrap_or((speed, speed));
        let block = (slowest.min(speed), fastest.max(speed));
        (self.block, self.count) = (Some(block), self.count + 1);
        self.idle = self.idle.map(|idle| idle + way);
        if self.count > p.limits.lost_samples.unsigned_abs() {
            let (slowest, fastest) = self.held.unwrap_or((block.1, block.0));
            let held = (slowest.min(block.1), fastest.max(block.0));
            (self.block, self.count, self.held) = (None, 0, Some(held));
            if held.1 - block.1 >= p.limits.spindle_change {
                self.idle = Some(0.0);
            }
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

    /// The fault, and in which sample, of a tool that runs idle, then at a speed as a function of its samples; the feed of
    /// 1 mm a sample stops within 20 samples where it is asked to.
    fn cutting(p: &Parameters, speed: impl Fn(usize, f64) -> f64) -> (Fault, usize) {
        let (mut tool, mut way) = (ToolMonitor::default(), 1e-3);
        (0..8).for_each(|_| assert!(!tool.update(p, 1884.0, 0.0).is_fault()));
        for k in 0..400 {
            let fault = tool.update(p, speed(k, way), way).fault;
            if fault != Fault::None {
                return (fault, k);
            }
            way = if tool.asks() { f64::max(way - 5e-5, 0.0) } else { 1e-3 };
            way = if way < 1e-9 { 0.0 } else { way };
        }
        (Fault::None, 400)
    }

    #[test]
    fn a_reading_that_stands_under_load_is_asked_and_one_that_does_not_answer_is_frozen() {
        let mut p = Parameters::START;
        let flickers = |k: usize| if k.is_multiple_of(2) { 0.51 } else { 0.0 };
        // 0.2 s until it is asked, 0.2 s until the feed stands, 0.3 s without an answer
        for flicker in [true, false] {
            let (fault, after) = cutting(&p, |k, _| 1820.0 + if flicker { flickers(k) } else { 0.0 });
            assert_eq!(fault, Fault::FrozenReading);
            assert!((65..75).contains(&after), "{after}");
        }
        // an even burr: the speed follows the feed
        assert_eq!(cutting(&p, |_, way| 1884.0 - 64e3 * way).0, Fault::None);
        assert_eq!(cutting(&p, |_, way| 1884.0 - 9e3 * way).0, Fault::None);
        // a twentieth of the slip at rated load is no load that would have to answer
        p.limits.idle_way = 0.0;
        assert_eq!(cutting(&p, |_, _| 1876.5).0, Fault::None);
        p.limits.spindle_change = 0.0;
        assert_eq!(cutting(&p, |_, _| 1820.0).0, Fault::None);
    }

    #[test]
    fn a_way_without_a_cut_is_told_where_it_is_longer_than_the_longest_gap() {
        let mut p = Parameters::START;
        // cuts for 50 mm
        let gap = |length: usize| {
            move |k: usize, _: f64| if k % (50 + length) < 50 { 1850.0 - (k % 7) as f64 } else { 1884.0 }
        };
        assert_eq!(cutting(&p, gap(90)).0, Fault::None);
        let (fault, after) = cutting(&p, gap(200));
        assert_eq!(fault, Fault::NoCut);
        assert!((147..=154).contains(&after), "{after}");
        p.limits.idle_way = 0.0;
        assert_eq!(cutting(&p, gap(200)).0, Fault::None);
    }
}
