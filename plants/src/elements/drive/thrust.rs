//! Thrust of a linear motor whose force constant ripples along the magnetic track.

use std::f64::consts::TAU;

use crate::element::{Element, Ports};

/// `force[N] = force_constant (1 + ripple sin(2 pi position / pitch + phase)) current`.
#[derive(Clone, Debug)]
pub struct Thrust {
    /// N/A
    force_constant: f64,
    /// relative amplitude of the ripple
    ripple: f64,
    /// rad/m
    wavenumber: f64,
    /// rad
    phase: f64,
}

impl Thrust {
    /// A motor of `force_constant` N/A with a relative `ripple` of period `pitch` m.
    pub fn new(force_constant: f64, ripple: f64, pitch: f64, phase: f64) -> Self {
        Self { force_constant, ripple, wavenumber: TAU / pitch, phase }
    }
}

impl Element for Thrust {
    fn ports(&self) -> Ports {
        Ports { inputs: &["current", "position"], outputs: &["force"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let (current, position) = (inputs[0], inputs[1]);
        let ripple = self.ripple * (self.wavenumber * position + self.phase).sin();
        outputs[0] = self.force_constant * (1.0 + ripple) * current;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_follows_current_and_ripple() {
        let mut thrust = Thrust::new(20.0, 0.01, 0.03, 0.0);
        let mut out = [0.0];
        // zero, crest and trough of the ripple
        for (position, force) in [(0.0, 30.0), (0.0075, 30.3), (0.0225, 29.7)] {
            thrust.step(&[1.5, position], &mut out, 1e-4);
            assert!((out[0] - force).abs() < 1e-12, "at {position} m: {} N", out[0]);
        }
    }
}
