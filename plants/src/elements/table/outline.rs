//! Outline of a round part with lobes and roughness, met by the line of a probe.

use crate::element::{Element, Ports};
use crate::elements::signal::Lookup;

/// passes of the fixed point: each reduces the error by the slope of the outline over its radius
const PASSES: usize = 3;

/// Where the line `y = 0` meets the far side (+x) of the part: position, outward normal, velocity of the material.
///
/// `surface = cx + sqrt(R(phase)^2 - cy^2)` with the radius `R` of the part at `phase = direction - orientation`.
/// The part must reach the line: `|cy| < R`, otherwise the outputs are not finite.
#[derive(Clone, Debug)]
pub struct Outline {
    /// radius over the angle of the part, m
    radius: Lookup,
}

impl Outline {
    /// A part with a table of its radius, m.
    pub fn new(radius: Lookup) -> Self {
        Self { radius }
    }
}

impl Element for Outline {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["cx", "cy", "vcx", "vcy", "orientation", "turn_rate"],
            outputs: &["surface", "normal_x", "normal_y", "vx", "vy", "phase"],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let [cx, cy, vcx, vcy, orientation, turn_rate] =
            [inputs[0], inputs[1], inputs[2], inputs[3], inputs[4], inputs[5]];
        // from the centre to the point on the line: (reach, -cy)
        let (mut direction, mut reach, mut slope) = (0.0, 0.0, 0.0);
        for _ in 0..PASSES {
            let (radius, rise) = self.radius.at(direction - orientation);
            reach = (radius * radius - cy * cy).sqrt();
            slope = rise / radius;
            direction = (-cy).atan2(reach);
        }
        // the outline leans by its slope against the circle
        let lean = direction - slope.atan();
        let (normal_y, normal_x) = lean.sin_cos();
        let velocity = (vcx + turn_rate * cy, vcy + turn_rate * reach);
        let phase = direction - orientation;
        outputs.copy_from_slice(&[cx + reach, normal_x, normal_y, velocity.0, velocity.1, phase]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// 50 mm with three lobes of `amplitude`
    fn outline(amplitude: f64) -> Outline {
        let radius = |i: i32| 0.05 + amplitude * (3.0 * TAU * f64::from(i) / 8192.0).cos();
        Outline::new(Lookup::new((0..8192).map(radius).collect()).expect("samples"))
    }

    fn met(outline: &mut Outline, inputs: [f64; 6]) -> [f64; 6] {
        let mut out = [0.0; 6];
        outline.step(&inputs, &mut out, 1e-4);
        out
    }

    #[test]
    fn a_circle_is_met_where_pythagoras_says() {
        let mut circle = outline(0.0);
        for (cx, cy) in [(0.0, 0.0), (2e-3, 3e-3), (-0.02, 0.03), (0.01, -0.04)] {
            let out = met(&mut circle, [cx, cy, 0.0, 0.0, 1.0, 0.0]);
            let reach = (0.05_f64.powi(2) - cy * cy).sqrt();
            assert!((out[0] - cx - reach).abs() < 1e-15);
            assert!((out[1] - reach / 0.05).abs() < 1e-14 && (out[2] + cy / 0.05).abs() < 1e-14, "{out:?}");
        }
    }

    #[test]
    fn a_lobed_point_lies_on_the_outline_and_on_the_line() {
        let mut lobed = outline(5e-6);
        for k in 0..100 {
            let orientation = 0.1 * f64::from(k);
            let (cx, cy) = (0.01, 0.02 * (0.7 * f64::from(k)).sin());
            let out = met(&mut lobed, [cx, cy, 0.0, 0.0, orientation, 0.0]);
            let (dx, dy) = (out[0] - cx, -cy);
            let radius = 0.05 + 5e-6 * (3.0 * (dy.atan2(dx) - orientation)).cos();
            assert!((dx.hypot(dy) - radius).abs() < 1e-11, "orientation {orientation}: {} m", dx.hypot(dy));
        }
    }

    #[test]
    fn the_surface_moves_as_its_material_and_its_normal_say() {
        // the point on the line moves with normal . v / normal_x: rigid bodies keep contact along the normal
        let mut lobed = outline(2e-4);
        let inputs = |t: f64| [0.001 + 0.01 * t, 0.01 - 0.02 * t, 0.01, -0.02, 0.4 + 2.0 * t, 2.0];
        let h = 1e-3;
        let (before, now, after) =
            (met(&mut lobed, inputs(-h)), met(&mut lobed, inputs(0.0)), met(&mut lobed, inputs(h)));
        let wanted = (now[1] * now[3] + now[2] * now[4]) / now[1];
        let speed = (after[0] - before[0]) / (2.0 * h);
        assert!((speed - wanted).abs() < 1e-5, "{speed} and {wanted} m/s");
    }
}
