//! Tool and burr: load, reaction and the remaining burr.

use super::burr::Burr;
use super::milling::Milling;
use crate::element::{Element, Ports};

/// Feed below which the reaction of a slow tool fades, m/s; a sudden change of sign would rattle.
const SLOW: f64 = 2e-3;

/// How the reaction of the burr acts on the tool.
#[derive(Clone, Copy, Debug)]
pub struct Reaction {
    /// against the direction of travel, relative to the tangential force
    pub along: f64,
    /// outward, relative to the tangential force
    pub outward: f64,
    /// maximum distance of the tip above or below the edge for cutting, m
    pub reach: f64,
}

/// An end mill on the burr of an edge.
///
/// Reads the position of the tip relative to the edge from [`Edge`](super::Edge). `part` is positive while
/// the part is present. In front of the tool is the remaining burr of its bin; after it the bins keep the deviation of
/// the tool.
#[derive(Clone, Debug)]
pub struct Deburring {
    burr: Burr,
    mill: Milling,
    reaction: Reaction,
    /// distance one step before
    before: Option<f64>,
    /// volume cut so far, m3
    removed: f64,
    /// volume above the edge, m3
    left: f64,
    /// depth of the tool inside the part, if more than its diameter, m
    crashed: Option<f64>,
}

impl Deburring {
    /// A mill on an untouched burr.
    pub fn new(burr: Burr, mill: Milling, reaction: Reaction) -> Self {
        let left = burr.volume();
        Self { burr, mill, reaction, before: None, removed: 0.0, left, crashed: None }
    }

    /// engagement and thickness in front of the tool, m
    fn engaged(&self, distance: f64, normal: f64) -> (f64, f64) {
        let (height, thickness) = self.burr.at(distance);
        ((height - normal).clamp(0.0, 2.0 * self.mill.radius), thickness)
    }
}

impl Element for Deburring {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["distance", "normal", "across", "tx", "ty", "tz", "nx", "ny", "nz", "spindle_speed", "part"],
            outputs: &[
                "torque",
                "force",
                "fx",
                "fy",
                "fz",
                "feed",
                "engagement",
                "finish_low",
                "finish_high",
                "removed",
                "left",
            ],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let &[distance, normal, across, tx, ty, tz, nx, ny, nz, speed, part] = inputs else { return };
        let before = self.before.replace(distance).unwrap_or(distance);
        let feed = if h > 0.0 { (distance - before) / h } else { 0.0 };
        let cuts = part > 0.0 && across.abs() <= self.reaction.reach;
        let (mut engagement, mut torque) = (0.0, 0.0);
        if cuts {
            let volume = self.burr.pass(before, distance, normal);
            if volume > 0.0 {
                self.removed += volume;
                self.left = self.burr.volume();
            }
            let (depth, thickness) = self.engaged(distance, normal);
            engagement = depth;
            self.crashed = Some(-normal).filter(|&inside| depth > 0.0 && inside > 2.0 * self.mill.radius);
            torque = self.mill.torque(depth, thickness, feed.abs(), speed);
        }
        let force = torque / self.mill.radius;
        let along = -self.reaction.along * force * feed / feed.hypot(SLOW);
        let outward = self.reaction.outward * force;
        let [low, high] = self.burr.finish();
        outputs[..5].copy_from_slice(&[
            torque,
            force,
            along * tx + outward * nx,
            along * ty + outward * ny,
            along * tz + outward * nz,
        ]);
        outputs[5..].copy_from_slice(&[feed, engagement, low, high, self.removed, self.left]);
    }

    fn stop(&self) -> Option<String> {
        let (inside, limit) = (self.crashed?, 2.0 * self.mill.radius);
        let hint = "hint: lift the tool before it crosses the part, or take the part away (command `workpiece`)";
        Some(format!("the tool is `{inside:.6}` m inside the part, limit `{limit:.6}` m\n{hint}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILL: Milling = Milling { teeth: 2.0, radius: 6e-3, pressure: 9e8, edge_force: 2e4, chip_most: 5e-4 };
    const REACTION: Reaction = Reaction { along: 0.5, outward: 0.35, reach: 0.01 };
    const H: f64 = 1e-3;

    fn deburring() -> Deburring {
        let burr = Burr::new(0.01, 2.5e-4, vec![4e-3; 40], vec![1.5e-3; 40]).expect("fits");
        Deburring::new(burr, MILL, REACTION)
    }

    /// Moves along the edge at 50 mm/s for 0.5 s; rows of outputs.
    fn pass(deburring: &mut Deburring, normal: f64, across: f64, part: f64) -> Vec<[f64; 11]> {
        // back to the start through the air
        deburring.step(&[0.0; 11], &mut [0.0; 11], H);
        let row = |k: i32| {
            let mut out = [0.0; 11];
            let distance = 0.05 * H * f64::from(k);
            let inputs = [distance, normal, across, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1800.0, part];
            deburring.step(&inputs, &mut out, H);
            out
        };
        (0..500).map(row).collect()
    }

    #[test]
    fn the_load_is_that_of_the_burr_in_front_and_pushes_back_and_out() {
        let mut deburring = deburring();
        let rows = pass(&mut deburring, 2e-4, 0.0, 1.0);
        let torque = MILL.torque(3.8e-3, 1.5e-3, 0.05, 1800.0);
        let middle = rows[300];
        assert!((middle[0] - torque).abs() < 1e-9, "{} instead of {torque}", middle[0]);
        assert!((middle[2] + 0.5 * torque / 6e-3).abs() < 0.1);
        assert!((middle[3] + 0.35 * torque / 6e-3).abs() < 1e-6);
        assert_eq!(rows[100][0], 0.0);
        assert_eq!(rows[420][0], 0.0);
        let end = rows[499];
        assert!((end[9] - 3.8e-3 * 1.5e-3 * 0.01).abs() < 1e-15);
        assert!((end[10] - 2e-4 * 1.5e-3 * 0.01).abs() < 1e-15);
        assert!(end[7] == 0.0 && (end[8] - 2e-4).abs() < 1e-15);
    }

    #[test]
    fn the_second_pass_finds_only_what_the_first_one_left() {
        let mut deburring = deburring();
        pass(&mut deburring, 2e-4, 0.0, 1.0);
        let rows = pass(&mut deburring, 0.0, 0.0, 1.0);
        assert!((rows[300][6] - 2e-4).abs() < 1e-15);
        assert!(rows[499][10].abs() < 1e-15);
    }

    #[test]
    fn a_tool_that_crosses_the_part_stops_the_plant() {
        let mut deburring = deburring();
        pass(&mut deburring, -1e-3, 0.0, 1.0);
        assert_eq!(deburring.stop(), None);
        let inputs = [0.015, -0.013, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1800.0, 1.0];
        deburring.step(&inputs, &mut [0.0; 11], H);
        assert!(deburring.stop().expect("a crash").contains("`0.013000` m inside the part, limit `0.012000` m\nhint:"));
    }

    #[test]
    fn a_tool_that_stands_in_the_burr_is_pushed_outward_alone() {
        let (mut deburring, mut out) = (deburring(), [0.0; 11]);
        let inputs = [0.015, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1800.0, 1.0];
        for _ in 0..2 {
            deburring.step(&inputs, &mut out, H);
        }
        assert_eq!(out[2], 0.0);
        assert!((out[3] + 0.35 * MILL.torque(4e-3, 1.5e-3, 0.0, 1800.0) / 6e-3).abs() < 1e-9);
    }

    #[test]
    fn without_part_or_far_above_it_nothing_happens() {
        for (across, part) in [(0.0, 0.0), (0.02, 1.0), (-0.02, 1.0)] {
            let mut deburring = deburring();
            let rows = pass(&mut deburring, 0.0, across, part);
            assert!(rows.iter().all(|row| row[0] == 0.0 && row[9] == 0.0));
            assert!((rows[499][5] - 0.05).abs() < 1e-12);
        }
    }
}
