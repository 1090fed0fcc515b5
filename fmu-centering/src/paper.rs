//! The paper's mode: one revolution of data, one sine, one push, and again.

use serde::{Deserialize, Serialize};

use crate::centre::Estimate;
use crate::law::{Launch, Moment};
use crate::machine::{Fault, State, Verdict};
use crate::model::SineModel;
use crate::offset::{Learner, Stroke};
use crate::parameters::Parameters;
use crate::plan::{LeadPlanner, Scene};

/// The law between two samples; by default before its first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Paper {
    model: SineModel,
    planner: LeadPlanner,
    learner: Learner,
    estimate: Option<Estimate>,
    /// the last push, until the model after it
    stroke: Option<Stroke>,
}

impl Paper {
    /// Collects the surface.
    pub fn observe(&mut self, p: &Parameters, now: &Moment) {
        // a probe without contact shows the slide, not the surface
        if now.due.collect && now.state == State::Collect && now.sample.probe >= p.probe.contact {
            self.model.update(p, now.angle, now.sample.tip());
        }
    }

    /// Whether the collection is complete.
    pub fn collected(&self) -> bool {
        self.model.complete()
    }

    /// Makes the model and learns from the last push.
    ///
    /// # Errors
    /// [`Fault::Spindle`] when the data do not determine the model.
    pub fn conclude(&mut self, p: &Parameters) -> Result<(Option<Estimate>, Verdict), Fault> {
        let ring = self.model.estimate().ok_or(Fault::Spindle)?;
        if let Some(stroke) = self.stroke.take() {
            self.learner.learn(&p.offset, &stroke, &ring);
        }
        self.estimate = Some(ring);
        let centred = ring.centre.eccentricity() <= p.tolerance;
        Ok((Some(ring), if centred { Verdict::Centred } else { Verdict::Push }))
    }

    /// The push, in the control beat of its launch.
    pub fn launch(&mut self, p: &Parameters, now: &Moment) -> Option<Launch> {
        let before = self.estimate.filter(|_| now.due.control)?;
        let scene = Scene {
            estimate: &before,
            angle: now.angle,
            speed: now.speed,
            sample: now.sample,
            offset: self.learner.offset(),
        };
        let push = self.planner.update(p, &scene)?;
        self.stroke = Some(Stroke { before, remaining: 0.0 });
        Some(Launch { distance: push.distance, velocity: push.velocity, lead: push.lead, end: Some(push.end) })
    }

    /// What happens once, when `state` begins.
    pub fn enter(&mut self, p: &Parameters, state: State, now: &Moment) {
        match (state, &mut self.stroke) {
            (State::Collect, _) => self.model = SineModel::default(),
            (State::Wait, _) => self.planner = LeadPlanner::default(),
            (State::Settle, Some(stroke)) => stroke.remaining = p.probe.at_pusher - now.sample.probe,
            _ => {}
        }
    }

    /// Learned offset P, m.
    pub fn offset(&self) -> f64 {
        self.learner.offset()
    }
}
