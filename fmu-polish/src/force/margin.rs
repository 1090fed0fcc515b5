//! Phase margin of the force control: the remaining phase where the open loop has the gain 1.
//!
//! L(jw) = open(jw) (impedance + integral). The loop has one or two integrators and no unstable part. So by Nyquist's
//! criterion it is stable if the phase of L, unwrapped from low frequencies, is above -180 degrees wherever |L| falls
//! through 1. Integral time, gain, damping, filter, drives and delay all enter into it.

use nalgebra::Complex;

use super::impedance::{Coefficients, damping};
use super::response::loop_gain;
use crate::interface::Parameters;

/// Minimum phase margin, rad: 25 degrees, a resonance of about 1 / (2 sin 12.5 degrees) = 2.3.
pub const PHASE_MARGIN_MIN: f64 = 0.436;
/// Lowest frequency, rad/s.
const LOWEST: f64 = 0.05;
/// Frequencies.
const COUNT: u32 = 400;

/// Phase margin (rad) of the force control `law` on a contact of `stiffness` N/m; infinite where |L| is always below 1, and
/// minus infinite where it is 1 or more up to half the sample rate, beyond which nothing is controlled.
pub fn phase_margin(p: &Parameters, law: &Coefficients, stiffness: f64) -> f64 {
    let highest = std::f64::consts::PI / p.sample_period;
    let growth = (highest / LOWEST).powf(f64::from(COUNT).recip());
    let (mut omega, mut before) = (LOWEST, loop_gain(p, law, stiffness, LOWEST));
    let mut phase = initial(before);
    let mut margin = f64::INFINITY;
    for _ in 0..COUNT {
        omega *= growth;
        let now = loop_gain(p, law, stiffness, omega);
        // nearest branch: no step of the grid rotates by half a revolution
        phase += (now / before).arg();
        if before.norm() >= 1.0 && now.norm() < 1.0 {
            margin = margin.min(phase + std::f64::consts::PI);
        }
        before = now;
    }
    if before.norm() < 1.0 { margin } else { f64::NEG_INFINITY }
}

/// The smaller of the margins of settling and following at the nominal stiffness, each with its own damping.
pub fn minimum(p: &Parameters) -> f64 {
    let settling = Coefficients { integral: 0.0, ..Coefficients::new(p, p.impedance.damping) };
    let following = Coefficients::new(p, damping(p, p.stiffness_nominal));
    phase_margin(p, &settling, p.stiffness_nominal).min(phase_margin(p, &following, p.stiffness_nominal))
}

/// The phase between -360 and 0 degrees where two integrators begin, rad.
fn initial(gain: Complex<f64>) -> f64 {
    let phase = gain.arg();
    if phase > 0.0 { phase - std::f64::consts::TAU } else { phase }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    fn degrees(change: impl FnOnce(&mut Parameters)) -> f64 {
        let mut p = P;
        change(&mut p);
        let law = Coefficients::new(&p, damping(&p, p.stiffness_nominal));
        phase_margin(&p, &law, p.stiffness_nominal).to_degrees()
    }

    #[test]
    fn without_delay_and_lags_it_is_the_closed_form() {
        // drives and sensor a thousand times as fast as the loop: L = g (1 + 1 / (s T)) / s, of which the square of the
        // crossover is w^2 = g^2 / 2 (1 + sqrt(1 + 4 / (g T)^2)) and the margin atan(w T)
        let mut p = P;
        (p.io_delay, p.sample_period, p.sensor_bandwidth, p.impedance.mass) = (0, 2e-4, 1e6, 0.01);
        (p.drive.feedforward, p.drive.feedforward_bandwidth, p.drive.velocity_bandwidth) = (1.0, 1e5, 1e5);
        (p.impedance.bandwidth, p.force.integral_time) = (2.0, 0.5);
        let law = Coefficients::new(&p, damping(&p, p.stiffness_nominal));
        let (g, t) = (2.0f64, 0.5f64);
        let omega = (0.5 * g * g * (1.0 + (1.0 + 4.0 / (g * t).powi(2)).sqrt())).sqrt();
        let expected = (omega * t).atan();
        let margin = phase_margin(&p, &law, p.stiffness_nominal);
        assert!((margin / expected - 1.0).abs() < 0.03, "{margin} {expected}");
    }

    #[test]
    fn a_loop_that_never_falls_below_1_has_none() {
        let fast = |p: &mut Parameters| {
            (p.impedance.gain, p.impedance.damping, p.impedance.mass) = (100.0, 10.0, 0.01);
            p.impedance.adaptive = false;
        };
        assert_eq!(degrees(fast), f64::NEG_INFINITY);
    }

    #[test]
    fn what_oscillates_in_the_loop_has_none() {
        assert!(degrees(|_| ()) > 60.0);
        // 0..11.8 N and hops; 44.8 N; 0..22.6 N
        assert!(degrees(|p| p.force.integral_time = 1e-3) < 0.0);
        assert!(degrees(|p| p.force.filter_bandwidth = 10.0) < 10.0);
        assert!(degrees(|p| (p.impedance.gain, p.impedance.adaptive) = (20.0, false)) < 0.0);
        // each of them for itself costs phase
        assert!(degrees(|p| p.io_delay = 8) < degrees(|_| ()) - 10.0);
        assert!(degrees(|p| p.impedance.bandwidth = 100.0) < 40.0);
    }
}
