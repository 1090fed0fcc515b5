//! Position servo: proportional-derivative control of the acceleration over the disturbance observer.

use control_blocks::Trajectory;
use serde::{Deserialize, Serialize};

use crate::parameters::Parameters;

/// Commanded acceleration (m/s2): reference acceleration and PD control of position and velocity.
pub fn acceleration(p: &Parameters, reference: &Trajectory, position: f64, velocity: f64) -> f64 {
    let omega = p.servo.bandwidth;
    reference.acceleration
        + omega * omega * (reference.position - position)
        + 2.0 * p.servo.damping * omega * (reference.velocity - velocity)
}

/// Smallest step of the current command, A.
pub fn current_step(p: &Parameters) -> f64 {
    2.0 * p.stage.current_max / 2f64.powi(p.stage.current_bits)
}

/// The current (A) that the amplifier is told: limited, then rounded to its resolution.
pub fn quantise(p: &Parameters, current: f64) -> f64 {
    let (limit, step) = (p.stage.current_max, current_step(p));
    (current.clamp(-limit, limit) / step).round() * step
}

/// Integral action in place of the disturbance compensation; stands still while the current is limited.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Integrator {
    acceleration: f64,
}

impl Integrator {
    /// Adds one sample of the error (m) and gives the acceleration (m/s2).
    pub fn update(&mut self, p: &Parameters, error: f64, limited: bool) -> f64 {
        if !limited {
            self.acceleration += p.servo.integral_gain * error * p.sample_period;
        }
        self.acceleration
    }
}

/// Remembers which currents were told and which of them acted.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Amplifier {
    told: Vec<f64>,
    next: usize,
    limited_ticks: u32,
}

impl Amplifier {
    /// Samples in a row at the limit that are tolerated.
    const LIMITED_TICKS: u32 = 50;

    /// No current so far.
    pub fn new(p: &Parameters) -> Self {
        Self { told: vec![0.0; p.stage.io_delay as usize + 1], next: 0, limited_ticks: 0 }
    }

    /// The quantised and limited current (A) that acted during the last sample, `io_delay` samples late.
    pub fn acted(&self) -> f64 {
        self.told[self.next]
    }

    /// Tells the amplifier a current (A); returns what it will do.
    pub fn tell(&mut self, p: &Parameters, current: f64) -> f64 {
        let told = quantise(p, current);
        self.told[self.next] = told;
        self.next = (self.next + 1) % self.told.len();
        self.limited_ticks = if told.abs() >= quantise(p, p.stage.current_max) { self.limited_ticks + 1 } else { 0 };
        told
    }

    /// Whether the newest current was at the limit.
    pub fn limited(&self) -> bool {
        self.limited_ticks > 0
    }

    /// Whether the current was at the limit for too long.
    pub fn saturated(&self) -> bool {
        self.limited_ticks > Self::LIMITED_TICKS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_bits_over_ten_amperes() {
        let p = Parameters::DEFAULT;
        let step = current_step(&p);
        assert!((step - 152.587890625e-6).abs() < 1e-15);
        assert_eq!(quantise(&p, 0.4 * step), 0.0);
        assert_eq!(quantise(&p, 0.6 * step), step);
        assert_eq!(quantise(&p, -3.4 * step), -3.0 * step);
        assert_eq!(quantise(&p, 7.0), 5.0);
        assert_eq!(quantise(&p, -7.0), -5.0);
    }

    #[test]
    fn acted_current_is_late_by_the_delay() {
        for delay in 0..4 {
            let mut p = Parameters::DEFAULT;
            p.stage.io_delay = delay;
            let mut amplifier = Amplifier::new(&p);
            let mut acted = Vec::new();
            for k in 0..6 {
                acted.push(amplifier.acted());
                amplifier.tell(&p, f64::from(k + 1) * 100.0 * current_step(&p));
            }
            let first = acted.iter().position(|i| *i > 0.0).unwrap();
            assert_eq!(first as i32, delay + 1);
        }
    }

    #[test]
    fn saturation_needs_more_than_fifty_samples_in_a_row() {
        let p = Parameters::DEFAULT;
        let mut amplifier = Amplifier::new(&p);
        for _ in 0..50 {
            amplifier.tell(&p, 9.0);
        }
        assert!(amplifier.limited() && !amplifier.saturated());
        amplifier.tell(&p, -9.0);
        assert!(amplifier.saturated());
        amplifier.tell(&p, 4.9);
        assert!(!amplifier.limited() && !amplifier.saturated());
    }

    #[test]
    fn integrator_stands_still_at_the_limit() {
        let p = Parameters::DEFAULT;
        let mut integrator = Integrator::default();
        let a = integrator.update(&p, 1e-6, false);
        assert!((a - 2e6 * 1e-6 * 1e-4).abs() < 1e-18);
        assert_eq!(integrator.update(&p, 1e-6, true), a);
    }
}
