//! Part on a lathe: the sections along some diameters after cutting, and a probe that measures them.

use std::f64::consts::PI;

use crate::element::{Element, Ports};

/// Pitch of the section, m; the depth under a probe ball is wrong by less than 1 nm on flanks up to 60 degrees.
const PITCH: f64 = 1e-6;

/// Round tool, round probe and the blank.
#[derive(Clone, Debug)]
pub struct Shapes {
    /// radius of the tool nose, m
    pub tool_radius: f64,
    /// radius of the probe ball, m
    pub probe_radius: f64,
    /// radius of the part, m
    pub part_radius: f64,
    /// depth of the face of the blank, m
    pub face: f64,
    /// roughness that the material adds to each passage of the tool, standard deviation, m
    pub roughness: f64,
    /// number of diameters
    pub diameters: usize,
}

/// Depth of a part along N diameters: number k at the spindle angles k pi / N (positive positions) and half a
/// revolution further (negative positions).
///
/// Twice a revolution the tool passes a diameter, and while `cutting` is positive its nose removes all material above it:
/// `lateral` and `depth` are the position of the center of the nose from the spindle axis and into the part. While
/// `probing` is positive, `reading` is the depth of the lowest point of a ball that rests at the position `probe` on the
/// section which is nearest to the angle `turned` (rad), of which `angle` is the true one; otherwise both are 0. The
/// spindle need not turn to it: the sections stay as they were cut. While `blank` is positive the part is replaced by a
/// new one.
#[derive(Clone, Debug)]
pub struct TurnedPart {
    shapes: Shapes,
    /// depth at every position from `-part_radius` on, m, diameter after diameter
    sections: Vec<Vec<f64>>,
    /// angle, lateral position and depth of the step before
    before: Option<[f64; 3]>,
}

impl TurnedPart {
    /// A blank with a flat face.
    pub fn new(shapes: Shapes) -> Self {
        let places = 2 * (shapes.part_radius / PITCH).round() as usize + 1;
        Self { sections: vec![vec![shapes.face; places]; shapes.diameters.max(1)], before: None, shapes }
    }

    /// Angle between two diameters, rad.
    fn pitch(&self) -> f64 {
        PI / self.sections.len() as f64
    }

    /// The diameter at the angle number `k`, and 1, or -1 on its negative side.
    fn side(&self, k: f64) -> (usize, f64) {
        let k = k.rem_euclid(2.0 * self.sections.len() as f64) as usize;
        (k % self.sections.len(), if k < self.sections.len() { 1.0 } else { -1.0 })
    }

    /// The tool moves to `now`; it passes each diameter on its path.
    fn cut(&mut self, now: [f64; 3], roughness: f64) {
        let Some(before) = self.before else { return };
        let pitch = self.pitch();
        let (from, to) = ((before[0] / pitch).floor(), (now[0] / pitch).floor());
        if from == to {
            return;
        }
        // one passage per step: a plant step is far shorter than the distance to the next diameter
        let number = from.max(to);
        let share = (number * pitch - before[0]) / (now[0] - before[0]);
        let [lateral, depth] = [1, 2].map(|i| before[i] + share * (now[i] - before[i]));
        let (diameter, side) = self.side(number);
        self.pass(diameter, side * lateral, depth + roughness);
    }

    /// The nose removes all material above its lower half.
    fn pass(&mut self, diameter: usize, place: f64, depth: f64) {
        let nose = self.shapes.tool_radius;
        for i in self.within(place, nose) {
            let across = self.place(i) - place;
            let section = &mut self.sections[diameter];
            section[i] = section[i].max(depth + (nose * nose - across * across).max(0.0).sqrt());
        }
    }

    /// Depth of the lowest point of the ball that rests on a section.
    fn probe(&self, diameter: usize, place: f64) -> f64 {
        let ball = self.shapes.probe_radius;
        let clearance = |i: usize| {
            let across = self.place(i) - place;
            self.sections[diameter][i] - (ball * ball - across * across).max(0.0).sqrt()
        };
        let rest = self.within(place, ball).map(clearance).reduce(f64::min);
        rest.map_or(self.shapes.face, |centre| centre + ball)
    }

    /// Indices of the positions at most `reach` away.
    fn within(&self, place: f64, reach: f64) -> std::ops::Range<usize> {
        let index = |place: f64| (place + self.shapes.part_radius) / PITCH;
        // a cast from below zero gives zero
        let first = index(place - reach).ceil() as usize;
        let end = (index(place + reach).floor() + 1.0) as usize;
        first..end.min(self.sections[0].len())
    }

    fn place(&self, i: usize) -> f64 {
        i as f64 * PITCH - self.shapes.part_radius
    }
}

impl Element for TurnedPart {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["angle", "lateral", "depth", "cutting", "normal", "probing", "probe", "turned", "blank"],
            outputs: &["reading", "angle"],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let &[angle, lateral, depth, cutting, normal, probing, probe, turned, blank] = inputs else { return };
        let now = [angle, lateral, depth];
        if blank > 0.0 {
            self.sections.iter_mut().for_each(|section| section.fill(self.shapes.face));
        }
        if cutting > 0.0 {
            self.cut(now, self.shapes.roughness * normal);
        }
        self.before = Some(now);
        let number = (turned / self.pitch()).round();
        let (diameter, side) = self.side(number);
        let down = probing > 0.0;
        outputs[0] = if down { self.probe(diameter, side * probe) } else { 0.0 };
        outputs[1] = if down { number * self.pitch() } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: Shapes = Shapes {
        tool_radius: 2e-3,
        probe_radius: 1.5e-3,
        part_radius: 0.02,
        face: -1e-3,
        roughness: 0.0,
        diameters: 1,
    };

    /// Turns the part with the tool at `nose(turns)`, 100 steps a revolution.
    fn turn(part: &mut TurnedPart, turns: u32, nose: impl Fn(f64) -> [f64; 2]) {
        for k in 0..=100 * turns {
            let turned = f64::from(k) / 100.0;
            let [lateral, depth] = nose(turned);
            part.step(&[2.0 * PI * turned + 0.3, lateral, depth, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0], &mut [0.0; 2], 1e-4);
        }
    }

    fn read(part: &mut TurnedPart, place: f64) -> f64 {
        read_at(part, place, 0.0)[0]
    }

    /// Depth, and angle of the diameter, nearest to `turned`.
    fn read_at(part: &mut TurnedPart, place: f64, turned: f64) -> [f64; 2] {
        let mut out = [9.0; 2];
        part.step(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, place, turned, 0.0], &mut out, 1e-4);
        out
    }

    #[test]
    fn the_blank_has_its_face_and_nothing_is_read_with_the_probe_up() {
        let mut part = TurnedPart::new(SHAPES);
        for place in [-0.5, -0.02, -0.0123, 0.0, 0.02, 0.5] {
            assert!((read(&mut part, place) + 1e-3).abs() < 1e-12, "{place}");
        }
        let mut out = [9.0; 2];
        part.step(&[0.0; 9], &mut out, 1e-4);
        assert_eq!(out, [0.0; 2]);
    }

    #[test]
    fn a_groove_of_one_passage_is_the_nose() {
        let mut part = TurnedPart::new(SHAPES);
        turn(&mut part, 1, |_| [0.01, 1e-4]);
        // the ball touches the nose circle from inside: centres 0.5 mm apart at most
        for across in [0.0, 2e-4, -3e-4] {
            let exact = 1e-4 + (0.25e-6_f64 - across * across).sqrt() + 1.5e-3;
            for side in [-1.0, 1.0] {
                let depth = read(&mut part, side * (0.01 + across));
                assert!((depth - exact).abs() < 1e-9, "{across}: {depth} instead of {exact}");
            }
        }
    }

    #[test]
    fn a_cut_arc_is_probed_as_an_arc_of_the_sum_of_the_radii() {
        // arm of 80 mm from 40 to 50 degrees, 10 um per revolution: 0.08 + 0.002 - 0.0015 around the arm axis
        let mut part = TurnedPart::new(Shapes { part_radius: 0.03, ..SHAPES });
        let phi = |turned: f64| 0.7 + turned * 1e-5 / 0.08;
        turn(&mut part, 1300, |turned| [0.07 - 0.08 * phi(turned).cos(), 0.08 * phi(turned).sin()]);
        for angle in [0.74_f64, 0.78, 0.82] {
            let (across, exact) = (0.07 - 0.0805 * angle.cos(), 0.0805 * angle.sin() + 0.0015);
            for side in [-1.0, 1.0] {
                // the grooves of 10 um are 6 nm high, seen across the slope
                let error = read(&mut part, side * across) - exact;
                assert!(error.abs() < 10e-9, "{angle}: {error:e}");
            }
        }
    }

    #[test]
    fn only_what_is_higher_is_taken_away() {
        let mut part = TurnedPart::new(SHAPES);
        let deep = |_| [0.01, 2e-4];
        turn(&mut part, 1, deep);
        let before = part.sections.clone();
        turn(&mut part, 1, |_| [0.01, 1e-4]);
        assert_eq!(part.sections, before);
    }

    #[test]
    fn the_section_sees_the_tool_where_it_passes() {
        // depth oscillates once per revolution: both sides of the diameter differ by twice the amplitude
        let mut part = TurnedPart::new(SHAPES);
        turn(&mut part, 1, |turned| [0.01, 1e-4 * (2.0 * PI * turned + 0.3).cos()]);
        // straight between the steps, 63 mrad long: 50 nm
        assert!((read(&mut part, 0.01) - 2.1e-3).abs() < 5e-8);
        assert!((read(&mut part, -0.01) - 1.9e-3).abs() < 5e-8);
    }

    #[test]
    fn roughness_and_air() {
        let mut part = TurnedPart::new(Shapes { roughness: 1e-7, ..SHAPES });
        part.step(&[-0.1, 0.01, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0], &mut [0.0; 2], 1e-4);
        part.step(&[0.1, 0.01, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0], &mut [0.0; 2], 1e-4);
        assert!((read(&mut part, 0.01) + 1e-3).abs() < 1e-12);
        part.step(&[-0.1, 0.01, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0], &mut [0.0; 2], 1e-4);
        part.step(&[0.1, 0.01, 0.0, 1.0, 3.0, 0.0, 0.0, 0.0, 0.0], &mut [0.0; 2], 1e-4);
        assert!((read(&mut part, 0.01) - 2e-3 - 3e-7).abs() < 1e-12);
    }

    #[test]
    fn each_of_several_diameters_is_cut_and_read_at_its_two_angles() {
        let mut part = TurnedPart::new(Shapes { diameters: 4, ..SHAPES });
        let depth = |angle: f64| 1e-4 * (angle.cos() + 0.5 * (2.0 * angle).sin());
        turn(&mut part, 2, |turned| [0.01, depth(2.0 * PI * turned + 0.3)]);
        for k in -3..9 {
            let angle = f64::from(k) * PI / 4.0;
            for (place, at) in [(0.01, angle), (-0.01, angle + PI)] {
                let [read, told] = read_at(&mut part, place, angle + 0.3);
                // straight between the steps, 63 mrad long: 0.15 um
                assert!((read - depth(at) - 2e-3).abs() < 2e-7, "{k}, {place}: {read}");
                assert!((told - angle).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn another_part_is_a_blank() {
        let mut part = TurnedPart::new(Shapes { diameters: 2, ..SHAPES });
        turn(&mut part, 1, |_| [0.01, 1e-4]);
        part.step(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &mut [0.0; 2], 1e-4);
        assert!(
            (read(&mut part, 0.01) + 1e-3).abs() < 1e-12 && (read_at(&mut part, 0.01, 1.6)[0] + 1e-3).abs() < 1e-12
        );
    }
}
