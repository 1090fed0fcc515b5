//! The position loop as designed: sampled arm with its flexure, current loop and delays under the lead-lag compensator.
//!
//! Each mode of the arm, downstream of the current loop, is sampled exactly with its zero-order hold; the arm is their sum.

use nalgebra::{Complex, Matrix3, Matrix4, Vector3};
use serde::{Deserialize, Serialize};

use crate::servo::lead_lag::LeadLag;
use crate::servo::nominal::Nominal;

/// gain / ((s^2 + a_1 s + a_0)(s / w_c + 1)) sampled with a zero-order hold, falling powers of z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct SampledMode {
    numerator: [f64; 3],
    denominator: [f64; 3],
}

impl SampledMode {
    fn new(gain: f64, [a0, a1]: [f64; 2], current_bandwidth: f64, period: f64) -> Self {
        // states: angle, velocity, torque of the current loop; the last column is the command
        #[rustfmt::skip]
        let continuous = Matrix4::new(
            0.0, 1.0, 0.0, 0.0,
            -a0, -a1, gain, 0.0,
            0.0, 0.0, -current_bandwidth, current_bandwidth,
            0.0, 0.0, 0.0, 0.0,
        );
        let sampled = (continuous * period).exp();
        let phi: Matrix3<f64> = sampled.fixed_view::<3, 3>(0, 0).into();
        let gamma: Vector3<f64> = sampled.fixed_view::<3, 1>(0, 3).into();
        // Faddeev and Le Verrier: adjugate and characteristic polynomial
        let (mut adjugate, mut numerator, mut denominator) = (Matrix3::identity(), [0.0; 3], [0.0; 3]);
        for k in 0..3 {
            numerator[k] = (adjugate * gamma).x;
            let product = phi * adjugate;
            denominator[k] = -product.trace() / (k + 1) as f64;
            adjugate = product + Matrix3::identity() * denominator[k];
        }
        Self { numerator, denominator }
    }

    fn response(&self, z: Complex<f64>) -> Complex<f64> {
        let [n0, n1, n2] = self.numerator;
        let [d0, d1, d2] = self.denominator;
        ((z * n0 + n1) * z + n2) / (((z + d0) * z + d1) * z + d2)
    }
}

/// The loop: compensator, arm, delay.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopModel {
    period: f64,
    delay: i32,
    compensator: LeadLag,
    rigid: SampledMode,
    flexible: Option<SampledMode>,
}

/// The arm with current loop and delay at one frequency.
#[derive(Clone, Copy, Debug)]
pub struct ArmPoint {
    /// Frequency, rad/s.
    pub omega: f64,
    z: Complex<f64>,
    /// Response, rad/N.m.
    arm: Complex<f64>,
}

impl ArmPoint {
    /// An arm that no torque moves.
    pub const REST: Self = Self { omega: 0.0, z: Complex::ONE, arm: Complex::ZERO };

    /// The same, by `time` (s) later.
    #[must_use]
    pub fn later(self, time: f64) -> Self {
        Self { arm: self.arm * Complex::from_polar(1.0, -self.omega * time), ..self }
    }

    /// Open loop L with a compensator.
    pub fn open(&self, compensator: &LeadLag) -> Complex<f64> {
        self.arm * compensator.response(self.z)
    }

    /// Closed loop T = L / (1 + L); 1 below 1 rad/s.
    pub fn closed(&self, compensator: &LeadLag) -> Complex<f64> {
        // three integrators: far below the bandwidth there is no error, and z - 1 no accuracy
        if self.omega.abs() < 1.0 {
            return Complex::new(1.0, 0.0);
        }
        let open = self.open(compensator);
        open / (open + 1.0)
    }
}

impl LoopModel {
    /// The loop of the nominal arm with this compensator.
    pub fn new(nominal: impl Into<Nominal>, compensator: LeadLag) -> Self {
        let nominal = nominal.into();
        let (delay, Nominal { servo, tip, sample_period, .. }) = (nominal.loop_delay(), nominal);
        let mode =
            |gain: f64, a: [f64; 2]| SampledMode::new(gain / servo.inertia, a, servo.current_bandwidth, sample_period);
        let rigid = mode(1.0, [0.0, servo.viscous_friction / servo.inertia]);
        let flexible = (tip.frequency > 0.0 && tip.inertia > 0.0).then(|| {
            // two inertias: the locked arm resonates at the zero of the response of the hub, the free one at its pole
            let stiffening = 1.0 / (1.0 - tip.inertia);
            let squared = tip.frequency * tip.frequency * stiffening;
            mode(tip.inertia * stiffening, [squared, 2.0 * tip.damping * tip.frequency * stiffening])
        });
        Self { period: sample_period, delay, compensator, rigid, flexible }
    }

    /// The same loop with another compensator.
    #[must_use]
    pub fn with(self, compensator: LeadLag) -> Self {
        Self { compensator, ..self }
    }

    /// Response of the arm with current loop and delay, rad/N.m, at `omega` (rad/s).
    pub fn arm(&self, omega: f64) -> Complex<f64> {
        self.at(omega).arm
    }

    /// Arm with current loop and delay at `omega` (rad/s): the loop without its compensator.
    pub fn at(&self, omega: f64) -> ArmPoint {
        let (sine, cosine) = (omega * self.period).sin_cos();
        let z = Complex::new(cosine, sine);
        let arm = self.rigid.response(z) + self.flexible.map_or(Complex::new(0.0, 0.0), |mode| mode.response(z));
        ArmPoint { omega, z, arm: arm * z.powi(-self.delay) }
    }

    /// Open loop L at `omega` (rad/s, not 0).
    pub fn open(&self, omega: f64) -> Complex<f64> {
        self.at(omega).open(&self.compensator)
    }

    /// Closed loop T = L / (1 + L) from reference to encoder at `omega` (rad/s); 1 below 1 rad/s.
    pub fn closed(&self, omega: f64) -> Complex<f64> {
        self.at(omega).closed(&self.compensator)
    }

    /// The compensator.
    pub fn compensator(&self) -> &LeadLag {
        &self.compensator
    }

    /// Half the sampling frequency, rad/s.
    pub fn nyquist(&self) -> f64 {
        std::f64::consts::PI / self.period
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use std::f64::consts::TAU;

    fn model(p: &Parameters) -> LoopModel {
        // the crossover of the default design
        LoopModel::new(p, LeadLag::new(p, TAU * 118.843))
    }

    #[test]
    fn far_below_the_sampling_rate_the_arm_is_the_continuous_one() {
        let p = Parameters::START;
        for hertz in [5.0, 20.0, 100.0] {
            let s = Complex::new(0.0, TAU * hertz);
            let (j, z) = (p.servo.inertia, p.tip.frequency);
            let rigid = 1.0 / (s * (s * j + p.servo.viscous_friction));
            // hub of two inertias with a flexure
            let oscillator = s * s + s * 2.0 * p.tip.damping * z + z * z;
            let flexible = oscillator / (s * s * (1.0 - p.tip.inertia) + s * 2.0 * p.tip.damping * z + z * z);
            // the hold and the delay are late by 1.5 samples, the current loop by its time constant
            let late = (s * -1.5e-4).exp() / (s / p.servo.current_bandwidth + 1.0);
            let expected = rigid * flexible * late;
            let found = model(&p).arm(TAU * hertz);
            assert!((found - expected).norm() < 1e-3 * expected.norm(), "{hertz} Hz: {found} {expected}");
        }
    }

    #[test]
    fn the_sampled_arm_is_a_simulation_of_it() {
        // rigid arm under a sine of torque, substeps of 0.1 us
        let mut p = Parameters::START;
        p.tip.frequency = 0.0;
        p.io_delay = 2;
        let omega = TAU * 400.0;
        let (mut angle, mut velocity, mut torque) = (0.0, 0.0, 0.0);
        let (mut commands, dt, mut sum) = ([0.0; 2], 1e-7, Complex::new(0.0, 0.0));
        let mut drift = Vec::new();
        for k in 0..2000 {
            let phase = omega * 1e-4 * f64::from(k);
            drift.push((angle, Complex::new(phase.cos(), -phase.sin())));
            let command = commands[0];
            commands = [commands[1], phase.cos()];
            for _ in 0..1000 {
                torque += dt * p.servo.current_bandwidth * (command - torque);
                velocity += dt * (torque - p.servo.viscous_friction * velocity) / p.servo.inertia;
                angle += dt * velocity;
            }
        }
        // second differences take the drift away and leave the sine times (2 cos w T - 2)
        for window in drift[999..1751].windows(3) {
            let second = window[0].0 - 2.0 * window[1].0 + window[2].0;
            sum += window[1].1 * second * 2.0 / 750.0;
        }
        let found = sum / (2.0 * (omega * 1e-4).cos() - 2.0);
        let expected = model(&p).arm(omega);
        assert!((found - expected).norm() < 2e-3 * expected.norm(), "{found} {expected}");
    }

    #[test]
    fn what_is_later_by_a_sample_has_a_sample_of_delay_more() {
        let (p, slow) = (Parameters::START, Parameters { io_delay: 2, ..Parameters::START });
        for omega in [50.0, 900.0, 7000.0] {
            let later = model(&p).at(omega).later(p.sample_period);
            assert!((later.arm / model(&slow).at(omega).arm - 1.0).norm() < 1e-12, "{omega}");
        }
    }

    #[test]
    fn the_closed_loop_is_one_at_rest_and_mirrored_for_negative_frequencies() {
        let model = model(&Parameters::START);
        for omega in [0.0, 1e-12, 1e-3, 0.5] {
            assert_eq!(model.closed(omega), Complex::new(1.0, 0.0));
        }
        assert!((model.closed(1.1) - 1.0).norm() < 1e-6);
        assert!((model.closed(-500.0) - model.closed(500.0).conj()).norm() < 1e-15);
    }
}
