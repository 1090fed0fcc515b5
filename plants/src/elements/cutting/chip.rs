//! Chip of a round nose that turns a face: its cross-section against the surface of the previous revolution.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use crate::element::{Element, Ports};

/// Points across the chip; a chip of 10 um by 10 um is right to 1 %.
const POINTS: usize = 64;

/// Cross-section (m2) of the chip of a nose that advances across a face while the part turns.
///
/// On the side already cut, the face is as deep as the groove of the previous revolution; on the uncut side it
/// is still `depth_of_cut` m higher and has the same form. The nose removes the material above its own circle that was not
/// removed in the previous revolution: a crescent whose area is the depth of cut times the feed as long as the groove
/// is unchanged, and more where the tool is deeper than a revolution ago. In the first revolution after air and beyond the
/// part there is no chip.
#[derive(Clone, Debug)]
pub struct Chip {
    /// m
    nose: f64,
    /// m
    depth_of_cut: f64,
    /// m
    part_radius: f64,
    /// 1 for a part that turns forward, -1 for backward
    sense: f64,
    /// angle in that sense, lateral position and depth of the nose over the last revolution
    turn: VecDeque<[f64; 3]>,
}

impl Chip {
    /// A nose of `nose` m and a face `depth_of_cut` m above the groove, up to `part_radius` m; the part
    /// turns backward where `backward` is set.
    pub fn new(nose: f64, depth_of_cut: f64, part_radius: f64, backward: bool) -> Self {
        Self { nose, depth_of_cut, part_radius, sense: if backward { -1.0 } else { 1.0 }, turn: VecDeque::new() }
    }

    /// lateral position and depth of the nose a revolution before `angle`, straight between the steps
    fn before(&mut self, angle: f64) -> Option<[f64; 2]> {
        let wanted = angle - TAU;
        while self.turn.get(1).is_some_and(|next| next[0] <= wanted) {
            self.turn.pop_front();
        }
        let (&first, &next) = (self.turn.front()?, self.turn.get(1)?);
        let share = (wanted - first[0]) / (next[0] - first[0]);
        (share >= 0.0).then(|| [1, 2].map(|i| first[i] + share * (next[i] - first[i])))
    }

    /// area between the new circle, the old one and the face, m2
    fn area(&self, now: [f64; 2], before: [f64; 2]) -> f64 {
        let engaged = now[1] - before[1] + self.depth_of_cut;
        if engaged <= 0.0 {
            return 0.0;
        }
        // depth above the centre of the old nose
        let circle = |across: f64| (self.nose * self.nose - across * across).max(0.0).sqrt();
        let face = self.nose - self.depth_of_cut;
        let half = (engaged * (2.0 * self.nose - engaged)).max(0.0).sqrt();
        let pitch = 2.0 * half / POINTS as f64;
        let taken = |i: usize| {
            let across = pitch * (i as f64 + 0.5) - half;
            let from_old = across + now[0] - before[0];
            let cut = from_old * (now[0] - before[0]) < 0.0;
            let left = if cut { self.nose } else { face.max(circle(from_old)) };
            (now[1] - before[1] + circle(across) - left).max(0.0)
        };
        pitch * (0..POINTS).map(taken).sum::<f64>()
    }
}

impl Element for Chip {
    fn ports(&self) -> Ports {
        Ports { inputs: &["angle", "lateral", "depth", "cutting"], outputs: &["area"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let &[turned, lateral, depth, cutting] = inputs else { return };
        let angle = self.sense * turned;
        outputs[0] = 0.0;
        if cutting <= 0.0 || lateral.abs() > self.part_radius {
            self.turn.clear();
            return;
        }
        if self.turn.back().is_some_and(|last| angle <= last[0]) {
            // a part without motion has no previous revolution
            self.turn.clear();
        }
        self.turn.push_back([angle, lateral, depth]);
        if let Some(before) = self.before(angle) {
            outputs[0] = self.area([lateral, depth], before);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOSE: f64 = 2e-3;
    const CUT: f64 = 1e-5;

    /// Areas of the chip, 1000 steps a revolution; `nose(turns)` is lateral position, depth and whether it cuts.
    fn turn(turns: u32, backward: bool, nose: impl Fn(f64) -> (f64, f64, f64)) -> Vec<f64> {
        let mut chip = Chip::new(NOSE, CUT, 0.05, backward);
        let step = |k: u32| {
            let turned = f64::from(k) / 1000.0;
            let (lateral, depth, cutting) = nose(turned);
            let angle = if backward { -TAU * turned } else { TAU * turned };
            let mut out = [9.0];
            chip.step(&[angle, lateral, depth, cutting], &mut out, 1e-4);
            out[0]
        };
        (0..1000 * turns).map(step).collect()
    }

    #[test]
    fn along_the_same_groove_it_is_the_depth_of_cut_times_the_feed() {
        // a groove that varies by 3.5 mm twice per revolution gives the area of a straight one
        for backward in [false, true] {
            for swing in [0.0, 3.5e-3] {
                let area = turn(3, backward, |t| (0.03 - 1e-5 * t, swing * (2.0 * TAU * t).cos(), 1.0));
                assert!(area[..1000].iter().all(|area| *area == 0.0));
                for found in &area[1001..] {
                    assert!((found / (CUT * 1e-5) - 1.0).abs() < 0.02, "{found:e}");
                }
            }
        }
    }

    #[test]
    fn where_the_tool_is_deeper_than_a_turn_ago_the_chip_is_thicker() {
        // ahead by d times half the chord of the face, after it by the part below the bottom of the old groove
        let deeper = 1e-6;
        let area = turn(2, false, |t| (0.03 - 1e-9 * t, if t < 1.0 { 0.0 } else { deeper }, 1.0));
        let segment = |depth: f64| {
            let angle = (1.0 - depth / NOSE).acos();
            NOSE * NOSE * (angle - angle.sin() * angle.cos())
        };
        let wanted = 0.5 * (segment(CUT + deeper) - segment(CUT) + segment(deeper));
        assert!((area[1500] / wanted - 1.0).abs() < 0.03, "{:e} instead of {wanted:e}", area[1500]);
    }

    #[test]
    fn there_is_no_chip_in_air_beyond_the_part_or_above_the_face() {
        let area = turn(3, false, |t| (0.03, 0.0, if t < 1.5 { 0.0 } else { 1.0 }));
        assert!(area[..2500].iter().all(|area| *area == 0.0));
        assert_eq!(turn(3, false, |t| (0.051, 1e-5 * t, 1.0)).iter().copied().fold(0.0, f64::max), 0.0);
        let area = turn(2, false, |t| (0.03, if t < 1.0 { 0.0 } else { -1.01 * CUT }, 1.0));
        assert!(area.iter().all(|area| *area == 0.0));
    }
}
