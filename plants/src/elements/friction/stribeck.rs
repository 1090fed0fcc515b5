//! Dry friction that falls with the slip speed (Stribeck curve).

/// `mu(v) = kinetic + (static - kinetic) exp(-(v / speed)^2)`
#[derive(Clone, Copy, Debug)]
pub struct Stribeck {
    /// coefficient at rest
    pub at_rest: f64,
    /// coefficient at high speed
    pub kinetic: f64,
    /// slip speed at which the difference has fallen to 1/e, m/s
    pub speed: f64,
}

impl Stribeck {
    /// Coefficient at a slip speed of `slip` m/s.
    pub fn coefficient(&self, slip: f64) -> f64 {
        self.kinetic + (self.at_rest - self.kinetic) * (-(slip / self.speed).powi(2)).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_from_static_to_kinetic() {
        let law = Stribeck { at_rest: 0.25, kinetic: 0.2, speed: 1e-3 };
        assert_eq!(law.coefficient(0.0), 0.25);
        assert!((law.coefficient(1e-3) - (0.2 + 0.05 / std::f64::consts::E)).abs() < 1e-15);
        assert_eq!(law.coefficient(-1e-3), law.coefficient(1e-3));
        assert!((law.coefficient(1.0) - 0.2).abs() < 1e-15);
    }
}
