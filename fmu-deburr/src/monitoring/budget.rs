//! Time limit of a task.
//!
//! One run takes a rest, its length at its slowest speed, and another rest. Before it there are the legs of the motion to
//! the start, each at most through the whole travel of the slowest axis. The limit is twice that for every run.

use control_blocks::{quintic_duration, ticks};

use crate::interface::{Mode, Parameters};
use crate::path::programmed_path::ProgrammedPath;
use crate::path::transfer::VELOCITY_RATIO;

/// Budget over the time that is planned.
const MARGIN: f64 = 2.0;
/// Legs of a motion to the start.
const LEGS: f64 = 3.0;
/// Slowest feed that a task is planned with, ratio of the programmed speed.
const SLOWEST: f64 = 0.01;

/// Samples that a task may take; of a cyclic path a lap, unless it is learned.
pub fn budget(p: &Parameters, path: &ProgrammedPath, task: Mode) -> u64 {
    let time = if p.limits.cycle_time > 0.0 { p.limits.cycle_time } else { derived(p, path, task) };
    u64::from(ticks(time, p.sample_period))
}

/// Time for a task (s) as the parameters say.
fn derived(p: &Parameters, path: &ProgrammedPath, task: Mode) -> f64 {
    let leg =
        p.axis.iter().map(|axis| quintic_duration(axis.maximum - axis.minimum, axis.velocity_max * VELOCITY_RATIO));
    let approach = LEGS * leg.fold(p.transfer.time, f64::max) + p.transfer.settle_time;
    let rests = f64::from(p.learn.lead_in + p.learn.lead_out) * p.sample_period;
    // up to speed and down again at each stop takes as long as the speed over the acceleration more
    let run = |speed: f64| path.length() / speed + path.stops() as f64 * speed / p.feed.acceleration + rests;
    let runs = match task {
        Mode::Learn => {
            let once: f64 = p.learn.factors.list().iter().map(|factor| approach + run(factor * path.speed)).sum();
            once * f64::from(p.learn.repetitions + 1)
        }
        _ => approach + run(p.load.speed_min.max(SLOWEST * path.speed)),
    };
    MARGIN * runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::pattern::tests::straight;

    #[test]
    fn a_budget_is_given_or_twice_what_the_parameters_need() {
        let (mut p, path) = (Parameters::START, straight(0.2));
        // 0.2 m at 4 mm/s, three legs of 13.3 s (6.4 rad at 0.9 rad/s), rests of 0.8 and 0.7 s
        let once = 3.0 * 1.875 * 6.4 / 0.9 + 0.8 + 0.7 + 50.0 + 0.008;
        assert!((budget(&p, &path, Mode::Deburr) as f64 - 200.0 * once).abs() < 200.0 * 0.01 * once);
        // one stop more; five speeds, the bare run and 19 repetitions
        p.feed.acceleration = 0.04;
        let run = |speed: f64| 3.0 * 1.875 * 6.4 / 0.9 + 0.8 + 0.7 + 0.2 / speed + speed / 0.04;
        assert!((derived(&p, &path, Mode::Deburr) - 2.0 * run(0.004)).abs() < 1e-9);
        let speeds: f64 = [0.1, 0.08, 0.06, 0.04, 0.02].map(run).iter().sum();
        let repetitions = f64::from(p.learn.repetitions + 1);
        assert!((derived(&p, &path, Mode::Learn) - 2.0 * repetitions * speeds).abs() < 1e-6);
        // without a slowest feed of the load control a hundredth of the programmed one
        p.load.speed_min = 0.0;
        assert!((derived(&p, &path, Mode::Deburr) - 2.0 * run(0.001)).abs() < 1e-9);
        // the time of a motion that is given is that of each leg
        p.transfer.time = 50.0;
        assert!((derived(&p, &path, Mode::Deburr) - 2.0 * (run(0.001) + 150.0 - 3.0 * 1.875 * 6.4 / 0.9)).abs() < 1e-9);
        p.limits.cycle_time = 12.0;
        assert_eq!(budget(&p, &path, Mode::Learn), 1200);
    }
}
