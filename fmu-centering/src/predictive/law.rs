//! The default control law: every sample improves a model of the ring, and a push starts as soon as the model is certain.

use std::f64::consts::TAU;

use control_blocks::Trajectory;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::center::{Center, Estimate};
use crate::interface::{Fault, Parameters, State};
use crate::law::{CenteringLaw, Conclusion, Decision, Launch, Observation};
use crate::monitoring::PRESSED_IN_PUSH;
use crate::motion::Motion;
use crate::predictive::aim::{AimInput, aim};
use crate::predictive::assumptions::Assumptions;
use crate::predictive::learned::{LastPush, LearnedParameters, PushKind};
use crate::predictive::press::{Goal, Press};
use crate::predictive::ring_model::RingModel;
use crate::sensing::{Despiker, Measurement};

/// Time after a push until the ring is at rest, s.
const REST: f64 = 0.03;
/// Consecutive measurements beyond the gate after which the ring has moved.
const REJECTIONS_MAX: u32 = 5;
/// Spread of the center after a push: relative to the push, and at least, m.
const SPREAD: f64 = 0.3;
const SPREAD_MIN: f64 = 5e-6;
/// Minimum fraction of a push for a valid measurement of the contact.
const SENSED: f64 = 0.3;
/// Error of the surface before the contact above which a stroke stops: relative to the eccentricity, more than
/// twice the `expert.estimator.certainty` of a push, and the minimum, m (the apparent error of a probe that is 10 ms late).
const DIVERGED: f64 = 0.5;
const DIVERGED_MIN: f64 = 1.5e-3;
/// Largest distance for a tap, in deflections of the servo (default; a farther ring is pushed first).
const TAP_REACH: f64 = 1.5;
/// Rotation (revolutions) after which more measurements of the same positions give no new information.
const REVOLUTIONS: f64 = 1.05;
/// A slower spindle never brings the ring to the pusher, rad/s: nothing is divided by less.
const STANDING: f64 = 1e-9;

/// State between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PredictiveLaw {
    despiker: Despiker,
    seen: Option<Measurement>,
    ring: RingModel,
    learned: LearnedParameters,
    /// the active stroke
    press: Option<Press>,
    /// the last push, until the next one
    last_push: Option<LastPush>,
    /// samples until the ring is at rest
    rest: u32,
    /// spindle angle of the first measurement since the ring was moved
    since: Option<f64>,
    /// rotation since then, rad
    rotation: f64,
}

impl PredictiveLaw {
    /// State before the first sample.
    pub fn new(p: &Parameters) -> Self {
        Self {
            despiker: Despiker::default(),
            seen: None,
            ring: RingModel::new(assumptions(p)),
            learned: LearnedParameters::new(),
            press: None,
            last_push: None,
            rest: 0,
            since: None,
            rotation: 0.0,
        }
    }
}

impl CenteringLaw for PredictiveLaw {
    fn restart(&mut self, p: &Parameters) {
        *self = Self::new(p);
    }

    /// The probe may follow the ring or the slide move, as long as the pusher does not touch.
    fn observe(&mut self, p: &Parameters, now: &Observation) {
        let sample = &now.sample;
        if sample.probe < p.probe.contact {
            // the probe shows the slide, not the surface
            self.despiker = Despiker::default();
        }
        self.seen = self.despiker.update(Measurement { angle: now.angle, slide: sample.slide, tip: sample.tip() });
        self.rest = self.rest.saturating_sub(1);
        if self.rest > 0 || !(now.state.follows() || now.state == State::Settle) {
            return;
        }
        self.ring.note_late(now.late);
        if let Some(seen) = self.seen.filter(|_| now.due.collect)
            && self.ring.observe(seen.angle, seen.tip)
        {
            let since = *self.since.get_or_insert(seen.angle);
            self.rotation = (seen.angle - since).abs();
        }
        if !self.ring.advance() {
            self.ring = RingModel::new(assumptions(p));
            (self.since, self.rotation) = (None, 0.0);
        }
    }

    fn collected(&self) -> bool {
        false
    }

    fn conclude(&mut self, p: &Parameters, now: &Observation) -> Option<Result<Conclusion, Fault>> {
        if !matches!(now.state, State::Collect | State::Wait) {
            return None;
        }
        if now.due.model {
            self.ring.refine();
        }
        if !now.due.collect || self.ring.undecided() {
            return None;
        }
        let sigma = self.ring.center_sigma();
        let certain = self.ring.settled() && sigma < p.estimator.certainty * self.ring.eccentricity();
        let decision = self.decision(p, now.speed, sigma, certain);
        let known = certain || matches!(decision, Decision::Centered | Decision::Unresolved);
        Some(Ok((known.then(|| self.estimate(sigma)), decision)))
    }

    /// The next stroke, if it must begin before the next measurement.
    fn launch(&mut self, p: &Parameters, now: &Observation) -> Option<Launch> {
        if !now.due.collect || now.speed.abs() < STANDING || self.seen.is_none() || self.ring.undecided() {
            return None;
        }
        let mut learned = self.relearned(p);
        let tap = self.tap_speed(p, now.bandwidth, &mut learned);
        let input = AimInput {
            ring: &self.ring,
            learned: &learned,
            angle: now.angle,
            speed: now.speed,
            setpoint: now.setpoint,
            bandwidth: now.bandwidth,
            horizon: 1.0 / p.rates.collect,
        };
        let planned = aim(p, &input, tap)?;
        self.last_push = Some(LastPush {
            eccentricity: self.ring.eccentricity(),
            angle: planned.angle,
            sense: now.speed.signum(),
            lateral: if p.stroke.phase_plan { learned.lateral.mean } else { 0.0 },
            kind: tap.map_or(PushKind::Push(0.0), PushKind::Tap),
        });
        self.learned = learned;
        self.press = Some(planned.press);
        Some(Launch { distance: planned.distance, velocity: planned.velocity, lead: planned.lead, end: None })
    }

    fn press(&mut self, p: &Parameters, now: &Observation) -> Option<Trajectory> {
        let (press, seen) = (self.press.as_mut()?, self.seen.as_ref()?);
        let goal = Goal {
            line: self.ring.centered_line(seen.angle) + self.learned.recoil.mean,
            contact: p.probe.at_pusher + self.learned.contact.mean,
            deflection: if p.learn.deflection { self.learned.deflection.mean } else { 0.0 },
        };
        Some(press.step(p, &goal, seen, now.sample.slide))
    }

    fn diverged(&self, p: &Parameters) -> bool {
        let (Some(_), Some(seen)) = (&self.press, &self.seen) else { return false };
        let far = seen.probe() < p.probe.at_pusher - PRESSED_IN_PUSH;
        let maximum = (DIVERGED * self.ring.eccentricity()).max(DIVERGED_MIN);
        far && (seen.tip - self.ring.line(seen.angle)).abs() > maximum
    }

    fn ahead(&self) -> f64 {
        self.press.as_ref().map_or(0.0, Press::ahead)
    }

    fn stroke_over(&self, p: &Parameters, _: &Motion) -> bool {
        // a stroke without a valid surface ends immediately
        self.seen.is_none() || self.press.as_ref().is_none_or(|press| press.over(p))
    }

    fn enter(&mut self, p: &Parameters, state: State, _: &Observation) {
        if state == State::Settle {
            self.end_stroke(p);
        }
    }

    /// Excess of a push over the calibrated depth, m.
    fn offset(&self) -> f64 {
        let learned = &self.learned;
        learned.contact.mean + learned.deflection.mean + learned.recoil.mean
    }
}

impl PredictiveLaw {
    /// Learns from the contact; the center is then near its target.
    fn end_stroke(&mut self, p: &Parameters) {
        let (Some(press), Some(last_push)) = (self.press.take(), &mut self.last_push) else { return };
        let spread = SPREAD * last_push.eccentricity + SPREAD_MIN;
        if self.seen.is_none() {
            // no learning without a measurement
            self.last_push = None;
        } else if let PushKind::Push(reached) = &mut last_push.kind {
            *reached = press.last().tip;
            last_push.angle = press.last().angle;
            match press.sensed(SENSED * last_push.eccentricity) {
                Some((deflection, probe)) => self.learned.touched(p, deflection, probe),
                None => self.learned.missed(p, press.last().probe()),
            }
        }
        self.ring.displaced(Vector2::zeros(), spread);
        (self.since, self.rotation) = (None, 0.0);
        self.rest = p.ticks(REST);
    }

    /// Estimate of the ring.
    fn estimate(&self, sigma: f64) -> Estimate {
        let center = self.ring.center();
        Estimate { center: Center { x: center.x, y: center.y }, mean: self.ring.mean_line(), sigma }
    }

    /// Next step.
    fn decision(&self, p: &Parameters, speed: f64, sigma: f64, certain: bool) -> Decision {
        let (eccentricity, full) = (self.ring.eccentricity(), self.rotation >= TAU);
        if full && eccentricity + p.estimator.margin * sigma <= p.tolerance {
            return Decision::Centered;
        }
        // uncertainty after a full revolution
        let samples = p.rates.collect * TAU / speed.abs().max(STANDING);
        let uncertainty = p.estimator.noise * self.ring.misfit() * (2.0 / samples).sqrt();
        let worth = eccentricity > p.tolerance - p.estimator.margin * uncertainty;
        if certain && (full || (p.estimator.partial && worth)) {
            Decision::Push
        } else if self.rotation < REVOLUTIONS * TAU {
            Decision::Measure
        } else {
            Decision::Unresolved
        }
    }

    /// Learned values including the last push.
    fn relearned(&self, p: &Parameters) -> LearnedParameters {
        self.last_push
            .as_ref()
            .map_or_else(|| self.learned.clone(), |last_push| self.learned.after(p, last_push, &self.ring))
    }

    /// Speed (m/s) of a tap, if the ring is too heavy to be pushed so little.
    fn tap_speed(&self, p: &Parameters, bandwidth: f64, learned: &mut LearnedParameters) -> Option<f64> {
        let (eccentricity, deflection) = (self.ring.eccentricity(), learned.deflection.mean);
        let heavy = deflection > p.tap.deflection_min && eccentricity < TAP_REACH * deflection;
        (p.tap.enabled && heavy).then(|| learned.prepare_tap(p, bandwidth).speed(eccentricity).min(p.tap.speed_max))
    }
}

/// Prior of the ring from the parameters.
fn assumptions(p: &Parameters) -> Assumptions {
    Assumptions {
        radius: p.ring.radius,
        noise: p.estimator.noise,
        center: p.estimator.center,
        form: p.estimator.form,
        gate: p.estimator.gate,
        rejections_max: REJECTIONS_MAX,
    }
}

#[cfg(test)]
mod tests;
