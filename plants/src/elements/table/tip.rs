//! Tip of a slide that presses on a moving surface: a one-sided spring with friction.

use crate::element::{Element, Ports};

/// slip speed below which friction is mostly viscous, m/s
const SLIP: f64 = 1e-3;
/// minimum fraction of the normal force that presses the tip back, so that a jammed tip stays finite
const JAM: f64 = 0.1;

/// Force of a tip on a surface, and the displacement of the tip by the surface.
///
/// The tip comes from +x and yields along the line `y = 0`. Where the surface would be beyond it,
/// `collapse = surface - tip > 0`, it presses along the line with
/// `preload min(1, collapse / ramp) + stiffness collapse + damping collapse'`, and never pulls. The surface answers
/// with the necessary normal force, and rubs with `friction` times that force against its motion.
#[derive(Clone, Debug)]
pub struct Tip {
    /// force at first touch, N
    pub preload: f64,
    /// collapse at which the full preload acts, m
    pub ramp: f64,
    /// N/m
    pub stiffness: f64,
    /// N.s/m
    pub damping: f64,
    /// friction coefficient
    pub friction: f64,
}

impl Tip {
    /// force along the line at a collapse in m that grows by `rate` m/s
    fn axial(&self, collapse: f64, rate: f64) -> f64 {
        if collapse <= 0.0 {
            return 0.0;
        }
        let preload = self.preload * (collapse / self.ramp).min(1.0);
        (preload + self.stiffness * collapse + self.damping * rate).max(0.0)
    }
}

impl Element for Tip {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["tip", "tip_speed", "surface", "normal_x", "normal_y", "vx", "vy"],
            outputs: &["collapse", "force", "fx", "fy"],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let [tip, tip_speed, surface, nx, ny] = [inputs[0], inputs[1], inputs[2], inputs[3], inputs[4]];
        let (vx, vy) = (inputs[5], inputs[6]);
        let collapse = surface - tip;
        let rate = (vx * nx + vy * ny) / nx - tip_speed;
        // slip along the tangent (-ny, nx), and the part of the normal force that friction makes of it
        let slip = vy * nx - (vx - tip_speed) * ny;
        let rub = self.friction * slip / slip.hypot(SLIP);
        let force = self.axial(collapse, rate) / (nx - rub * ny).max(JAM);
        outputs.copy_from_slice(&[collapse.max(0.0), force, -force * (nx - rub * ny), -force * (ny + rub * nx)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIP: Tip = Tip { preload: 0.3, ramp: 1e-6, stiffness: 1e3, damping: 2.0, friction: 0.1 };

    fn press(inputs: [f64; 7]) -> [f64; 4] {
        let mut out = [0.0; 4];
        TIP.clone().step(&inputs, &mut out, 1e-4);
        out
    }

    #[test]
    fn no_force_before_the_touch_and_none_that_pulls() {
        assert_eq!(press([0.05, 0.0, 0.049, 1.0, 0.0, 0.0, 0.1]), [0.0; 4]);
        let out = press([0.05, 0.0, 0.0501, 1.0, 0.0, -10.0, 0.0]);
        assert_eq!(out[1], 0.0);
        assert!((out[0] - 1e-4).abs() < 1e-15);
    }

    #[test]
    fn force_is_preload_spring_and_damping() {
        for (depth, approach, wanted) in
            [(0.5e-6, 0.0, 0.15 + 0.5e-3), (1e-6, 0.0, 0.301), (1e-3, 0.0, 1.3), (1e-3, 0.1, 1.5)]
        {
            let out = press([0.0, 0.0, depth, 1.0, 0.0, approach, 0.0]);
            assert!((out[1] - wanted).abs() < 1e-12, "{depth} m: {} N", out[1]);
            assert!((out[2] + wanted).abs() < 1e-12);
        }
    }

    #[test]
    fn friction_follows_the_surface_and_damping_takes_energy() {
        // the surface moves by +y: the tip holds it back
        let out = press([0.0, 0.0, 1e-3, 1.0, 0.0, 0.0, 0.2]);
        assert!((out[3] + 0.1 * out[1]).abs() < 1e-5 * out[1], "{out:?}");
        assert!((press([0.0, 0.0, 1e-3, 1.0, 0.0, 0.0, -0.2])[3] + out[3]).abs() < 1e-15);
    }

    #[test]
    fn on_a_leaning_surface_the_spring_acts_along_the_line_and_friction_along_the_surface() {
        let (ny, nx) = 0.3_f64.sin_cos();
        // the material moves along the tangent: the surface stays where it is
        let out = press([0.0, 0.0, 1e-3, nx, ny, -0.2 * ny, 0.2 * nx]);
        assert!((out[2] + 1.3).abs() < 1e-12, "{out:?}");
        let (normal, along) = (-out[2] * nx - out[3] * ny, out[3] * nx - out[2] * ny);
        assert!((normal - out[1]).abs() < 1e-12);
        assert!((along + 0.1 * normal).abs() < 1e-4 * normal, "{along}");
    }
}
