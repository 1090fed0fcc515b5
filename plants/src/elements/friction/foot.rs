//! Friction coefficient of one foot of a part that slides on a table.

use super::stribeck::Stribeck;
use crate::element::{Element, Ports};

/// `mu = stribeck(slip speed of the foot)`, once for each tangent of a contact.
///
/// The foot is at the position `place` on the part; the part moves with `vx`, `vy` and `yaw_rate` against the table.
#[derive(Clone, Debug)]
pub struct Foot {
    /// on the part, from the origin of its motion, m
    place: (f64, f64),
    law: Stribeck,
}

impl Foot {
    /// A foot at `place` m on the part, with a friction law.
    pub fn new(place: (f64, f64), law: Stribeck) -> Self {
        Self { place, law }
    }
}

impl Element for Foot {
    fn ports(&self) -> Ports {
        Ports { inputs: &["yaw", "vx", "vy", "yaw_rate"], outputs: &["mu_1", "mu_2"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let [yaw, vx, vy, yaw_rate] = [inputs[0], inputs[1], inputs[2], inputs[3]];
        let (sin, cos) = yaw.sin_cos();
        let (x, y) = (cos * self.place.0 - sin * self.place.1, sin * self.place.0 + cos * self.place.1);
        let slip = (vx - yaw_rate * y).hypot(vy + yaw_rate * x);
        outputs.fill(self.law.coefficient(slip));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn slip_is_that_of_the_foot_and_not_of_the_part() {
        let law = Stribeck { at_rest: 0.25, kinetic: 0.2, speed: 1e-3 };
        let mut foot = Foot::new((0.04, 0.0), law);
        let mut out = [0.0; 2];
        for (inputs, slip) in [
            ([0.0; 4], 0.0),
            ([0.3, 6e-4, 8e-4, 0.0], 1e-3),
            ([0.0, 0.0, 0.0, 0.05], 2e-3),
            // at a quarter revolution the foot is at (0, 0.04) and yaw takes it along -x
            ([FRAC_PI_2, 1e-3, 0.0, 0.025], 0.0),
            ([FRAC_PI_2, 1e-3, 0.0, -0.025], 2e-3),
        ] {
            foot.step(&inputs, &mut out, 1e-4);
            let wanted = law.coefficient(slip);
            assert!((out[0] - wanted).abs() < 1e-15 && out[0] == out[1], "{inputs:?}: {out:?}");
        }
    }
}
