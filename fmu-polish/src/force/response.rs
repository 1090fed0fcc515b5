//! Frequency response from a velocity along the normal to the force error, with the force loop closed.

use nalgebra::Complex;

use super::impedance::Coefficients;
use crate::interface::{Drive, Parameters};

impl Drive {
    /// With loops that are this many times as fast, and so much velocity fed forward.
    pub fn faster(&self, times: f64, feedforward: f64) -> Self {
        Self {
            position_gain: times * self.position_gain,
            velocity_bandwidth: times * self.velocity_bandwidth,
            feedforward,
            ..*self
        }
    }
}

/// Response of an axis from commanded to true position at `omega` rad/s.
pub fn axis(d: &Drive, omega: f64) -> Complex<f64> {
    rolling_axis(d, 0.0, omega)
}

/// The same on guides that pull back like a spring, `spring` in 1/s2.
pub fn rolling_axis(d: &Drive, spring: f64, omega: f64) -> Complex<f64> {
    let s = Complex::new(0.0, omega);
    // velocity loop: s v = w_v (1 + w_i / s) (v_ref - v) - c x
    let push = d.velocity_bandwidth * (s + d.velocity_integral);
    let velocity = push / (s * s + spring + push);
    // v_ref = K_pp (x_c - x) + K_ff / (1 + s / w_ff) s x_c
    let ahead = d.feedforward * s / (1.0 + s / d.feedforward_bandwidth);
    velocity * (d.position_gain + ahead) / (s + velocity * d.position_gain)
}

/// Way (m) of a velocity (m/s) that is held for a sample, at `omega` rad/s.
pub fn hold(p: &Parameters, omega: f64) -> Complex<f64> {
    let (s, dt) = (Complex::new(0.0, omega), p.sample_period);
    (1.0 - (-s * dt).exp()) / (s * s * dt)
}

/// Force error (N) over velocity (m/s) along the normal at `omega` rad/s, force loop open; stiffness in N/m.
pub fn open(p: &Parameters, stiffness: f64, omega: f64) -> Complex<f64> {
    let (s, dt) = (Complex::new(0.0, omega), p.sample_period);
    // a velocity that is held for a sample, and begins to act some samples later
    let hold = hold(p, omega);
    let late = (-s * dt * f64::from(p.io_delay)).exp();
    let sensor = 1.0 / (1.0 + s / p.sensor_bandwidth);
    let filter = match p.force.filter_bandwidth {
        0.0 => Complex::new(1.0, 0.0),
        bandwidth => {
            let keep = (-bandwidth * dt).exp();
            (1.0 - keep) / (1.0 - keep * (-s * dt).exp())
        }
    };
    stiffness * hold * late * axis(&p.drive, omega) * sensor * filter
}

/// Gain of the opened force loop: the response times the force control.
pub fn loop_gain(p: &Parameters, law: &Coefficients, stiffness: f64, omega: f64) -> Complex<f64> {
    let delay = (-Complex::new(0.0, omega) * p.sample_period).exp();
    let impedance = law.admittance * (1.0 - law.decay) / (1.0 - law.decay * delay);
    let integral = law.integral / (1.0 - delay);
    open(p, stiffness, omega) * (impedance + integral)
}

/// Force error over velocity with the force control closed around it.
pub fn closed(p: &Parameters, law: &Coefficients, stiffness: f64, omega: f64) -> Complex<f64> {
    open(p, stiffness, omega) / (1.0 + loop_gain(p, law, stiffness, omega))
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    #[test]
    fn the_axis_follows_slowly_and_not_fast() {
        assert!((axis(&P.drive, 0.1) - 1.0).norm() < 1e-3);
        // amplitude of a triangle of 100 um at 50 Hz
        let at_50 = axis(&P.drive, 314.16);
        assert!((at_50.norm() - 0.90).abs() < 0.02 && (at_50.arg() + 1.11).abs() < 0.03, "{at_50}");
        assert!(axis(&P.drive, 6283.0).norm() < 0.01);
    }

    #[test]
    fn at_low_frequencies_the_contact_is_an_integrator_and_the_loop_a_spring_and_damper() {
        let (k, omega) = (178e3, 0.5);
        let open = open(&P, k, omega);
        assert!((open - k / Complex::new(0.0, omega)).norm() < 0.01 * open.norm(), "{open}");
        let law = Coefficients { integral: 0.0, ..Coefficients::new(&P, 1e4) };
        let expected = k / (Complex::new(0.0, omega) + k / 1e4);
        let closed = closed(&P, &law, k, omega);
        assert!((closed - expected).norm() < 0.01 * expected.norm(), "{closed} {expected}");
    }

    #[test]
    fn a_command_that_is_held_and_late_and_a_filtered_force_are_that_much_later() {
        let (mut p, omega) = (P, 300.0);
        (p.io_delay, p.force.filter_bandwidth) = (3, 500.0);
        let (s, dt) = (Complex::new(0.0, omega), p.sample_period);
        let half = 0.5 * omega * dt;
        let held = half.sin() / half * (-s * (0.5 + 3.0) * dt).exp() / s;
        // the filter of its samples, f += (1 - e^(-w dt)) (x - f)
        let ratio = 1.0 - (-500.0 * dt).exp();
        let filter = ratio / (1.0 - (1.0 - ratio) * (-s * dt).exp());
        let expected = held * axis(&p.drive, omega) / (1.0 + s / p.sensor_bandwidth) * filter;
        let open = open(&p, 1.0, omega);
        assert!((open - expected).norm() < 1e-12 * expected.norm(), "{open} {expected}");
        // slow enough it is a first-order lag of the same bandwidth
        assert!((filter - 1.0 / (1.0 + s / 500.0)).norm() < 0.2);
    }
}
