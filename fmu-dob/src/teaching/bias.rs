//! The bias: travel between first touch and detection, as a function of the approach speed.
//!
//! After the touch the force grows by K v. While the filter remembers all of it, the energy of its answer grows with t^7, so that a
//! contact is found after t ~ (K v)^(-2/7) and v t ~ v^(5/7), and delays add v t_0. Slower than that it grows with t alone,
//! and v t ~ 1 / v. Between both the bias hardly depends on v: b(v) = b_0 + b_1 v + b_2 / v.

use serde::{Deserialize, Serialize};

use crate::interface::{Contact, Parameters};

/// The three parts of the bias.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bias {
    /// b_0, m.
    pub constant: f64,
    /// b_1, s.
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
        self.constant + self.fast * velocity + self.slow / velocity
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
        let bias = Bias { constant: 1.6e-7, fast: 1.3e-3, slow: 3e-13 };
        let mut p = Parameters::START;
        assert_eq!(Bias::of(&p).at(1e-4), 0.0);
        p.contact = Contact { bias: 1.6e-7, bias_fast: 1.3e-3, bias_slow: 3e-13 };
        assert_eq!(Bias::of(&p), bias);
        assert!((bias.at(1e-5) - 2.03e-7).abs() < 1e-18 && (bias.at(1e-4) - 2.93e-7).abs() < 1e-18);
        let names = bias.entries().map(|(name, _)| name);
        assert_eq!(names, ["contact.bias", "contact.bias_fast", "contact.bias_slow"]);
    }
}
