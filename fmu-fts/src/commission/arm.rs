//! Inertia, friction, delay and flexure from the response measured in a commissioning run.
//!
//! With the torque U and the angle B of the hub at the frequency w, and N and D of the flexure as in
//! [`crate::servo::flexure`],
//!
//! ```text
//! (-w^2 J D / N + j w b + j 4 F (1 + j w t) / (pi |B|)) B = H e^(-j w d T_s) U,
//! ```
//!
//! J: inertia, b: viscous friction, F: dry friction, whose torque has the fundamental 4 F / pi at any amplitude, t:
//! lead of its reversal over that of the speed, d: samples of delay beyond the nominal ones, H: hold, current loop and
//! delay of the nominal arm. Relative to the response of the nominal arm, and multiplied by N, it has no pole and is
//! linear in nearly all of the eight unknowns (F t is one of them). Only the ratio of drive gain and inertia is
//! observable: J, b and F are relative to the commanded torque. A delay of the encoder rotates the phase like one of
//! the command: only their sum is observable.
//!
//! The relative standard deviation of a point has three parts: the model error; encoder noise s, of which the mean of n
//! samples leaves s sqrt(2 / n) in B, and as much of the response of the arm, because the loop responds to noise by its
//! sensitivity; and the phase of dry friction. At small amplitudes friction is elastic, and friction distorts a slow
//! oscillation: without a loop, its harmonics reverse the speed early by the sum of 1 / n^2 over the odd n from 3 on,
//! times the ratio of friction to torque.
//!
//! The nominal flexure is one more observation of small weight: a rigid arm stays rigid. Another observation is t = 0.

use std::f64::consts::PI;

use control_blocks::{Estimate, NoEstimate, Observation, least_squares};
use nalgebra::{Complex, SVector};

use crate::commission::plan::Plan;
use crate::servo::flexure::{Shape, gradient};
use crate::servo::nominal::Nominal;
use crate::servo::response::{FrequencyResponse, Point};

/// J / J_nominal, d, w_t / nominal, z, m, b T / J_nominal and F T^2 / J_nominal with the unit of time T below, and F t
/// as F with the unit of t below.
pub type Unknowns = SVector<f64, 8>;

/// Standard deviation of what the model leaves out of a point, of its value.
const POINT_SIGMA: f64 = 1e-3;
/// Amplitude (rad) below which friction is elastic: bearings give way by some micrometers before they slide.
const PRESLIDING: f64 = 1e-4;
/// Early reversal of the speed by friction, over the ratio of friction to torque: pi^2 / 8 - 1.
const BENT: f64 = PI * PI / 8.0 - 1.0;
/// Standard deviation of the lead t of the reversal of dry friction, s; and the smallest friction that has one, as F.
const DRAG_DELAY: (f64, f64) = (1e-4, 1e-3);
/// Fits, each with the weights of the arm that the one before has found.
const FITS: u32 = 3;
/// Standard deviations of frequency, damping and inertia of the nominal flexure.
const NOMINAL_SIGMA: [f64; 3] = [0.5, 0.05, 0.5];
/// Unit of time in which all unknowns are of the order of 1, s.
const UNIT: f64 = 0.1;

/// Result of a commissioning run for the arm, with standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentifiedArm {
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
    pub tip_ratio: [f64; 2],
}

/// A measured point: the response relative to the nominal rigid arm, the amplitude of the hub (rad), and its standard
/// deviation.
struct Oscillation {
    omega: f64,
    over_rigid: Complex<f64>,
    amplitude: f64,
    noise: f64,
}

/// The nominal machine, relative to which a response is fitted: plan of the tones and shape of the flexure.
struct Nominals<'a> {
    plan: &'a Plan,
    shape: Shape,
}

/// The arm that explains a response best.
///
/// # Errors
/// When it does not determine the unknowns.
pub fn find(plan: &Plan, response: &FrequencyResponse) -> Result<IdentifiedArm, NoEstimate> {
    let nominal = Nominals::new(plan);
    let mut found = nominal.fit(response, nominal.start())?;
    for _ in 1..FITS {
        found = nominal.fit(response, found.value)?;
    }
    Ok(nominal.arm(&found))
}

impl<'a> Nominals<'a> {
    fn new(plan: &'a Plan) -> Self {
        Self { plan, shape: Shape::nominal(&plan.nominal) }
    }

    /// The nominal values of the unknowns.
    fn start(&self) -> Unknowns {
        let Nominal { servo, tip, .. } = &self.plan.nominal;
        let [inertia, viscous, dry] = [1.0, servo.viscous_friction * UNIT, servo.dry_friction * UNIT * UNIT];
        Unknowns::from([inertia, 0.0, 1.0, tip.damping, tip.inertia, viscous / servo.inertia, dry / servo.inertia, 0.0])
    }

    /// The fit with the weights of the arm `at`, from there on.
    fn fit(&self, response: &FrequencyResponse, at: Unknowns) -> Result<Estimate<8>, NoEstimate> {
        let (points, nominal) = (response.points(), self.start());
        let [frequency, damping, tip_ratio] = NOMINAL_SIGMA;
        let known = [(2, frequency), (3, damping), (4, tip_ratio), (7, at[6].abs().max(DRAG_DELAY.1))];
        least_squares(at, 2 * points.len() + known.len(), |i, x| {
            if let Some(beyond) = i.checked_sub(2 * points.len()) {
                let (unknown, sigma) = known[beyond];
                let mut gradient = Unknowns::zeros();
                gradient[unknown] = sigma.recip();
                return Observation { residual: (x[unknown] - nominal[unknown]) / sigma, gradient };
            }
            let oscillation = self.oscillation(&points[i / 2]);
            let deviation = self.deviation(&oscillation, &at);
            let residual = |x: &Unknowns| {
                let residual = self.residual(&oscillation, x) / deviation;
                if i % 2 == 0 { residual.re } else { residual.im }
            };
            Observation { residual: residual(x), gradient: gradient(residual, x) }
        })
    }

    fn oscillation(&self, point: &Point) -> Oscillation {
        let [amplitude, noise] = self.plan.oscillation(point.frequency);
        let over_rigid = self.shape.measured(&self.plan.model, point);
        Oscillation { omega: point.frequency, over_rigid, amplitude: amplitude * point.magnitude, noise }
    }

    /// N times (e^(-j w d T_s) times the nominal arm over the measured one, less the found arm), relative to the
    /// nominal rigid arm.
    fn residual(&self, oscillation: &Oscillation, x: &Unknowns) -> Complex<f64> {
        let &[inertia, delay, frequency, damping, tip_ratio, viscous, dry, drag_delay] = &x.data.0[0];
        let (omega, servo) = (oscillation.omega, &self.plan.nominal.servo);
        let [zero, pole] = self.shape.zero_and_pole(omega, [frequency, damping, tip_ratio]);
        let drag =
            Complex::new(dry, omega * DRAG_DELAY.0 * drag_delay) * dry_drag(oscillation) + viscous / (omega * UNIT);
        let nominal = 1.0 - Complex::I * servo.viscous_friction / (omega * servo.inertia) * self.shape.rigid(omega);
        let late = Complex::from_polar(1.0, -omega * self.plan.nominal.sample_period * delay);
        late * nominal * zero - oscillation.over_rigid * (pole * inertia - zero * drag * Complex::I)
    }

    /// Standard deviation of each part of it.
    fn deviation(&self, oscillation: &Oscillation, x: &Unknowns) -> f64 {
        let &[inertia, _, frequency, damping, tip_ratio, _, dry, _] = &x.data.0[0];
        let [zero, pole] = self.shape.zero_and_pole(oscillation.omega, [frequency, damping, tip_ratio]);
        let all = (oscillation.over_rigid * pole * inertia).norm();
        let drag = (oscillation.over_rigid * zero).norm() * dry_drag(oscillation) * dry.abs();
        let phase = (PRESLIDING / (PRESLIDING + oscillation.amplitude)).hypot((BENT * drag / all).min(1.0));
        (all * POINT_SIGMA.hypot(oscillation.noise / oscillation.amplitude)).hypot(drag * phase)
    }

    fn arm(&self, found: &Estimate<8>) -> IdentifiedArm {
        let Nominal { servo, tip, io_delay, .. } = &self.plan.nominal;
        let scaled = |i: usize, unit: f64| [unit * found.value[i], unit * found.sigma(i)];
        let [late, deviation] = scaled(1, 1.0);
        IdentifiedArm {
            inertia: scaled(0, servo.inertia),
            viscous_friction: scaled(5, servo.inertia / UNIT),
            dry_friction: scaled(6, servo.inertia / (UNIT * UNIT)),
            delay: [f64::from(*io_delay) + late, deviation],
            frequency: scaled(2, tip.frequency),
            damping: scaled(3, 1.0),
            tip_ratio: scaled(4, 1.0),
        }
    }
}

/// Fundamental of the dry friction F = 1 over the torque of the nominal rigid arm.
fn dry_drag(oscillation: &Oscillation) -> f64 {
    let slow = oscillation.omega * UNIT;
    4.0 / (PI * oscillation.amplitude * slow * slow)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use crate::servo::loop_model::LoopModel;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// The nominal machine after `change`.
    fn machine(change: impl FnOnce(&mut Parameters)) -> Nominal {
        let mut p = Parameters::START;
        change(&mut p);
        (&p).into()
    }

    /// Closed-loop response of the machine `actual` to the tones of a plan. Its dry friction reverses `drag_delay` (s)
    /// before the speed; `noise` scales the random error of each point in its standard deviation.
    fn response(plan: &Plan, actual: &Nominal, drag_delay: f64, [noise, seed]: [f64; 2]) -> FrequencyResponse {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed as u64);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let model = LoopModel::new(*actual, *plan.model.compensator());
        let mut seen = FrequencyResponse::EMPTY;
        for tone in &plan.tones {
            let omega = std::f64::consts::TAU * tone.frequency() / actual.sample_period;
            let (arm, compensator) = (model.arm(omega), model.open(omega) / model.arm(omega));
            // hold, current loop and delay of this machine: its response over that of the arm without them
            let shape = Shape::nominal(actual);
            let stiff = -actual.servo.inertia * omega * omega / shape.rigid(omega)
                + Complex::I * omega * actual.servo.viscous_friction;
            let (mut open, mut amplitude) = (model.open(omega), 0.0);
            for _ in 0..60 {
                amplitude = tone.amplitude * (open / (open + 1.0)).norm();
                let dry = Complex::from_polar(4.0 * actual.servo.dry_friction / (PI * amplitude), omega * drag_delay)
                    * Complex::I;
                open = compensator * arm * stiff / (stiff + dry);
            }
            let deviation = noise * POINT_SIGMA.hypot(plan.oscillation(omega)[1] / amplitude);
            open *= 1.0 + deviation * Complex::new(normal(), normal());
            seen.push(omega, open / (open + 1.0));
        }
        seen
    }

    #[test]
    fn every_unknown_is_found_far_from_its_nominal_value() {
        let plan = Plan::new(&Parameters::START);
        for (inertia, dry, frequency, delay, tip_ratio, damping) in [
            (1.4e-3, 0.015, 0.75, 2, 0.5, 0.014),
            (5e-4, 0.007, 1.28, 0, 0.36, 0.026),
            (8e-4, 0.0, 1.0, 1, 0.4375, 0.02),
        ] {
            let actual = machine(|p| {
                (p.servo.inertia, p.servo.dry_friction, p.servo.viscous_friction) = (inertia, dry, 3e-3);
                (p.tip.inertia, p.tip.damping, p.io_delay) = (tip_ratio, damping, delay);
                p.tip.frequency *= frequency;
            });
            let arm = find(&plan, &response(&plan, &actual, 0.0, [0.0, 1.0])).unwrap();
            let near = |[value, deviation]: [f64; 2], expected: f64, spread: f64| {
                assert!((value - expected).abs() < spread && deviation > 0.0, "{value} {expected}: {arm:?}");
            };
            near(arm.inertia, inertia, 1e-3 * inertia);
            near(arm.viscous_friction, 3e-3, 1e-4);
            near(arm.dry_friction, dry, 1e-4);
            near(arm.delay, f64::from(delay), 0.01);
            near(arm.frequency, actual.tip.frequency, 3e-3 * actual.tip.frequency);
            near(arm.tip_ratio, tip_ratio, 5e-3);
            near(arm.damping, damping, 1e-3);
        }
    }

    #[test]
    fn the_deviation_is_the_scatter_of_the_estimates() {
        let plan = Plan::new(&Parameters::START);
        let actual = machine(|p| p.servo.inertia = 9e-4);
        let all: Vec<IdentifiedArm> =
            (0..60).map(|seed| find(&plan, &response(&plan, &actual, 0.0, [1.0, seed.into()])).unwrap()).collect();
        type Of = fn(&IdentifiedArm) -> [f64; 2];
        let (servo, tip) = (actual.servo, actual.tip);
        for (of, expected) in [
            ((|arm| arm.inertia) as Of, 9e-4),
            (|arm| arm.viscous_friction, servo.viscous_friction),
            (|arm| arm.dry_friction, servo.dry_friction),
            (|arm| arm.delay, 1.0),
            (|arm| arm.frequency, tip.frequency),
            (|arm| arm.damping, tip.damping),
            (|arm| arm.tip_ratio, tip.inertia),
        ] {
            let nominal = all.iter().map(|arm| of(arm)[1]).sum::<f64>() / all.len() as f64;
            let scatter = all.iter().map(|arm| (of(arm)[0] - expected).powi(2)).sum::<f64>() / all.len() as f64;
            let ratio = scatter.sqrt() / nominal;
            assert!((0.7..1.3).contains(&ratio), "{expected}: {ratio}");
        }
    }

    #[test]
    fn friction_that_turns_round_before_the_speed_or_after_it_is_not_taken_for_anything_else() {
        let plan = Plan::new(&Parameters::START);
        let actual = machine(|p| p.servo.dry_friction = 0.015);
        for drag_delay in [-1e-4, 1e-4] {
            let arm = find(&plan, &response(&plan, &actual, drag_delay, [0.0, 1.0])).unwrap();
            let of = |[value, _]: [f64; 2], expected: f64| value / expected - 1.0;
            let errors = [of(arm.inertia, 8e-4), of(arm.dry_friction, 0.015), of(arm.frequency, actual.tip.frequency)];
            assert!(
                errors[0].abs() < 2e-3 && errors[1].abs() < 0.02 && errors[2].abs() < 5e-3,
                "{drag_delay}: {errors:?}"
            );
        }
    }

    #[test]
    fn a_late_encoder_counts_as_delay() {
        let plan = Plan::new(&Parameters::START);
        let (now, later) = (machine(|_| ()), machine(|p| p.io_delay = 2));
        // one sample later in the reading or in the command: the same response of the loop
        let late = find(&plan, &response(&plan, &later, 0.0, [0.0, 1.0])).unwrap();
        let prompt = find(&plan, &response(&plan, &now, 0.0, [0.0, 1.0])).unwrap();
        assert!((late.delay[0] - prompt.delay[0] - 1.0).abs() < 0.01, "{late:?} {prompt:?}");
    }

    #[test]
    fn the_uncertainty_of_a_point_combines_model_noise_and_phase_of_friction() {
        let plan = Plan::new(&Parameters::START);
        let (nominal, servo) = (Nominals::new(&plan), plan.nominal.servo);
        for (omega, amplitude) in [(30.0, 1e-3), (60.0, 1e-3), (60.0, 1e-4), (60.0, 0.02), (200.0, 0.01)] {
            let mut x = nominal.start();
            x[6] = 0.01 / servo.inertia * UNIT * UNIT;
            // 10 mN.m over what accelerates the arm
            let drag = 4.0 * 0.01 / (PI * amplitude) / (servo.inertia * omega * omega);
            let small = PRESLIDING / (PRESLIDING + amplitude);
            let bent = (BENT * drag).min(1.0);
            for noise in [0.0, 3.0] {
                let oscillation = Oscillation { omega, over_rigid: Complex::ONE, amplitude, noise: noise * amplitude };
                let expected = POINT_SIGMA.hypot(noise).hypot(drag * small.hypot(bent));
                let deviation = nominal.deviation(&oscillation, &x);
                assert!((deviation / expected - 1.0).abs() < 1e-3, "{omega} {amplitude}: {deviation} {expected}");
            }
        }
    }

    #[test]
    fn few_tones_determine_nothing() {
        let plan = Plan::new(&Parameters::START);
        assert!(find(&plan, &FrequencyResponse::EMPTY).is_err());
        let one = FrequencyResponse::from_model(&[300.0], |omega| plan.model.closed(omega));
        assert!(find(&plan, &one).is_err());
    }
}
