//! The published control law: one revolution of data, one sine, one push, repeated.

use control_blocks::Trajectory;
use serde::{Deserialize, Serialize};

use crate::center::Estimate;
use crate::interface::{Fault, Parameters, State};
use crate::law::{CenteringLaw, Conclusion, Decision, Launch, Observation};
use crate::motion::Motion;
use crate::paper::model::SineModel;
use crate::paper::offset::{LastStroke, Learner};
use crate::paper::plan::{LeadPlanner, Situation};
use crate::sensing::{Despiker, Measurement};

/// State between two samples; by default before the first.
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

impl CenteringLaw for PaperLaw {
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
            self.model.update(seen.angle, seen.tip);
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

    fn diverged(&self, _: &Parameters) -> bool {
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
    /// Fits the model and learns from the last push.
    ///
    /// # Errors
    /// [`Fault::SpindleUneven`] when the data do not determine the model.
    fn model_of_the_ring(&mut self, p: &Parameters) -> Result<Conclusion, Fault> {
        let ring = self.model.estimate().ok_or(Fault::SpindleUneven)?;
        if let Some(stroke) = self.stroke.take() {
            self.learner.learn(&p.offset, &stroke, &ring);
        }
        self.estimate = Some(ring);
        let centered = ring.center.eccentricity() <= p.tolerance;
        Ok((Some(ring), if centered { Decision::Centered } else { Decision::Push }))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::sensing::{Due, Sample};

    const P: Parameters = Parameters::PAPER;
    /// 20 rpm, rad/s.
    const SPEED: f64 = TAU / 3.0;
    const ALL: Due = Due { control: true, collect: true, model: true };

    /// Sample of a ring `e` m off, nearest at 1 rad, with the slide at rest.
    fn now(state: State, due: Due, e: f64, angle: f64) -> Observation {
        let sample = Sample { angle, slide: 0.1, probe: P.null() + e * (angle - 1.0).cos() };
        Observation {
            state,
            due,
            angle,
            speed: SPEED,
            sample,
            setpoint: Trajectory::default(),
            bandwidth: P.slide.bandwidth,
            late: false,
        }
    }

    /// Law that has collected that ring, in 200 samples a revolution.
    fn collected(e: f64) -> PaperLaw {
        let mut law = PaperLaw::default();
        law.enter(&P, State::Collect, &now(State::Collect, ALL, e, 0.0));
        // the median is two samples late and needs five
        for k in 0..=204 {
            assert!(!law.collected(), "{k}");
            law.observe(&P, &now(State::Collect, ALL, e, TAU * f64::from(k) / 200.0));
        }
        assert!(law.collected());
        law
    }

    fn concluded(law: &mut PaperLaw, e: f64) -> Conclusion {
        law.conclude(&P, &now(State::Model, ALL, e, 0.0)).unwrap().unwrap()
    }

    #[test]
    fn a_revolution_makes_a_model_in_its_state_and_its_beat() {
        let mut law = collected(2e-4);
        for (state, due) in [(State::Collect, ALL), (State::Wait, ALL), (State::Model, Due { model: false, ..ALL })] {
            assert_eq!(law.conclude(&P, &now(state, due, 2e-4, 0.0)), None);
        }
        let (estimate, decision) = concluded(&mut law, 2e-4);
        assert_eq!(decision, Decision::Push);
        // the filter lags by 1.56 samples
        assert!((estimate.unwrap().center.eccentricity() - 2e-4).abs() < 1e-6);
        assert_eq!(concluded(&mut collected(1e-6), 1e-6).1, Decision::Centered);
        assert_eq!(concluded(&mut collected(2.6e-6), 2.6e-6).1, Decision::Push);
    }

    #[test]
    fn what_does_not_determine_a_ring_is_the_spindle() {
        let mut law = PaperLaw::default();
        (0..6).for_each(|_| law.observe(&P, &now(State::Collect, ALL, 1e-4, 1.0)));
        assert_eq!(law.conclude(&P, &now(State::Model, ALL, 1e-4, 1.0)), Some(Err(Fault::SpindleUneven)));
    }

    #[test]
    fn only_what_is_collected_on_the_ring_counts() {
        let mut law = PaperLaw::default();
        for k in 0..300 {
            let angle = TAU * f64::from(k) / 200.0;
            law.observe(&P, &now(State::Wait, ALL, 1e-4, angle));
            law.observe(&P, &now(State::Collect, Due { collect: false, ..ALL }, 1e-4, angle));
            let mut free = now(State::Collect, ALL, 1e-4, angle);
            free.sample.probe = 0.999 * P.probe.contact;
            law.observe(&P, &free);
        }
        assert!(!law.collected());
        // a probe that touches by just so much sees the ring
        for k in 0..=204 {
            let mut touching = now(State::Collect, ALL, 0.0, TAU * f64::from(k) / 200.0);
            touching.sample.probe = P.probe.contact;
            law.observe(&P, &touching);
        }
        assert!(law.collected());
        // and a new collection starts
        let mut law = collected(1e-4);
        law.enter(&P, State::Wait, &now(State::Wait, ALL, 1e-4, 0.0));
        assert!(law.collected());
        law.enter(&P, State::Collect, &now(State::Collect, ALL, 1e-4, 0.0));
        assert!(!law.collected());
    }

    /// Law that has launched its push of a ring 0.1 mm off, and the launch.
    fn launched() -> (PaperLaw, Launch) {
        let mut law = collected(1e-4);
        concluded(&mut law, 1e-4);
        law.enter(&P, State::Wait, &now(State::Wait, ALL, 1e-4, 0.0));
        let mut launch = None;
        for k in 0..300 {
            let at = now(State::Wait, ALL, 1e-4, SPEED * 0.01 * f64::from(k));
            assert_eq!(law.launch(&P, &Observation { due: Due { control: false, ..ALL }, ..at }), None);
            launch = law.launch(&P, &at);
            if launch.is_some() {
                break;
            }
        }
        (law, launch.expect("a launch within a revolution"))
    }

    #[test]
    fn a_push_goes_to_the_position_of_the_centered_ring() {
        let (_, launch) = launched();
        let sample = 0.1 + launch.distance;
        assert!((launch.end.unwrap() - sample).abs() < 1e-12);
        // the gap and what the ring is off where the slide comes to rest
        assert!(launch.distance > 3e-4 && launch.distance < 6.1e-4, "{launch:?}");
        assert!(launch.velocity > P.push.velocity_min && launch.lead > 0.0);
    }

    #[test]
    fn the_gap_that_a_push_leaves_before_the_ring_is_learned() {
        let learned = |gap: f64| {
            let (mut law, _) = launched();
            let mut settle = now(State::Settle, ALL, 1e-4, 0.0);
            settle.sample.probe = P.probe.at_pusher - gap;
            law.enter(&P, State::Settle, &settle);
            // the ring has stayed where it was
            law.enter(&P, State::Collect, &settle);
            (0..=204).for_each(|k| law.observe(&P, &now(State::Collect, ALL, 1e-4, TAU * f64::from(k) / 200.0)));
            assert_eq!(law.offset(), 0.0);
            concluded(&mut law, 1e-4);
            law.offset()
        };
        // and the whole desired distance
        let requested = learned(0.0);
        assert!((requested - 1e-4).abs() < 1e-6);
        assert!([3e-5, 1e-5].iter().all(|&gap| (learned(gap) - requested - gap).abs() < 1e-12));
    }

    #[test]
    fn a_stroke_is_left_to_the_motion_and_over_after_its_dwell() {
        let (mut law, launch) = launched();
        assert_eq!((law.press(&P, &now(State::Push, ALL, 1e-4, 0.0)), law.ahead()), (None, 0.0));
        assert!(!law.diverged(&P));
        let mut motion = Motion::default();
        motion.reseat(0.1, false);
        motion.go(&P, launch.end.unwrap(), launch.velocity);
        while !law.stroke_over(&P, &motion) {
            assert!(!motion.arrived(&P, P.push.dwell));
            motion.step(&P, 0.0);
        }
        assert!(motion.arrived(&P, P.push.dwell));
        law.restart(&P);
        assert!(!law.collected() && law.launch(&P, &now(State::Wait, ALL, 1e-4, 0.0)).is_none());
    }
}
