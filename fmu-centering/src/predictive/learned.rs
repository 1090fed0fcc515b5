//! Values of ring and machine that are learned from the pushes of one cycle.

use nalgebra::{Rotation2, Vector2};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::predictive::gaussian::GaussianEstimate;
use crate::predictive::ring_model::RingModel;
use crate::predictive::tap::{Hammer, TapLaw};

/// Before the first push: contact (m), deflection (m) and recoil (m) of a machine that is calibrated to some 0.03 mm.
const CONTACT: GaussianEstimate = GaussianEstimate::new(0.0, 3e-5);
const DEFLECTION: GaussianEstimate = GaussianEstimate::new(0.0, 1e-3);
const RECOIL: GaussianEstimate = GaussianEstimate::new(0.0, 2e-6);
/// Lateral ratio before the first push: lower than that of any machine, so that what remains of the eccentricity reaches
/// the pusher after a quarter of a revolution and not after three.
const LATERAL: GaussianEstimate = GaussianEstimate::new(0.05, 0.1);
/// Scatter from push to push: contact (m), deflection (relative), recoil (m), lateral ratio.
const CONTACT_SCATTER: f64 = 3e-7;
const DEFLECTION_SCATTER: f64 = 0.1;
const RECOIL_SCATTER: f64 = 2e-7;
const LATERAL_SCATTER: f64 = 0.02;
/// Minimum fraction of the eccentricity that a push must remove to determine its direction.
const MOVED: f64 = 0.3;

/// Learned values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LearnedParameters {
    /// Excess of the probe deflection at contact over the calibrated one, m.
    pub contact: GaussianEstimate,
    /// Deflection of the servo from its setpoint when it pushes this ring, m.
    pub deflection: GaussianEstimate,
    /// Distance by which the ring returns when the slide retracts, m; negative if it continues.
    pub recoil: GaussianEstimate,
    /// Slip across the push per slip along it, against the rotation.
    pub lateral: GaussianEstimate,
    /// Speed and distance of taps, once there is a first estimate.
    pub tap: Option<TapLaw>,
}

/// A completed push.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LastPush {
    /// Eccentricity before, m.
    pub eccentricity: f64,
    /// Spindle angle at the end of the stroke, rad.
    pub angle: f64,
    /// Sign of the rotation.
    pub sense: f64,
    /// Lateral ratio for which it was planned.
    pub lateral: f64,
    /// Type of push.
    pub kind: PushKind,
}

/// The two ways to move a ring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PushKind {
    /// Pushed until the surface was at this tip position, m.
    Push(f64),
    /// Hit with this speed, m/s.
    Tap(f64),
}

impl LearnedParameters {
    /// Nothing learned.
    pub fn new() -> Self {
        Self { contact: CONTACT, deflection: DEFLECTION, recoil: RECOIL, lateral: LATERAL, tap: None }
    }

    /// Learns from the contact itself: deflection (m) and, if known, probe position (m) while the ring was pushed.
    pub fn touched(&mut self, p: &Parameters, deflection: f64, probe: Option<f64>) {
        if p.learn.deflection {
            self.deflection =
                self.deflection.after(deflection, DEFLECTION_SCATTER * deflection.abs() + CONTACT_SCATTER);
        }
        if let Some(probe) = probe.filter(|_| p.learn.contact) {
            self.contact = self.contact.after(probe - p.probe.at_pusher, CONTACT_SCATTER);
        }
    }

    /// Learns from a push that did not move the ring: the contact lies beyond the last probe position (m).
    pub fn missed(&mut self, p: &Parameters, probe: f64) {
        if p.learn.contact {
            self.contact.mean = self.contact.mean.max(probe - p.probe.at_pusher);
        }
    }

    /// Learned values including the motion of the ring according to the present model.
    #[must_use]
    pub fn after(&self, p: &Parameters, last_push: &LastPush, ring: &RingModel) -> Self {
        let mut learned = self.clone();
        let left = Rotation2::new(last_push.angle) * ring.center();
        let sigma = ring.center_sigma();
        let moved = last_push.eccentricity - left.x;
        if p.learn.lateral && moved > MOVED * last_push.eccentricity {
            learned.lateral = self.sideways(last_push, left, moved, sigma);
        }
        match last_push.kind {
            PushKind::Push(reached) if p.learn.recoil => {
                // where the surface was at the end of the stroke, against where it is now
                let recoil = left.x - (ring.centered_line(last_push.angle) - reached);
                learned.recoil = self.recoil.after(recoil, RECOIL_SCATTER + sigma);
            }
            PushKind::Push(_) => {}
            PushKind::Tap(speed) => learned.tap = self.tap.map(|tap| tap.after(speed, moved, sigma)),
        }
        learned
    }

    /// First estimate of the tap law, for a servo of the `bandwidth` rad/s.
    pub fn prepare_tap(&mut self, p: &Parameters, bandwidth: f64) -> TapLaw {
        let guess = || {
            let servo = p.tap.slide_mass * bandwidth.powi(2);
            let hammer = Hammer { mass: p.tap.slide_mass, servo, tip: p.tap.tip_stiffness };
            TapLaw::guess(&hammer, self.deflection.mean)
        };
        *self.tap.get_or_insert_with(guess)
    }

    /// Lateral ratio that explains the motion of the ring.
    fn sideways(&self, last_push: &LastPush, left: Vector2<f64>, moved: f64, sigma: f64) -> GaussianEstimate {
        let ratio = last_push.lateral - last_push.sense * left.y / moved;
        let ratio = self.lateral.after(ratio, LATERAL_SCATTER.hypot(sigma / moved));
        GaussianEstimate { mean: ratio.mean.clamp(0.0, 1.0), ..ratio }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predictive::assumptions::Assumptions;

    const P: Parameters = Parameters::START;

    #[test]
    fn a_push_that_does_not_reach_the_ring_is_followed_by_a_deeper_one() {
        let mut learned = LearnedParameters::new();
        learned.missed(&P, P.probe.at_pusher + 7e-6);
        assert!((learned.contact.mean - 7e-6).abs() < 1e-15);
        // less depth determines nothing
        learned.missed(&P, P.probe.at_pusher - 1e-4);
        assert!((learned.contact.mean - 7e-6).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_to_be_learned_stays() {
        let mut p = P;
        (p.learn.contact, p.learn.deflection) = (false, false);
        let mut learned = LearnedParameters::new();
        learned.missed(&p, p.probe.at_pusher + 7e-6);
        learned.touched(&p, 1e-5, Some(p.probe.at_pusher + 5e-6));
        assert_eq!(learned, LearnedParameters::new());
    }

    const ANGLE: f64 = 0.7;
    const E: f64 = 1e-4;

    /// A ring that lies at (x, y) m in the world at the angle of the last push, known to 1 um.
    fn left(x: f64, y: f64) -> RingModel {
        let assumed = Assumptions { radius: 0.05, noise: 2e-7, center: 5e-3, form: 0.0, gate: 6.0, rejections_max: 5 };
        let mut ring = RingModel::new(assumed);
        ring.displaced(Rotation2::new(-ANGLE) * Vector2::new(x, y), 1e-6);
        ring
    }

    fn push(sense: f64, kind: PushKind) -> LastPush {
        LastPush { eccentricity: E, angle: ANGLE, sense, lateral: 0.05, kind }
    }

    #[test]
    fn where_the_ring_went_sideways_teaches_the_lateral_ratio() {
        let learned = LearnedParameters::new();
        for sense in [1.0, -1.0] {
            let after = learned.after(&P, &push(sense, PushKind::Push(0.0)), &left(1e-5, -sense * 9e-6));
            // 9 um sideways over a distance of 90 um, on the side to which the table turns
            let expected = learned.lateral.after(0.05 + 0.1, 0.02_f64.hypot(1e-6 / 9e-5));
            assert!((after.lateral.mean - expected.mean).abs() < 1e-9, "{:?} {expected:?}", after.lateral);
            assert!((after.lateral.sigma - expected.sigma).abs() < 1e-9);
        }
        // a short distance determines nothing, and no ratio is negative
        let short = learned.after(&P, &push(1.0, PushKind::Push(0.0)), &left(7.1e-5, -9e-6));
        assert_eq!(short.lateral, learned.lateral);
        let back = learned.after(&P, &push(1.0, PushKind::Push(0.0)), &left(0.0, 5e-5));
        assert_eq!(back.lateral.mean, 0.0);
    }

    #[test]
    fn the_ring_position_after_the_stroke_identifies_the_recoil() {
        let learned = LearnedParameters::new();
        // the surface was 3 um before the line of the centered ring, and is 5 um beyond it
        let after = learned.after(&P, &push(1.0, PushKind::Push(-3e-6)), &left(5e-6, 0.0));
        let expected = learned.recoil.after(2e-6, 2e-7 + 1e-6);
        assert!(
            (after.recoil.mean - expected.mean).abs() < 1e-12 && (after.recoil.sigma - expected.sigma).abs() < 1e-12
        );
        let mut p = P;
        p.learn.recoil = false;
        assert_eq!(learned.after(&p, &push(1.0, PushKind::Push(-3e-6)), &left(5e-6, 0.0)).recoil, learned.recoil);
    }

    #[test]
    fn a_tap_teaches_the_law_of_taps_and_no_recoil() {
        let mut learned = LearnedParameters::new();
        learned.deflection.mean = 2e-4;
        let law = learned.prepare_tap(&P, P.slide.bandwidth);
        let servo = P.tap.slide_mass * P.slide.bandwidth.powi(2);
        let hammer = Hammer { mass: P.tap.slide_mass, servo, tip: P.tap.tip_stiffness };
        assert_eq!(law, TapLaw::guess(&hammer, 2e-4));
        let after = learned.after(&P, &push(1.0, PushKind::Tap(0.08)), &left(2e-5, 0.0));
        let expected = law.after(0.08, 8e-5, 1e-6);
        for d in [0.0, 1e-5] {
            assert!((after.tap.unwrap().speed(d) - expected.speed(d)).abs() < 1e-9);
        }
        assert_eq!(after.recoil, learned.recoil);
    }

    #[test]
    fn the_touch_teaches_deflection_and_contact() {
        let mut learned = LearnedParameters::new();
        let before = learned.clone();
        learned.touched(&P, 4e-6, Some(P.probe.at_pusher + 5e-6));
        assert_eq!(learned.deflection, before.deflection.after(4e-6, 0.4e-6 + 3e-7));
        let contact = before.contact.after(5e-6, 3e-7);
        assert!((learned.contact.mean - contact.mean).abs() < 1e-12);
        assert!((learned.contact.sigma - contact.sigma).abs() < 1e-12);
        learned = before.clone();
        learned.touched(&P, 4e-6, None);
        assert_eq!(learned.contact, before.contact);
    }
}
