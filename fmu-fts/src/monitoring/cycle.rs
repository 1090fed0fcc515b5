//! Time limit of a task.

use std::f64::consts::TAU;

use control_blocks::{Progress, quintic_duration};

use crate::interface::{Parameters, State};
use crate::path::path_table::PathTable;

/// The slowest feed of a cut, m/s.
const SLOWEST: f64 = 1e-6;

/// Time of a task beyond its limit, and the limit, s: a cut, an identification of `identify` s, or a commissioning run
/// that may take `commission` s. Holding has no end.
pub fn late(
    p: &Parameters,
    path: &PathTable,
    [identify, commission]: [f64; 2],
    state: State,
    cycle: &Progress,
) -> Option<[f64; 2]> {
    let limit = |usual: f64| if p.limits.cycle_time > 0.0 { p.limits.cycle_time } else { usual };
    let limit = match state {
        State::Approach | State::Ready | State::Track => limit(path.extent() / SLOWEST),
        // before it, at most two revolutions to `hold_angle` and the motion off the path
        State::Identify => limit(2.0 * (identify + p.approach_time + quintic_duration(2.0 * TAU, p.hold_speed))),
        State::Commission => commission,
        _ => return None,
    };
    let time = cycle.samples() as f64 * p.sample_period;
    (time > limit).then_some([time, limit])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::depth_table::DepthTable;
    use crate::path::kinematics::Arm;

    #[test]
    fn a_task_may_last_for_the_cycle_time_or_twice_the_measurement() {
        let mut p = Parameters::START;
        let path = PathTable::new(Arm::new(&p), &DepthTable::of_surface(&p).unwrap(), 24);
        let limit = |p: &Parameters, state: State, time: f64| {
            let mut cycle = Progress::default();
            (0..(time / p.sample_period) as u32).for_each(|_| cycle.count());
            late(p, &path, [1.0, 3.0], state, &cycle).map(|[_, limit]| limit)
        };
        // 1 s of measurement, 0.3 s of approach, two revolutions on a quintic of 2 rad/s
        let maximum = 2.0 * (1.3 + quintic_duration(2.0 * TAU, 2.0));
        assert_eq!(limit(&p, State::Identify, maximum - 0.01), None);
        assert_eq!(limit(&p, State::Identify, maximum + 0.01), Some(maximum));
        assert_eq!((limit(&p, State::Hold, 100.0), limit(&p, State::Track, 100.0)), (None, None));
        p.limits.cycle_time = 0.5;
        assert_eq!((limit(&p, State::Commission, 2.99), limit(&p, State::Commission, 3.01)), (None, Some(3.0)));
        assert_eq!((limit(&p, State::Track, 0.49), limit(&p, State::Track, 0.51)), (None, Some(0.5)));
        assert_eq!(limit(&p, State::Hold, 0.51), None);
    }
}
