//! The position loop as designed: sampled arm with its flexure, current loop and delay under the lead-lag compensator.
//!
//! Each mode of the arm, behind the current loop, is sampled exactly with its zero-order hold; the arm is their sum.

use nalgebra::{Complex, Matrix3, Matrix4, Vector3};
use serde::{Deserialize, Serialize};

use crate::lead_lag::LeadLag;
use crate::parameters::Parameters;

/// gain / ((s^2 + a_1 s + a_0)(s / w_c + 1)) sampled with a zero-order hold, falling powers of z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct SampledMode {
    numerator: [f64; 3],
    denominator: [f64; 3],
}

impl SampledMode {
    fn new(gain: f64, [a0, a1]: [f64; 2], current_bandwidth: f64, period: f64) -> Self {
        // states: angle, velocity, torque behind the current loop; the last column is the command
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

impl LoopModel {
    /// The loop of the nominal arm with this compensator.
    pub fn new(p: &Parameters, compensator: LeadLag) -> Self {
        let (servo, tip) = (&p.servo, &p.tip);
        let mode = |gain: f64, a: [f64; 2]| {
            SampledMode::new(gain / servo.inertia, a, servo.current_bandwidth, p.sample_period)
        };
        let rigid = mode(1.0, [0.0, servo.viscous_friction / servo.inertia]);
        let flexible = (tip.frequency > 0.0 && tip.inertia > 0.0).then(|| {
            // two inertias: the locked arm swings at the zero, the free one at the pole of the hub's response
            let free = tip.frequency / (1.0 - tip.inertia).sqrt();
            mode(tip.inertia / (1.0 - tip.inertia), [free * free, 2.0 * tip.damping * free])
        });
        Self { period: p.sample_period, delay: servo.io_delay, compensator, rigid, flexible }
    }

    /// Response of the arm with current loop and delay, rad/N.m, at `omega` (rad/s).
    pub fn arm(&self, omega: f64) -> Complex<f64> {
        let (sine, cosine) = (omega * self.period).sin_cos();
        let z = Complex::new(cosine, sine);
        let arm = self.rigid.response(z) + self.flexible.map_or(Complex::new(0.0, 0.0), |mode| mode.response(z));
        arm * z.powi(-self.delay)
    }

    /// Open loop L at `omega` (rad/s, not 0).
    pub fn open(&self, omega: f64) -> Complex<f64> {
        let (sine, cosine) = (omega * self.period).sin_cos();
        self.arm(omega) * self.compensator.response(Complex::new(cosine, sine))
    }

    /// Closed loop T = L / (1 + L) from reference to encoder at `omega` (rad/s); 1 at 0.
    pub fn closed(&self, omega: f64) -> Complex<f64> {
        if omega == 0.0 {
            return Complex::new(1.0, 0.0);
        }
        let open = self.open(omega);
        open / (open + 1.0)
    }

    /// Half the sampling frequency, rad/s.
    pub fn nyquist(&self) -> f64 {
        std::f64::consts::PI / self.period
    }
}
