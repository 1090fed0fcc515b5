//! The motion of a commissioning run: strokes of one axis after the other, each followed by a rest.

use control_blocks::{Quintic, Trajectory};
use serde::{Deserialize, Serialize};

use crate::commission::plan::{Plan, STROKES, room};
use crate::commission::strokes::Strokes;
use crate::interface::Parameters;
use crate::path::kinematics::{AXES, Joints};

/// One experiment, sample by sample.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Experiment {
    plan: Plan,
    start: Joints,
    /// Number of the axis that moves, from 0; `AXES` when all have moved.
    pub axis: usize,
    /// Reference and control error of that axis in each sample since its first stroke began, counts.
    pub strokes: Strokes,
    stroke: u32,
    /// samples of this stroke
    tick: u32,
    motion: Quintic,
    /// reference of the axis
    now: Trajectory,
}

impl Experiment {
    /// At rest at zero, on a path of a speed (m/s).
    pub fn new(p: &Parameters, speed: f64) -> Self {
        let start = [0.0; AXES];
        Self {
            plan: Plan::new(p, speed, &start),
            start,
            axis: 0,
            strokes: Strokes::new(room(p, speed)),
            stroke: 0,
            tick: 0,
            motion: Quintic::resting(0.0),
            now: Trajectory::default(),
        }
    }

    /// Begins at rest at `start` (rad or m).
    pub fn begin(&mut self, p: &Parameters, speed: f64, start: &Joints) {
        (self.plan, self.start) = (Plan::new(p, speed, start), *start);
        self.begin_axis(0);
    }

    /// The next axis begins.
    pub fn go_on(&mut self) {
        self.begin_axis(self.axis + 1);
    }

    fn begin_axis(&mut self, axis: usize) {
        (self.axis, self.stroke, self.tick) = (axis, 0, 0);
        self.strokes.clear();
        if axis < AXES {
            self.begin_stroke(self.start[axis]);
        }
    }

    /// From rest at `from` to the other end of the way.
    fn begin_stroke(&mut self, from: f64) {
        let (start, axis) = (self.start[self.axis], self.axis);
        let goal = if self.stroke.is_multiple_of(2) { start + self.plan.travel[axis] } else { start };
        self.now = Trajectory::resting(from);
        self.motion = Quintic::new(self.now, goal, self.plan.time[axis]);
    }

    /// Moves the reference of the axis on.
    pub fn advance(&mut self, joints: &mut Joints, dt: f64) {
        if self.axis < AXES {
            self.now = self.motion.at(f64::from(self.tick + 1) * dt);
            joints[self.axis] = self.now.position;
        }
    }

    /// Slows the axis down; whether it is at rest.
    pub fn stop(&mut self, joints: &mut Joints, dt: f64) -> bool {
        if self.axis < AXES {
            self.now.step(0.0, self.plan.brake[self.axis], dt);
            joints[self.axis] = self.now.position;
        }
        self.now.velocity == 0.0
    }

    /// Takes the control error (counts) of this sample; whether the strokes of the axis are over.
    pub fn observe(&mut self, p: &Parameters, error: &Joints) -> bool {
        if self.axis >= AXES {
            return false;
        }
        // counts from the start: of a position far away the rates lose digits
        let reference = (self.now.position - self.start[self.axis]) / p.axis[self.axis].pulse;
        self.strokes.take(reference, error[self.axis]);
        self.tick += 1;
        if self.tick == self.plan.samples[self.axis] {
            (self.tick, self.stroke) = (0, self.stroke + 1);
            if self.stroke == STROKES {
                return true;
            }
            self.begin_stroke(self.motion.goal());
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Joints = [0.1, 0.02, 0.7, 0.2, 0.1, -0.3];

    /// References of all samples.
    fn references(p: &Parameters) -> Vec<Joints> {
        let mut experiment = Experiment::new(p, 0.1);
        experiment.begin(p, 0.1, &START);
        let (mut joints, mut all) = (START, vec![START]);
        while experiment.axis < AXES {
            experiment.advance(&mut joints, p.sample_period);
            all.push(joints);
            if experiment.observe(p, &[0.0; AXES]) {
                experiment.go_on();
            }
            assert!(all.len() < 10_000);
        }
        all
    }

    #[test]
    fn each_axis_strokes_alone_within_its_travel_speed_and_acceleration_and_returns() {
        let p = Parameters::START;
        let all = references(&p);
        let plan = Plan::new(&p, 0.1, &START);
        assert_eq!(all.last(), Some(&START));
        for pair in all.windows(2) {
            let moving = (0..AXES).filter(|i| pair[0][*i] != pair[1][*i]).count();
            assert!(moving <= 1);
        }
        let dt = p.sample_period;
        for i in 0..AXES {
            let lever = plan.brake[i].recip() * 0.5;
            let far = all.iter().map(|position| (position[i] - START[i]) / plan.travel[i]);
            let (minimum, maximum) =
                far.fold((0.0f64, 0.0f64), |(minimum, maximum), x| (minimum.min(x), maximum.max(x)));
            assert!(minimum > -1e-9 && (maximum - 1.0).abs() < 1e-9, "{i}: {minimum} {maximum}");
            let fast = all.windows(2).map(|two| (two[1][i] - two[0][i]).abs() / dt).fold(0.0, f64::max);
            assert!(fast * lever < 0.1001, "{i}: {fast}");
            let hard =
                all.windows(3).map(|x| (x[2][i] - 2.0 * x[1][i] + x[0][i]).abs() / (dt * dt)).fold(0.0, f64::max);
            assert!(hard * lever < 0.5001 && hard * lever > 0.2, "{i}: {hard}");
        }
    }

    #[test]
    fn a_stroke_that_is_aborted_is_at_rest_within_its_travel_and_its_deceleration() {
        let p = Parameters::START;
        for samples in [1, 20, 35, 60, 130, 170] {
            let mut experiment = Experiment::new(&p, 0.1);
            experiment.begin(&p, 0.1, &START);
            let mut joints = START;
            for _ in 0..samples {
                experiment.advance(&mut joints, p.sample_period);
                assert!(!experiment.observe(&p, &[0.0; AXES]));
            }
            let stops = (0..100).position(|_| experiment.stop(&mut joints, p.sample_period));
            // 0.1 m/s at 0.5 m/s2
            assert!(stops.is_some_and(|after| after <= 21), "{samples}: {stops:?}");
            let position = joints;
            assert!(experiment.stop(&mut joints, p.sample_period) && joints == position);
            let travel = (joints[0] - START[0]) / experiment.plan.travel[0];
            assert!((-0.31..1.31).contains(&travel) && joints[1..] == START[1..], "{samples}: {travel}");
        }
    }
}
