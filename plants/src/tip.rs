//! Tip of a slide that presses on a moving surface: a one-sided spring with friction.

use crate::{Element, Ports};

/// slip speed below which friction is mostly viscous, m/s
const SLIP: f64 = 1e-3;

/// Force of a tip on a surface, and how far the surface has driven the tip back.
///
/// The tip comes from +x on the line `y = 0`. Where the surface would be beyond it, `depth = surface - tip > 0`, it
/// presses with `preload min(1, depth / ramp) + stiffness depth + damping approach`, never pulls, and rubs with
/// `friction` times that force against the motion of the surface.
#[derive(Clone, Debug)]
pub struct Tip {
    /// force at first touch, N
    pub preload: f64,
    /// depth at which the preload is there, m
    pub ramp: f64,
    /// N/m
    pub stiffness: f64,
    /// N.s/m
    pub damping: f64,
    /// friction coefficient
    pub friction: f64,
}

impl Tip {
    /// normal force at a depth in m, along the normal, that grows by `approach` m/s
    fn force(&self, depth: f64, approach: f64) -> f64 {
        if depth <= 0.0 {
            return 0.0;
        }
        let preload = self.preload * (depth / self.ramp).min(1.0);
        (preload + self.stiffness * depth + self.damping * approach).max(0.0)
    }
}

impl Element for Tip {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["tip", "tip_speed", "surface", "normal_x", "normal_y", "vx", "vy"],
            outputs: &["collapse", "force", "fx", "fy"],
        }
    }

    fn reset(&mut self) {}

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let [tip, tip_speed, surface, nx, ny] = [inputs[0], inputs[1], inputs[2], inputs[3], inputs[4]];
        // velocity of the surface against the tip
        let (vx, vy) = (inputs[5] - tip_speed, inputs[6]);
        let depth = surface - tip;
        let force = self.force(depth * nx, vx * nx + vy * ny);
        let slip = vy * nx - vx * ny;
        let rub = self.friction * force * slip / slip.hypot(SLIP);
        // on the surface: against the normal, and against the slip along (-ny, nx)
        let (fx, fy) = (-force * nx + rub * ny, -force * ny - rub * nx);
        outputs.copy_from_slice(&[depth.max(0.0), force, fx, fy]);
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
        // on a leaning surface the force is still inside the friction cone about the normal
        let (ny, nx) = 0.3_f64.sin_cos();
        let out = press([0.0, 0.01, 1e-3, nx, ny, 0.02, 0.2]);
        let (normal, along) = (-out[2] * nx - out[3] * ny, out[2] * -ny + out[3] * nx);
        assert!((normal - out[1]).abs() < 1e-12);
        assert!(along < 0.0 && (along.abs() - 0.1 * out[1]).abs() < 1e-4 * out[1], "{along}");
    }
}
