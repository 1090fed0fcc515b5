//! Friction of ball screws and ball guides, which grows with the distance after each reversal (Dahl 1968).

use crate::element::{Element, Ports};

/// `force' = -(friction / distance) (v + |v| force / friction)`: a spring at the reversal, finally `friction`.
///
/// After a reversal the difference to the force of rolling falls to 1/e in every `distance`. The answer to a velocity
/// constant over the step is exact.
#[derive(Clone, Debug)]
pub struct RollingFriction {
    /// force while it rolls, N
    friction: f64,
    /// m
    distance: f64,
    /// force over `friction`
    share: f64,
}

impl RollingFriction {
    /// Friction of `friction` N with a change over `distance` m, both positive.
    pub fn new(friction: f64, distance: f64) -> Self {
        Self { friction, distance, share: 0.0 }
    }
}

impl Element for RollingFriction {
    fn ports(&self) -> Ports {
        Ports { inputs: &["velocity"], outputs: &["force"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let velocity = inputs[0];
        let missing = velocity.signum() + self.share;
        self.share += missing * (-velocity.abs() * h / self.distance).exp_m1();
        outputs[0] = self.friction * self.share;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// force after a distance at constant velocity
    fn roll(friction: &mut RollingFriction, velocity: f64, distance: f64) -> f64 {
        let (steps, mut out) = (1000.0, [0.0]);
        for _ in 0..1000 {
            friction.step(&[velocity], &mut out, distance / velocity.abs() / steps);
        }
        out[0]
    }

    #[test]
    fn at_first_a_spring_in_the_end_constant_at_any_speed() {
        for speed in [1e-6, 1e-3, 0.1] {
            let mut friction = RollingFriction::new(2.0, 20e-6);
            assert!((roll(&mut friction, speed, 10e-9) + 2.0 * 10e-9 / 20e-6).abs() < 1e-6);
            assert!((roll(&mut friction, speed, 1e-3) + 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn after_a_reversal_it_turns_exponentially() {
        let mut friction = RollingFriction::new(2.0, 20e-6);
        roll(&mut friction, 1e-3, 1e-3);
        let force = roll(&mut friction, -1e-4, 30e-6);
        assert!((force - 2.0 * (1.0 - 2.0 * (-1.5_f64).exp())).abs() < 1e-9, "{force}");
    }

    #[test]
    fn at_rest_it_stays() {
        let mut friction = RollingFriction::new(2.0, 20e-6);
        let force = roll(&mut friction, 1e-3, 10e-6);
        let mut out = [0.0];
        friction.step(&[0.0], &mut out, 1.0);
        assert!((out[0] - force).abs() < 1e-15);
    }
}
