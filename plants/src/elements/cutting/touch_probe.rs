//! A touch probe at the wall above an edge: a spring and a contact.

use crate::element::{Element, Ports};

/// Wall and probe, all m except the stiffnesses, N/m.
#[derive(Clone, Copy, Debug)]
pub struct TouchProbe {
    /// the wall extends between these distances along the edge
    pub wall: (f64, f64),
    /// its height above the edge
    pub height: f64,
    /// travel from the touch to the contact
    pub pretravel: f64,
    /// travel of the spring; beyond it the probe is at its stop
    pub travel: f64,
    /// stiffness of the spring, and of the probe at its stop
    pub stiffness: (f64, f64),
}

impl TouchProbe {
    /// Deflection of the probe by the wall, m.
    fn deflection(&self, distance: f64, normal: f64, across: f64) -> f64 {
        let (from, to) = self.wall;
        let beside = distance > from && distance < to && across > 0.0 && across < self.height;
        if beside { (-normal).max(0.0) } else { 0.0 }
    }

    fn force(&self, deflection: f64) -> f64 {
        let (spring, end) = self.stiffness;
        spring * deflection + end * (deflection - self.travel).max(0.0)
    }
}

impl Element for TouchProbe {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["distance", "normal", "across", "nx", "ny", "nz", "part", "probe"],
            outputs: &["contact", "deflection", "fx", "fy", "fz"],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let &[distance, normal, across, nx, ny, nz, part, probe] = inputs else { return };
        let there = part > 0.0 && probe > 0.0;
        let deflection = if there { self.deflection(distance, normal, across) } else { 0.0 };
        let force = self.force(deflection);
        let contact = if deflection > self.pretravel { 1.0 } else { 0.0 };
        outputs.copy_from_slice(&[contact, deflection, force * nx, force * ny, force * nz]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn felt(distance: f64, normal: f64, across: f64, part: f64, probe: f64) -> [f64; 5] {
        let wall = (0.03, 0.25);
        let mut touch = TouchProbe { wall, height: 0.018, pretravel: 1e-5, travel: 4e-3, stiffness: (1e3, 1e6) };
        let mut out = [0.0; 5];
        touch.step(&[distance, normal, across, 0.6, -0.8, 0.0, part, probe], &mut out, 1e-3);
        out
    }

    #[test]
    fn the_probe_gives_way_and_tells_it_after_its_pretravel() {
        assert_eq!(felt(0.1, 1e-6, 0.015, 1.0, 1.0), [0.0; 5]);
        let out = felt(0.1, -0.9e-5, 0.015, 1.0, 1.0);
        assert_eq!((out[0], out[1]), (0.0, 0.9e-5));
        let out = felt(0.1, -2e-3, 0.015, 1.0, 1.0);
        assert_eq!((out[0], out[1]), (1.0, 2e-3));
        assert!((out[2] - 1.2).abs() < 1e-12 && (out[3] + 1.6).abs() < 1e-12 && out[4] == 0.0);
    }

    #[test]
    fn at_its_end_it_is_stiff() {
        let out = felt(0.1, -5e-3, 0.015, 1.0, 1.0);
        assert!((out[2] - 0.6 * 1005.0).abs() < 1e-9, "{out:?}");
    }

    #[test]
    fn beside_the_wall_without_part_and_without_probe_there_is_nothing() {
        for (distance, across, part, probe) in [
            (0.029, 0.015, 1.0, 1.0),
            (0.251, 0.015, 1.0, 1.0),
            (0.1, 0.019, 1.0, 1.0),
            (0.1, -0.001, 1.0, 1.0),
            (0.1, 0.015, 0.0, 1.0),
            (0.1, 0.015, 1.0, 0.0),
        ] {
            assert_eq!(felt(distance, -1e-3, across, part, probe), [0.0; 5]);
        }
    }
}
