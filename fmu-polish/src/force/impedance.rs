//! Force law: velocity along the normal from the force error, by the impedance model (eq. 4), and its integral.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Largest velocity of the force integral, m/s.
const INTEGRAL_MAX: f64 = 5e-3;

/// Coefficients of eq. 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// exp(-B_d dt / M_d), 1.
    pub decay: f64,
    /// K_f / B_d, m/(s N).
    pub admittance: f64,
    /// K_f dt / (B_d T_i), m/(s N); 0 without an integral.
    pub integral: f64,
}

impl Coefficients {
    /// The coefficients for the damping `damping`, N s/m.
    pub fn new(p: &Parameters, damping: f64) -> Self {
        let admittance = p.impedance.gain / damping;
        let integral = match p.force.integral_time {
            0.0 => 0.0,
            time => admittance * p.sample_period / time,
        };
        Self { decay: (-damping * p.sample_period / p.impedance.mass).exp(), admittance, integral }
    }
}

/// Damping (N s/m) for the stiffness `stiffness` (N/m): that of the parameters, or what gives the desired loop gain.
pub fn damping(p: &Parameters, stiffness: f64) -> f64 {
    if p.impedance.adaptive && p.impedance.gain > 0.0 {
        p.impedance.gain * stiffness / p.impedance.bandwidth
    } else {
        p.impedance.damping
    }
}

/// State of the force control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ForceLaw {
    /// v_normal of eq. 4, m/s, positive out of the material.
    pub velocity: f64,
    /// Velocity from the integral of the force error, added to `velocity`, m/s.
    pub integral: f64,
}

impl ForceLaw {
    /// One sample of eq. 4 with the force error `error` = F_d - F (N).
    pub fn step(&mut self, law: &Coefficients, error: f64) -> f64 {
        // eq. 4: too little force moves against the outward normal, into the material
        self.velocity = self.velocity * law.decay + (law.decay - 1.0) * law.admittance * error;
        self.velocity
    }

    /// One sample of the integral.
    pub fn integrate(&mut self, law: &Coefficients, error: f64) -> f64 {
        self.integral = (self.integral - law.integral * error).clamp(-INTEGRAL_MAX, INTEGRAL_MAX);
        self.integral
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    #[test]
    fn eq_4_is_its_closed_form() {
        // constant error from v(0): v(k) = a^k v(0) - (1 - a^k) K_f / B_d E
        let law = Coefficients::new(&P, 3000.0);
        let (start, error) = (-0.5e-3, 1.7);
        let mut force_law = ForceLaw { velocity: start, integral: 0.0 };
        for k in 1..400 {
            let v = force_law.step(&law, error);
            let decay = (-3000.0 * 1e-3 / 10.0 * f64::from(k)).exp();
            let expected = decay * start - (1.0 - decay) * error / 3000.0;
            assert!((v - expected).abs() < 1e-12 * error, "sample {k}: {v} {expected}");
        }
    }

    #[test]
    fn too_little_force_moves_into_the_material_and_too_much_out() {
        let law = Coefficients::new(&P, 1e4);
        assert!(ForceLaw::default().step(&law, 1.0) < 0.0);
        assert!(ForceLaw::default().step(&law, -1.0) > 0.0);
        assert!(ForceLaw::default().integrate(&law, 1.0) < 0.0);
    }

    #[test]
    fn the_integral_ends_at_its_limit() {
        let law = Coefficients::new(&P, 1e4);
        let mut force_law = ForceLaw::default();
        (0..1_000_000).for_each(|_| {
            force_law.integrate(&law, -20.0);
        });
        assert_eq!(force_law.integral, INTEGRAL_MAX);
    }

    #[test]
    fn an_error_that_stays_is_integrated_within_its_time() {
        // after T_i the integral has added K_f / B_d E
        let p = Parameters { force: crate::interface::Force { integral_time: 0.2, ..P.force }, ..P };
        let (law, mut force_law) = (Coefficients::new(&p, 5e3), ForceLaw::default());
        (0..200).for_each(|_| {
            force_law.integrate(&law, 0.5);
        });
        assert!((force_law.integral + p.impedance.gain / 5e3 * 0.5).abs() < 1e-12, "{force_law:?}");
    }

    #[test]
    fn damping_follows_the_stiffness() {
        assert_eq!(damping(&P, 178e3), 178e3 / 35.0);
        assert_eq!(damping(&Parameters::PAPER, 178e3), 10e3);
    }
}
