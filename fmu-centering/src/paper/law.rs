//! The paper's law: one revolution of data, one sine, one push, and again.

use control_blocks::Trajectory;
use serde::{Deserialize, Serialize};

use crate::centre::Estimate;
use crate::interface::{Fault, Parameters, State};
use crate::law::{CentringLaw, Conclusion, Launch, Observation, Verdict};
use crate::motion::Motion;
use crate::paper::model::SineModel;
use crate::paper::offset::{LastStroke, Learner};
use crate::paper::plan::{LeadPlanner, Situation};
use crate::sensing::{Despiker, Measurement};

/// The law between two samples; by default before its first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PaperLaw {
    despiker: Despiker,
    model: SineModel,
    planner: LeadPlanner,
    learner: Learner,
    estimate: Option<Estimate>,
    /// the last push, until the model after it
    stroke: Option<LastStroke>,
}

impl CentringLaw for PaperLaw {
    fn restart(&mut self, _: &Parameters) {
        *self = Self::default();
    }

    fn observe(&mut self, p: &Parameters, now: &Observation) {
        // a probe without contact shows the slide, not the surface
        if now.sample.probe < p.probe.contact {
            self.despiker = Despiker::default();
            return;
        }
        let sample = &now.sample;
        let seen = self.despiker.update(Measurement { angle: now.angle, slide: sample.slide, tip: sample.tip() });
        if let Some(seen) = seen.filter(|_| now.due.collect && now.state == State::Collect) {
            self.model.update(p, seen.angle, seen.tip);
        }
    }

    fn collected(&self) -> bool {
        self.model.complete()
    }

    fn conclude(&mut self, p: &Parameters, now: &Observation) -> Option<Result<Conclusion, Fault>> {
        (now.state == State::Model && now.due.model).then(|| self.model_of_the_ring(p))
    }

    fn launch(&mut self, p: &Parameters, now: &Observation) -> Option<Launch> {
        let before = self.estimate.filter(|_| now.due.control)?;
        let situation = Situation {
            estimate: &before,
            angle: now.angle,
            speed: now.speed,
            sample: now.sample,
            offset: self.learner.offset(),
        };
        let push = self.planner.update(p, &situation)?;
        self.stroke = Some(LastStroke { before, remaining: 0.0 });
        Some(Launch { distance: push.distance, velocity: push.velocity, lead: push.lead, end: Some(push.end) })
    }

    fn enter(&mut self, p: &Parameters, state: State, now: &Observation) {
        match (state, &mut self.stroke) {
            (State::Collect, _) => self.model = SineModel::default(),
            (State::Wait, _) => self.planner = LeadPlanner::default(),
            (State::Settle, Some(stroke)) => stroke.remaining = p.probe.at_pusher - now.sample.probe,
            _ => {}
        }
    }

    fn press(&mut self, _: &Parameters, _: &Observation) -> Option<Trajectory> {
        None
    }

    fn astray(&self, _: &Parameters) -> bool {
        false
    }

    fn ahead(&self) -> f64 {
        0.0
    }

    fn stroke_over(&self, p: &Parameters, motion: &Motion) -> bool {
        motion.arrived(p, p.push.dwell)
    }

    fn offset(&self) -> f64 {
        self.learner.offset()
    }
}

impl PaperLaw {
    /// Makes the model and learns from the last push.
    ///
    /// # Errors
    /// [`Fault::Spindle`] when the data do not determine the model.
    fn model_of_the_ring(&mut self, p: &Parameters) -> Result<Conclusion, Fault> {
        let ring = self.model.estimate().ok_or(Fault::Spindle)?;
        if let Some(stroke) = self.stroke.take() {
            self.learner.learn(&p.offset, &stroke, &ring);
        }
        self.estimate = Some(ring);
        let centred = ring.centre.eccentricity() <= p.tolerance;
        Ok((Some(ring), if centred { Verdict::Centred } else { Verdict::Push }))
    }
}
