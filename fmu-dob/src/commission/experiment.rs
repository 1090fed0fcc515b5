//! The motion of a commissioning run: retract to a center, excite there, return, and four strokes at the approach
//! speed.
//!
//! It never moves beyond its start position, towards the workpiece.

use control_blocks::{PeriodicSpectra, Quintic, Trajectory};
use serde::{Deserialize, Serialize};

use crate::commission::noise::Noise;
use crate::commission::plan::{Plan, REVERSAL_TIME, STROKES};
use crate::interface::{ForceOutput, Parameters};

/// Part of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    Back,
    Excite,
    Return,
    Strokes,
}

/// Milestone of this sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Milestone {
    /// Nothing new.
    None,
    /// The excitation is over: the response can be identified.
    Excited,
    /// The strokes are over, and the stage is back.
    Finished,
}

/// One experiment, sample by sample.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Experiment {
    /// Its motions.
    pub plan: Plan,
    /// Answer to the excitation: current and position.
    pub spectra: PeriodicSpectra,
    /// Noise of the strokes.
    pub noise: Noise,
    phase: Phase,
    /// samples of this phase, of a stroke those at constant speed
    tick: u32,
    strokes: u32,
    start: f64,
    motion: Quintic,
    /// last position, from the start
    displacement: f64,
}

impl Experiment {
    /// An experiment that begins at rest at `start` m.
    pub fn new(p: &Parameters, start: f64) -> Self {
        let plan = Plan::new(p);
        let motion = Quintic::new(Trajectory::resting(start), start - plan.back, plan.stroke_time);
        Self {
            plan,
            spectra: PeriodicSpectra::default(),
            noise: Noise::new(p),
            phase: Phase::Back,
            tick: 0,
            strokes: 0,
            start,
            motion,
            displacement: 0.0,
        }
    }

    /// Whether the stage is held by the servo of the plan, without any model.
    pub fn exciting(&self) -> bool {
        matches!(self.phase, Phase::Back | Phase::Excite)
    }

    /// Tolerated motion (m) of the reference without a change of the position at its reversals: those of the
    /// excitation, or that of a stroke or return whose reference changes its speed with `acceleration` (m/s2).
    pub fn unanswered(&self, acceleration: f64) -> f64 {
        if self.exciting() { self.plan.unanswered() } else { acceleration.abs() * REVERSAL_TIME * REVERSAL_TIME }
    }

    /// Whether all strokes are over.
    pub fn over(&self) -> bool {
        self.strokes >= STROKES
    }

    /// The reference of this sample after that of the one before.
    pub fn reference(&mut self, now: &Trajectory, dt: f64) -> Trajectory {
        let time = f64::from(self.tick + 1) * dt;
        match self.phase {
            Phase::Back | Phase::Return => self.motion.at(time),
            Phase::Excite => {
                let mut next = self.plan.excitation.at(self.tick + 1);
                next.position += self.start - self.plan.back;
                next
            }
            Phase::Strokes => {
                let mut next = *now;
                next.step(self.stroke_speed(), self.plan.approach.acceleration, dt);
                next
            }
        }
    }

    /// Takes position (m) and current (A) of this sample, and continues.
    pub fn observe(
        &mut self,
        p: &Parameters,
        position: Option<f64>,
        current: f64,
        force: &ForceOutput,
        reference: &Trajectory,
    ) -> Milestone {
        // a lost position is bridged by that of the reference
        self.displacement = position.unwrap_or(reference.position) - self.start;
        match self.phase {
            Phase::Back => self.arrive(Phase::Excite, p),
            Phase::Excite => return self.excite(p, current),
            Phase::Return => self.arrive(Phase::Strokes, p),
            Phase::Strokes => return self.learn(position, force, reference),
        }
        Milestone::None
    }

    fn arrive(&mut self, next: Phase, p: &Parameters) {
        self.tick += 1;
        if self.motion.over(f64::from(self.tick) * p.sample_period) {
            (self.phase, self.tick) = (next, 0);
        }
    }

    fn excite(&mut self, p: &Parameters, current: f64) -> Milestone {
        if self.plan.excitation.measures(self.tick) {
            self.spectra.update(self.plan.excitation.sines.period, current, self.displacement);
        }
        self.tick += 1;
        if self.tick < self.plan.excitation.samples() {
            return Milestone::None;
        }
        let centre = Trajectory::resting(self.start - self.plan.back);
        self.motion = Quintic::new(centre, self.start, self.plan.stroke_time);
        self.noise = Noise::new(p);
        (self.phase, self.tick) = (Phase::Return, 0);
        Milestone::Excited
    }

    /// Speed of this stroke (m/s), 0 when it has had enough.
    fn stroke_speed(&self) -> f64 {
        let [settle, gather] = self.plan.stroke;
        let towards = if self.strokes.is_multiple_of(2) { -1.0 } else { 1.0 };
        if self.tick < settle + gather { towards * self.plan.approach.velocity } else { 0.0 }
    }

    fn learn(&mut self, position: Option<f64>, force: &ForceOutput, reference: &Trajectory) -> Milestone {
        let [settle, gather] = self.plan.stroke;
        if self.tick < settle + gather {
            if reference.velocity == self.stroke_speed() {
                if self.tick >= settle {
                    self.noise.take(position.map(|_| self.displacement), force);
                }
                self.tick += 1;
            }
        } else if reference.velocity == 0.0 {
            self.noise.close();
            (self.strokes, self.tick) = (self.strokes + 1, 0);
        }
        if self.over() { Milestone::Finished } else { Milestone::None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stroke_may_leave_its_reversal_unanswered_while_it_brakes_and_nothing_at_its_speed() {
        let p = Parameters::START;
        let mut experiment = Experiment::new(&p, 0.0);
        assert_eq!(experiment.unanswered(0.0), experiment.plan.unanswered());
        experiment.phase = Phase::Strokes;
        // 0.05 m/s2 for 1 ms, and that speed for as long
        for (acceleration, left) in [(0.0, 0.0), (0.05, 50e-9), (-0.05, 50e-9)] {
            assert!((experiment.unanswered(acceleration) - left).abs() < 1e-18, "{acceleration}");
        }
    }
}
