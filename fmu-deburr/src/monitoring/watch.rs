//! All axes against the models of their loops.

use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::axis::{AxisMonitor, Expectation, Motion, Outcome};
use crate::monitoring::finding::{Finding, Numbers};
use crate::monitoring::flicker::{AxisPosition, Flicker};
use crate::monitoring::rest::RestError;
use crate::path::kinematics::{AXES, Joints};

/// Six monitors, how their measurements flicker, and what is left in the rest after a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Watch {
    axes: [AxisMonitor; AXES],
    flicker: [Flicker; AXES],
    /// the same where all axes rest, in whichever job or none, and whether the tool runs
    resting: [Flicker; AXES],
    tool: bool,
    rest: RestError,
}

impl Watch {
    /// At rest at zero.
    pub fn new(p: &Parameters) -> Self {
        Self {
            axes: std::array::from_fn(|i| AxisMonitor::new(p, i)),
            flicker: [Flicker::default(); AXES],
            resting: [Flicker::default(); AXES],
            tool: false,
            rest: RestError::default(),
        }
    }

    /// The loops close at rest at these positions, rad or m.
    pub fn restart(&mut self, p: &Parameters, positions: &Joints) {
        for (i, axis) in self.axes.iter_mut().enumerate() {
            axis.restart(positions[i], p.axis[i].pulse);
        }
        self.resting = [Flicker::default(); AXES];
    }

    /// Looks at all axes: positions, commanded motions (rad or m) and errors (counts). The first that is wrong.
    pub fn look(
        &mut self,
        p: &Parameters,
        positions: &Joints,
        motions: &Joints,
        error: &Joints,
        expected: Expectation,
    ) -> Outcome {
        let mut first = Outcome::Good;
        for (i, axis) in self.axes.iter_mut().enumerate() {
            let motion = Motion { position: positions[i], commanded: motions[i], error: error[i] * p.axis[i].pulse };
            let outcome = axis.look(p, i, &motion, expected);
            if first == Outcome::Good || matches!((first, outcome), (Outcome::Grown, Outcome::Wrong(_))) {
                first = outcome;
            }
        }
        first
    }

    /// Takes what was sent: references and compensations in counts, and velocity commands (rad/s or m/s).
    pub fn command(&mut self, p: &Parameters, reference: &Joints, compensation: &Joints, velocity: &Joints) {
        for (i, axis) in self.axes.iter_mut().enumerate() {
            axis.command(p, i, reference[i], compensation[i], velocity[i]);
        }
    }

    /// Begins a task: a tool that runs or not may shake the measurements.
    pub fn begin_task(&mut self) {
        self.flicker = [Flicker::default(); AXES];
    }

    /// Looks at how the measurements (rad or m) of a task that continues flicker, undisturbed by a cut or not. The
    /// first that is frozen.
    pub fn look_at_flicker(&mut self, p: &Parameters, positions: &Joints, undisturbed: bool) -> Finding {
        let found: [Finding; AXES] = std::array::from_fn(|i| {
            let axis_position = AxisPosition { position: positions[i], model: self.axes[i].model(p.axis[i].pulse) };
            self.flicker[i].update(p, i, axis_position, self.axes[i].rests(p, i), undisturbed)
        });
        found.into_iter().find(Finding::is_fault).unwrap_or(Finding::NONE)
    }

    /// Evaluates how the positions (rad or m) flicker in rests, before, between and in tasks, with a `tool` that runs
    /// or not: the noise of one rest is known in the next. Positions on the path do not measure it. One that is
    /// constant since the rest before is used there. Returns the first that is frozen.
    pub fn look_at_rests(&mut self, p: &Parameters, positions: &Joints, tool: bool, on_path: bool) -> Finding {
        // what runs or not may shake the measurements
        if std::mem::replace(&mut self.tool, tool) != tool {
            self.forget_rests();
        }
        let rests: [bool; AXES] = std::array::from_fn(|i| self.axes[i].rests(p, i));
        let undisturbed = !on_path && rests.iter().all(|rests| *rests);
        let found: [Finding; AXES] = std::array::from_fn(|i| {
            let axis_position = AxisPosition { position: positions[i], model: self.axes[i].model(p.axis[i].pulse) };
            self.resting[i].watch(p, i, axis_position, rests[i], undisturbed)
        });
        found.into_iter().find(Finding::is_fault).unwrap_or(Finding::NONE)
    }

    /// The task is held.
    pub fn pause(&mut self) {
        self.flicker.iter_mut().for_each(Flicker::pause);
    }

    /// Interrupts the evaluation of the flicker in rests; the constant intervals start again after it.
    pub fn pause_rests(&mut self) {
        self.resting.iter_mut().for_each(Flicker::pause);
    }

    /// Nothing is known of the noise in rests.
    pub fn forget_rests(&mut self) {
        self.resting = [Flicker::default(); AXES];
    }

    /// All axes come to rest.
    pub fn settle(&mut self) {
        self.flicker.iter_mut().for_each(Flicker::settle);
    }

    /// Counts that were lost are those of a motion: it begins, or there is none.
    pub fn forget_slips(&mut self) {
        self.axes.iter_mut().for_each(AxisMonitor::forget_slips);
    }

    /// Begins a run.
    pub fn begin_run(&mut self) {
        self.rest = RestError::default();
        self.forget_slips();
    }

    /// Takes a sample of the rest after a run.
    pub fn rests(&mut self, p: &Parameters, positions: &Joints) {
        let residual = std::array::from_fn(|i| self.axes[i].residual(positions[i], p.axis[i].pulse));
        self.rest.update(&residual, &std::array::from_fn(|i| self.axes[i].allowance()));
    }

    /// First fault in the rest after a run: `FollowingError` for an axis whose mean distance from the model exceeds
    /// `rest_error` plus the allowance for a slow drive, then `PositionFrozen`; otherwise none.
    pub fn after_run(&self, p: &Parameters) -> Finding {
        let (mean, allowed) = self.rest.means();
        let limit = |i: usize| p.limits.axis[i].rest_error + allowed[i];
        let offset = (0..AXES).find(|i| mean[*i].abs() > limit(*i)).map(|i| {
            let numbers = Numbers { axis: i as i32 + 1, value: mean[i].abs(), limit: limit(i), ratio: None };
            Finding { fault: Fault::FollowingError, numbers }
        });
        let frozen = || (0..AXES).map(|i| self.flicker[i].after_run(p, i)).find(Finding::is_fault);
        offset.or_else(frozen).unwrap_or(Finding::NONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Finding of the rest after a run for an axis `i` that rests at an `offset` from its reference, after a motion by
    /// `counts`.
    fn rested(i: usize, offset: f64, counts: f64) -> Finding {
        let p = Parameters::START;
        let mut watch = Watch::new(&p);
        let mut positions = [0.0; AXES];
        watch.restart(&p, &positions);
        let mut reference = [0.0; AXES];
        reference[i] = counts;
        watch.command(&p, &reference, &[0.0; AXES], &[0.0; AXES]);
        // the rest of the previous run is discarded
        watch.rests(&p, &[1.0; AXES]);
        watch.begin_run();
        positions[i] = offset;
        (0..10).for_each(|_| watch.rests(&p, &positions));
        watch.after_run(&p)
    }

    #[test]
    fn an_axis_away_from_its_reference_at_rest_is_reported_with_its_number_and_limit() {
        let p = Parameters::START;
        for i in 0..AXES {
            let limit = p.limits.axis[i].rest_error;
            for side in [1.0, -1.0] {
                assert_eq!(rested(i, 0.99 * side * limit, 0.0), Finding::NONE);
                let found = rested(i, 1.01 * side * limit, 0.0);
                assert_eq!((found.fault, found.numbers.axis), (Fault::FollowingError, i as i32 + 1));
                assert!((found.numbers.value - 1.01 * limit).abs() < 1e-12 && found.numbers.limit == limit);
            }
        }
        assert_eq!(Watch::new(&p).after_run(&p), Finding::NONE);
    }

    /// Axis 5 at rest with a noise of two counts for 180 samples, then the same measurement for half a second.
    fn frozen(meanwhile: impl Fn(&mut Watch, usize)) -> (Watch, Finding) {
        let p = Parameters::START;
        let (mut watch, mut positions, mut found) = (Watch::new(&p), [0.0; AXES], Finding::NONE);
        watch.restart(&p, &positions);
        for k in 0..230 {
            watch.command(&p, &[0.0; AXES], &[0.0; AXES], &[0.0; AXES]);
            meanwhile(&mut watch, k);
            if k < 180 {
                positions[4] = [2.0, -1.0, 1.0, -2.0, 0.0, -1.0, 2.0][k % 7] * p.axis[4].pulse;
            }
            let now = watch.look_at_flicker(&p, &positions, true);
            found = if found.is_fault() { found } else { now };
        }
        (watch, found)
    }

    #[test]
    fn a_frozen_measurement_is_reported_with_its_axis_except_in_another_task_or_where_it_is_held() {
        let (_, found) = frozen(|_, _| {});
        assert_eq!(found, Finding::NONE);
        let p = Parameters::START;
        let longer = |begin: usize, pause: usize| {
            let (mut watch, _) = frozen(|watch, k| {
                if k == begin {
                    watch.begin_task();
                }
            });
            let mut positions = [0.0; AXES];
            positions[4] = [2.0, -1.0, 1.0, -2.0, 0.0, -1.0, 2.0][179 % 7] * p.axis[4].pulse;
            for k in 0..20 {
                if k == pause {
                    watch.pause();
                }
                watch.command(&p, &[0.0; AXES], &[0.0; AXES], &[0.0; AXES]);
                watch.look_at_flicker(&p, &positions, true);
            }
            let found = watch.after_run(&p);
            (found.fault, found.numbers.axis)
        };
        assert_eq!(longer(0, 99), (Fault::PositionFrozen, 5));
        assert_eq!(longer(179, 99).0, Fault::None);
        assert_eq!(longer(0, 5).0, Fault::None);
    }

    /// Finding of the rests for axis 5 with a noise of two counts for 300 samples, then constant for 200.
    fn rested_with(meanwhile: impl Fn(&mut Watch, usize) -> (f64, bool, bool)) -> (Fault, i32) {
        let p = Parameters::START;
        let (mut watch, mut positions) = (Watch::new(&p), [0.0; AXES]);
        watch.restart(&p, &positions);
        for k in 0..500 {
            let (moves, tool, on_path) = meanwhile(&mut watch, k);
            watch.command(&p, &[moves, 0.0, 0.0, 0.0, 0.0, 0.0], &[0.0; AXES], &[0.0; AXES]);
            if k < 300 {
                positions[4] = [2.0, -1.0, 1.0, -2.0, 0.0, -1.0, 2.0][k % 7] * p.axis[4].pulse;
            }
            let found = watch.look_at_rests(&p, &positions, tool, on_path);
            if found.is_fault() {
                return (found.fault, found.numbers.axis);
            }
        }
        (Fault::None, 0)
    }

    #[test]
    fn noise_that_was_known_in_a_rest_is_known_in_the_next_whatever_cycle_begins() {
        let detected = (Fault::PositionFrozen, 5);
        assert_eq!(rested_with(|_, _| (0.0, true, false)), detected);
        let tasks = rested_with(|watch, k| {
            if k == 310 {
                watch.begin_task();
                watch.settle();
            }
            (0.0, true, k > 320)
        });
        assert_eq!(tasks, detected);
    }

    #[test]
    fn noise_of_another_tool_of_the_path_of_other_axes_or_before_the_loops_were_closed_is_none() {
        assert_eq!(rested_with(|_, k| (0.0, k < 300, false)).0, Fault::None);
        assert_eq!(rested_with(|_, k| (0.0, true, k < 300)).0, Fault::None);
        assert_eq!(rested_with(|_, k| (if k < 300 { 50.0 * k as f64 } else { 15_000.0 }, true, false)).0, Fault::None);
        let closed = rested_with(|watch, k| {
            if k == 300 {
                watch.restart(&Parameters::START, &[0.0; AXES]);
            }
            (0.0, true, false)
        });
        assert_eq!(closed.0, Fault::None);
        let elsewhere = rested_with(|watch, k| {
            if k % 40 == 0 {
                watch.pause_rests();
            }
            (0.0, true, false)
        });
        assert_eq!(elsewhere.0, Fault::None);
    }

    #[test]
    fn the_lag_of_a_motion_is_allowed_in_addition() {
        let p = Parameters::START;
        // half of V/Kp of 5 counts in a sample; the model has not moved yet
        let limit = p.limits.axis[2].rest_error + 0.5 * 5.0 * p.axis[2].pulse / (p.servo_gain[2] * p.sample_period);
        assert_eq!(rested(2, 0.99 * limit, 5.0), Finding::NONE);
        assert!((rested(2, 1.01 * limit, 5.0).numbers.limit - limit).abs() < 1e-12);
    }

    #[test]
    fn the_first_axis_that_is_wrong_is_reported_and_a_fault_before_a_pattern_that_grows() {
        let p = Parameters::START;
        let detected = |expected, axis_position: [f64; 2], errors: [f64; 2]| {
            let mut watch = Watch::new(&p);
            watch.restart(&p, &[0.0; AXES]);
            let (mut positions, mut error) = ([0.0; AXES], [0.0; AXES]);
            for k in 0..2 {
                (positions[k + 1], error[k + 1]) = (axis_position[k], errors[k] / p.axis[k + 1].pulse);
            }
            let verdicts = [(); 4].map(|()| watch.look(&p, &positions, &[0.0; AXES], &error, expected));
            match verdicts[3] {
                Outcome::Wrong(finding) => finding.numbers.axis,
                Outcome::Good => 0,
                Outcome::Grown => -1,
            }
        };
        let far = 2e-3;
        assert_eq!(detected(Expectation::Bare, [far, far], [0.0; 2]), 2);
        assert_eq!(detected(Expectation::Bare, [0.0, far], [0.0; 2]), 3);
        assert_eq!(detected(Expectation::Learned, [0.0; 2], [far, 0.0]), -1);
        assert_eq!(detected(Expectation::Learned, [0.0, far], [far, 0.0]), 3);
        assert_eq!(detected(Expectation::Learned, [far, 0.0], [0.0, far]), 2);
        assert_eq!(detected(Expectation::Bare, [0.0; 2], [0.0; 2]), 0);
    }
}
