//! Lag of the servo without patterns: the distance of a drive with another gain from the model of its loop.
//!
//! It is held at its peak and decays. A drive of gain g leaves (1/g - 1)/((1 + s/(g Kp)) (1 + s/Kp)) of the lag, later
//! by both time constants. If the lag is at most that peak, e^(f Kp t) times the held value, it is at most (1/g -
//! 1)/((1 - f/g)(1 - f)): with f = 0.06 half of it at g = 0.7.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Rate of its decay in Kp, in motion and in the rest after it.
const FADING: [f64; 2] = [0.06, 0.5];

/// Lag of the bare servo, the reference speed V over Kp times the nominal gain, held at its peak with decay.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Lag {
    /// Held value with slow decay, the allowance in motion, rad or m.
    pub peak: f64,
    /// Held value with fast decay, the allowance in the rest after a run, rad or m.
    pub tail: f64,
    reference: f64,
}

impl Lag {
    /// At rest at a reference (rad or m).
    pub fn resting(reference: f64) -> Self {
        Self { peak: 0.0, tail: 0.0, reference }
    }

    /// Takes the reference (rad or m) that was sent to the axis `axis` (from 0).
    pub fn command(&mut self, p: &Parameters, axis: usize, reference: f64) {
        let moved = (reference - self.reference).abs();
        self.reference = reference;
        // gain of the loop times the sample period
        let decay = p.servo_gain[axis] * p.model.axis[axis].gain * p.sample_period;
        let lag = moved / decay;
        let [slow, fast] = FADING.map(|fading| (-fading * decay).exp());
        (self.peak, self.tail) = ((self.peak * slow).max(lag), (self.tail * fast).max(lag));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lag_of_the_bare_servo_is_held_and_fades() {
        let p = Parameters::START;
        let kp = p.servo_gain[2];
        let mut held = Lag::resting(0.0);
        // 0.1 m/s for a sample, and then rest: a lag of V/Kp
        held.command(&p, 2, 1e-3);
        let lag = 0.1 / kp;
        assert!((held.peak - lag).abs() < 1e-12 && (held.tail - lag).abs() < 1e-12);
        held.command(&p, 2, 1e-3);
        let faded = |fraction: f64| lag * (-fraction * kp * p.sample_period).exp();
        assert!((held.peak - faded(0.06)).abs() < 1e-12 && (held.tail - faded(0.5)).abs() < 1e-12);
    }
}
