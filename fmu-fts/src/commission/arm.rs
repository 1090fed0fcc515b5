//! Inertia, friction, delay and flexure from the response that a commission has measured.
//!
//! With the torque U and the angle B of the hub at the frequency w, and N and D of the flexure as in [`crate::servo::flexure`],
//!
//! ```text
//! (-w^2 J D / N + j w b + j 4 F / (pi |B|)) B = H e^(-j w d T_s) U,
//! ```
//!
//! J: inertia, b: viscous friction, F: dry friction, whose torque has the fundamental 4 F / pi in phase with the speed whatever the
//! amplitude is, d: samples of delay beyond the told ones, H: hold, current loop and told delay, those of the told arm. Over
//! the response of the told arm, and times N without any pole, it is linear in nearly all of the seven unknowns. Gain of
//! the drive and inertia leave no trace but their ratio: so the torque is believed, and J, b and F are those that go with it. A delay
//! of the encoder turns the phase as one of the command does: only their sum leaves a trace.
//!
//! The flexure as it is told is one observation more, of little weight: an arm that is told rigid stays rigid.

use std::f64::consts::PI;

use control_blocks::{Estimate, NoEstimate, Observation, least_squares};
use nalgebra::{Complex, SVector};

use crate::commission::plan::Plan;
use crate::servo::flexure::{Shape, gradient};
use crate::servo::nominal::Nominal;
use crate::servo::response::{FrequencyResponse, Point};

/// J / J_told, d, w_t / told, z, m, b T / J_told and F T^2 / J_told with the unit of time T below.
pub type Unknowns = SVector<f64, 7>;

/// Standard deviation of a point, of its value: noise, and what the model leaves out.
const POINT_SIGMA: f64 = 3e-3;
/// Amplitude (rad) below which dry friction is none: bearings give way like springs before they slide, by some micrometres.
const PRESLIDING: f64 = 1e-4;
/// Fits with the weights of the arm that the one before has found.
const WEIGHED: u32 = 2;
/// Standard deviations of frequency, damping and inertia of the flexure as they are told.
const TOLD_SIGMA: [f64; 3] = [0.5, 0.05, 0.5];
/// Unit of time in which all unknowns are of the order of 1, s.
const UNIT: f64 = 0.1;

/// What a commission knows of the arm, and the standard deviations of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundArm {
    /// Inertia, kg.m2.
    pub inertia: [f64; 2],
    /// Viscous friction, N.m.s/rad.
    pub viscous_friction: [f64; 2],
    /// Dry friction, N.m.
    pub dry_friction: [f64; 2],
    /// Samples of delay.
    pub delay: [f64; 2],
    /// Natural frequency of the flexure, rad/s.
    pub frequency: [f64; 2],
    /// Damping ratio of it.
    pub damping: [f64; 2],
    /// Part of the inertia beyond it.
    pub share: [f64; 2],
}

/// A measured point: the response over the told rigid arm, the amplitude of the hub (rad), and how far the closed loop is from
/// following. An error e of the closed loop T is e / (1 - T) of the response of the arm.
struct Swing {
    omega: f64,
    over_rigid: Complex<f64>,
    amplitude: f64,
    following: f64,
}

/// What a response is compared with.
struct Told<'a> {
    plan: &'a Plan,
    shape: Shape,
}

/// The arm that explains a response best.
///
/// # Errors
/// When it does not tell the unknowns apart.
pub fn find(plan: &Plan, response: &FrequencyResponse) -> Result<FoundArm, NoEstimate> {
    let told = Told::new(plan);
    // what noise does to a point depends on the arm: it is alike for all at first, as that of what was told may be far off
    let start = told.start();
    let mut found = told.fit(response, start, |swing| told.deviation(swing, &start, POINT_SIGMA))?;
    for _ in 0..WEIGHED {
        let at = found.value;
        found = told.fit(response, at, |swing| told.deviation(swing, &at, told.noise(swing, &at)))?;
    }
    Ok(told.arm(&found))
}

impl<'a> Told<'a> {
    fn new(plan: &'a Plan) -> Self {
        Self { plan, shape: Shape::told(&plan.told) }
    }

    /// The unknowns as they are told.
    fn start(&self) -> Unknowns {
        let Nominal { servo, tip, .. } = &self.plan.told;
        let [inertia, viscous, dry] = [1.0, servo.viscous_friction * UNIT, servo.dry_friction * UNIT * UNIT];
        Unknowns::from([inertia, 0.0, 1.0, tip.damping, tip.inertia, viscous / servo.inertia, dry / servo.inertia])
    }

    fn fit(
        &self,
        response: &FrequencyResponse,
        at: Unknowns,
        deviation: impl Fn(&Swing) -> f64,
    ) -> Result<Estimate<7>, NoEstimate> {
        let (points, told) = (response.points(), self.start());
        least_squares(at, 2 * points.len() + TOLD_SIGMA.len(), |i, x| {
            if let Some(known) = i.checked_sub(2 * points.len()) {
                let (unknown, sigma) = (2 + known, TOLD_SIGMA[known]);
                let mut gradient = Unknowns::zeros();
                gradient[unknown] = sigma.recip();
                return Observation { residual: (x[unknown] - told[unknown]) / sigma, gradient };
            }
            let swing = self.swing(&points[i / 2]);
            let deviation = deviation(&swing);
            let residual = |x: &Unknowns| {
                let residual = self.residual(&swing, x) / deviation;
                if i % 2 == 0 { residual.re } else { residual.im }
            };
            Observation { residual: residual(x), gradient: gradient(residual, x) }
        })
    }

    fn swing(&self, point: &Point) -> Swing {
        let amplitude = self.plan.amplitude(point.frequency) * point.magnitude;
        let over_rigid = self.shape.measured(&self.plan.model, point);
        Swing { omega: point.frequency, over_rigid, amplitude, following: (1.0 - point.value()).norm() }
    }

    /// N times (e^(-j w d T_s) times the told arm over the measured one, less the found arm), over the told rigid one.
    fn residual(&self, swing: &Swing, x: &Unknowns) -> Complex<f64> {
        let &[inertia, delay, frequency, damping, share, viscous, dry] = &x.data.0[0];
        let (omega, servo) = (swing.omega, &self.plan.told.servo);
        let [zero, pole] = self.shape.zero_and_pole(omega, [frequency, damping, share]);
        let slow = omega * UNIT;
        let drag = viscous / slow + 4.0 * dry / (PI * swing.amplitude * slow * slow);
        let told = 1.0 - Complex::I * servo.viscous_friction / (omega * servo.inertia) * self.shape.rigid(omega);
        let late = Complex::from_polar(1.0, -omega * self.plan.told.sample_period * delay);
        late * told * zero - swing.over_rigid * (pole * inertia - Complex::I * drag * zero)
    }

    /// Standard deviation of each part of it: noise, and the friction that a small swing does not have.
    fn deviation(&self, swing: &Swing, x: &Unknowns, noise: f64) -> f64 {
        let &[_, _, frequency, damping, share, _, dry] = &x.data.0[0];
        let [zero, _] = self.shape.zero_and_pole(swing.omega, [frequency, damping, share]);
        let slow = swing.omega * UNIT;
        let drag = 4.0 * dry / (PI * swing.amplitude * slow * slow) * swing.over_rigid * zero;
        noise.hypot(drag.norm() * PRESLIDING / (PRESLIDING + swing.amplitude))
    }

    /// What an error of the closed loop does to it.
    fn noise(&self, swing: &Swing, x: &Unknowns) -> f64 {
        let &[inertia, _, frequency, damping, share, ..] = &x.data.0[0];
        let [_, pole] = self.shape.zero_and_pole(swing.omega, [frequency, damping, share]);
        POINT_SIGMA * (swing.over_rigid * pole * inertia).norm() / swing.following
    }

    fn arm(&self, found: &Estimate<7>) -> FoundArm {
        let Nominal { servo, tip, io_delay, .. } = &self.plan.told;
        let scaled = |i: usize, unit: f64| [unit * found.value[i], unit * found.sigma(i)];
        let [late, deviation] = scaled(1, 1.0);
        FoundArm {
            inertia: scaled(0, servo.inertia),
            viscous_friction: scaled(5, servo.inertia / UNIT),
            dry_friction: scaled(6, servo.inertia / (UNIT * UNIT)),
            delay: [f64::from(*io_delay) + late, deviation],
            frequency: scaled(2, tip.frequency),
            damping: scaled(3, 1.0),
            share: scaled(4, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use crate::servo::loop_model::LoopModel;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// The machine as it is told, after `change`.
    fn machine(change: impl FnOnce(&mut Parameters)) -> Nominal {
        let mut p = Parameters::START;
        change(&mut p);
        (&p).into()
    }

    /// What the tones of a plan measure on a machine with dry friction, each part with `noise`.
    fn response(plan: &Plan, truth: &Nominal, noise: f64, seed: u64) -> FrequencyResponse {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let model = LoopModel::new(*truth, *plan.model.compensator());
        let mut seen = FrequencyResponse::EMPTY;
        for tone in &plan.tones {
            let omega = std::f64::consts::TAU * tone.frequency() / truth.sample_period;
            let (arm, compensator) = (model.arm(omega), model.open(omega) / model.arm(omega));
            // hold, current loop and delay of this machine: its response over that of the arm without them
            let shape = Shape::told(truth);
            let stiff = -truth.servo.inertia * omega * omega / shape.rigid(omega)
                + Complex::I * omega * truth.servo.viscous_friction;
            let mut closed = model.closed(omega);
            for _ in 0..60 {
                let amplitude = tone.amplitude * closed.norm();
                let dry = Complex::I * 4.0 * truth.servo.dry_friction / (PI * amplitude);
                let open = compensator * arm * stiff / (stiff + dry);
                closed = open / (open + 1.0);
            }
            seen.push(omega, closed * (1.0 + noise * Complex::new(normal(), normal())));
        }
        seen
    }

    #[test]
    fn every_unknown_is_found_far_from_what_was_told() {
        let plan = Plan::new(&Parameters::START);
        for (inertia, dry, frequency, delay, share, damping) in [
            (1.4e-3, 0.015, 0.75, 2, 0.5, 0.014),
            (5e-4, 0.007, 1.28, 0, 0.36, 0.026),
            (8e-4, 0.0, 1.0, 1, 0.4375, 0.02),
        ] {
            let truth = machine(|p| {
                (p.servo.inertia, p.servo.dry_friction, p.servo.viscous_friction) = (inertia, dry, 3e-3);
                (p.tip.inertia, p.tip.damping, p.io_delay) = (share, damping, delay);
                p.tip.frequency *= frequency;
            });
            let arm = find(&plan, &response(&plan, &truth, 0.0, 1)).unwrap();
            let near = |[value, deviation]: [f64; 2], expected: f64, spread: f64| {
                assert!((value - expected).abs() < spread && deviation > 0.0, "{value} {expected}: {arm:?}");
            };
            near(arm.inertia, inertia, 1e-3 * inertia);
            near(arm.viscous_friction, 3e-3, 1e-4);
            near(arm.dry_friction, dry, 1e-4);
            near(arm.delay, f64::from(delay), 0.01);
            near(arm.frequency, truth.tip.frequency, 3e-3 * truth.tip.frequency);
            near(arm.share, share, 5e-3);
            near(arm.damping, damping, 1e-3);
        }
    }

    #[test]
    fn the_deviation_is_the_scatter_of_the_estimates() {
        let plan = Plan::new(&Parameters::START);
        let truth = machine(|p| p.servo.inertia = 9e-4);
        // a percent, beside which the deviation of a point does not count
        let all: Vec<FoundArm> =
            (0..60).map(|seed| find(&plan, &response(&plan, &truth, 0.01, seed)).unwrap()).collect();
        type Of = fn(&FoundArm) -> [f64; 2];
        let (servo, tip) = (truth.servo, truth.tip);
        for (of, expected) in [
            ((|arm| arm.inertia) as Of, 9e-4),
            (|arm| arm.viscous_friction, servo.viscous_friction),
            (|arm| arm.delay, 1.0),
            (|arm| arm.frequency, tip.frequency),
            (|arm| arm.damping, tip.damping),
            (|arm| arm.share, tip.inertia),
        ] {
            let told = all.iter().map(|arm| of(arm)[1]).sum::<f64>() / all.len() as f64;
            let scatter = all.iter().map(|arm| (of(arm)[0] - expected).powi(2)).sum::<f64>() / all.len() as f64;
            let ratio = scatter.sqrt() / told;
            // a friction that is not there is taken for some, and makes the flexure less sure than it is
            assert!((0.4..1.5).contains(&ratio), "{expected}: {ratio}");
        }
    }

    #[test]
    fn a_late_encoder_counts_as_delay() {
        let plan = Plan::new(&Parameters::START);
        let (now, later) = (machine(|_| ()), machine(|p| p.io_delay = 2));
        // one sample later in the reading or in the command: the same response of the loop
        let late = find(&plan, &response(&plan, &later, 0.0, 1)).unwrap();
        let prompt = find(&plan, &response(&plan, &now, 0.0, 1)).unwrap();
        assert!((late.delay[0] - prompt.delay[0] - 1.0).abs() < 0.01, "{late:?} {prompt:?}");
    }

    #[test]
    fn friction_is_as_unsure_as_the_part_of_it_that_a_small_swing_does_not_have() {
        let plan = Plan::new(&Parameters::START);
        let (told, servo) = (Told::new(&plan), plan.told.servo);
        for (omega, amplitude) in [(30.0, 1e-3), (60.0, 1e-3), (60.0, 1e-4)] {
            let mut x = told.start();
            x[6] = 0.01 / servo.inertia * UNIT * UNIT;
            let swing = Swing { omega, over_rigid: Complex::ONE, amplitude, following: 1.0 };
            // 10 mN.m over what accelerates the arm
            let drag = 4.0 * 0.01 / (PI * amplitude) / (servo.inertia * omega * omega);
            let expected = drag * PRESLIDING / (PRESLIDING + amplitude);
            let deviation = told.deviation(&swing, &x, 0.0);
            assert!((deviation / expected - 1.0).abs() < 1e-3, "{omega} {amplitude}: {deviation} {expected}");
            assert!((told.deviation(&swing, &x, 3.0) - 3.0_f64.hypot(deviation)).abs() < 1e-12);
        }
    }

    #[test]
    fn few_tones_tell_nothing() {
        let plan = Plan::new(&Parameters::START);
        assert!(find(&plan, &FrequencyResponse::EMPTY).is_err());
        let one = FrequencyResponse::from_model(&[300.0], |omega| plan.model.closed(omega));
        assert!(find(&plan, &one).is_err());
    }
}
