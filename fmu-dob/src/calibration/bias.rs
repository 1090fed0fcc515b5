//! The bias: travel between first touch and detection, as a function of the approach speed.
//!
//! After the touch the force grows by K v. While the filter stores all of it, the energy of its response grows with
//! t^7, so that a contact is found after t ~ (K v)^(-2/7) and v t ~ v^(5/7), and delays add v t_0. Slower than that it
//! grows with t alone, and v t ~ 1 / v. Between both the bias hardly depends on v: b(v) = b_0 + b_1 (v / v_1)^(5/7) +
//! b_2 / v, v_1 = 100 um/s.

use serde::{Deserialize, Serialize};

use crate::interface::{Contact, Parameters};

/// Speeds of a calibration cycle, in equal ratios: two more than the bias has parts.
pub const SPEEDS: usize = 5;

/// v_1, the speed at which the fast part is specified, m/s.
const FAST_VELOCITY: f64 = 1e-4;
/// Power of the speed with which the fast part grows.
const FAST_POWER: f64 = 5.0 / 7.0;

/// The three parts of the bias.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bias {
    /// b_0, m.
    pub constant: f64,
    /// b_1, m.
    pub fast: f64,
    /// b_2, m2/s.
    pub slow: f64,
}

impl Bias {
    /// That of the parameters.
    pub fn of(p: &Parameters) -> Self {
        let Contact { bias, bias_fast, bias_slow } = p.contact;
        Self { constant: bias, fast: bias_fast, slow: bias_slow }
    }

    /// The bias (m) at the approach speed (m/s).
    pub fn at(&self, velocity: f64) -> f64 {
        Self::parts_at(velocity)
            .into_iter()
            .zip([self.constant, self.fast, self.slow])
            .map(|(part, value)| part * value)
            .sum()
    }

    /// How much a unit of each of the three parts gives at the approach speed (m/s).
    pub fn parts_at(velocity: f64) -> [f64; 3] {
        [1.0, (velocity / FAST_VELOCITY).powf(FAST_POWER), velocity.recip()]
    }

    /// Names of the parameters and their values.
    pub fn entries(&self) -> [(&'static str, f64); 3] {
        [("contact.bias", self.constant), ("contact.bias_fast", self.fast), ("contact.bias_slow", self.slow)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_are_those_of_the_parameters_and_add_up() {
        let bias = Bias { constant: 1.6e-7, fast: 1.3e-7, slow: 3e-13 };
        let mut p = Parameters::START;
        assert_eq!(Bias::of(&p).at(1e-4), 0.0);
        p.contact = Contact { bias: 1.6e-7, bias_fast: 1.3e-7, bias_slow: 3e-13 };
        assert_eq!(Bias::of(&p), bias);
        assert!((bias.at(1e-4) - 2.93e-7).abs() < 1e-18);
        // 2^7 times as fast, the fast part is 2^5 times as large
        let fast = Bias { constant: 0.0, slow: 0.0, ..bias };
        assert!((fast.at(1.28e-3) / fast.at(1e-5) - 32.0).abs() < 1e-9);
        assert!((bias.at(1e-5) - fast.at(1e-5) - 1.9e-7).abs() < 1e-18);
        let names = bias.entries().map(|(name, _)| name);
        assert_eq!(names, ["contact.bias", "contact.bias_fast", "contact.bias_slow"]);
    }
}
