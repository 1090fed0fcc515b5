//! The way to the start of the path around the part: back along the tool, across, and in along the tool.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::path::kinematics::{AXES, Joints};
use crate::path::transfer::TransferMotion;

/// Most legs.
const LEGS: usize = 3;
/// Axes that are as near as this to the end of a leg leave it out, rad or m.
const NEAR: f64 = 1e-3;

/// Legs that follow each other, with a rest between them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Route {
    legs: [TransferMotion; LEGS],
    count: usize,
    leg: usize,
    /// legs on which the tool may be in the part
    inside: [bool; LEGS],
}

impl Route {
    /// At rest at a position.
    pub fn at(position: &Joints) -> Self {
        let there = TransferMotion::at(position);
        Self { legs: [there.clone(), there.clone(), there], count: 1, leg: 0, inside: [false; LEGS] }
    }

    /// Straight to a position.
    pub fn straight(p: &Parameters, from: &Joints, to: &Joints, inside: bool) -> Self {
        let mut route = Self::at(from);
        route.count = 0;
        route.add(p, *from, to, inside);
        route
    }

    /// Back along the tool out of the part.
    pub fn out(p: &Parameters, from: &Joints) -> Self {
        Self::straight(p, from, &p.arm.retracted(from, p.transfer.clearance), true)
    }

    /// To the start `to` of the path; first out of the part when the tool is `inside`.
    pub fn around(p: &Parameters, from: &Joints, to: &Joints, inside: bool) -> Self {
        let mut route = Self::at(from);
        route.count = 0;
        let above = p.arm.retracted(to, p.transfer.clearance);
        let begin = if inside { p.arm.retracted(from, p.transfer.clearance) } else { *from };
        if inside {
            route.add(p, *from, &begin, true);
        }
        if (0..AXES).any(|i| (above[i] - begin[i]).abs() > NEAR) {
            route.add(p, begin, &above, false);
            route.add(p, above, to, true);
        } else {
            route.add(p, begin, to, true);
        }
        route
    }

    fn add(&mut self, p: &Parameters, from: Joints, to: &Joints, inside: bool) {
        self.legs[self.count] = TransferMotion::new(p, &from, to);
        self.inside[self.count] = inside;
        self.count += 1;
    }

    /// Position after one sample more; a held motion slows down and continues later.
    pub fn step(&mut self, dt: f64, hold: bool) -> Joints {
        if self.legs[self.leg].over() && self.leg + 1 < self.count {
            self.leg += 1;
        }
        self.legs[self.leg].step(dt, hold)
    }

    /// Whether it has come to its end.
    pub fn over(&self) -> bool {
        self.leg + 1 == self.count && self.legs[self.leg].over()
    }

    /// Whether the motion is held and at rest.
    pub fn stopped(&self) -> bool {
        self.legs[self.leg].over() || self.legs[self.leg].stopped()
    }

    /// Time of all its legs, s.
    pub fn time(&self) -> f64 {
        self.legs[..self.count].iter().map(TransferMotion::duration).sum()
    }

    /// Whether the tool may be in the part.
    pub fn inside(&self) -> bool {
        self.inside[self.leg]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const END: Joints = [0.3, 0.0, 0.7, 0.0, 0.0, 0.0];
    const START: Joints = [-0.1, 0.0, 0.66, 0.0, 0.0, 0.0];

    fn positions(mut route: Route) -> Vec<(Joints, bool)> {
        let mut positions = Vec::new();
        while !route.over() {
            let position = route.step(0.01, false);
            positions.push((position, route.inside()));
        }
        positions
    }

    #[test]
    fn out_of_the_part_the_tool_retracts_crosses_and_enters() {
        let p = Parameters::START;
        let positions = positions(Route::around(&p, &END, &START, true));
        for (position, inside) in &positions {
            // aside only above
            assert!(*inside || (position[1] - 0.02).abs() < 1e-12, "{position:?}");
            let aside = (position[0] - END[0]).abs() > 1e-12 && (position[0] - START[0]).abs() > 1e-12;
            assert!(!(aside && *inside), "{position:?}");
        }
        assert_eq!(positions.last().map(|position| position.0), Some(START));
        assert!(positions.iter().any(|position| !position.1));
    }

    #[test]
    fn above_the_start_it_only_comes_in() {
        let p = Parameters::START;
        let mut above = START;
        above[1] = 0.0202;
        let mut straight = TransferMotion::new(&p, &above, &START);
        for (position, _) in positions(Route::around(&p, &above, &START, false)) {
            assert_eq!(position, straight.step(0.01, false));
        }
    }

    #[test]
    fn an_axis_within_a_thousandth_of_its_position_above_is_there() {
        let p = Parameters::START;
        let above = p.arm.retracted(&START, p.transfer.clearance);
        for (offset, legs) in [(1e-3, 1), (-1e-3, 1), (1.001e-3, 2), (-1.001e-3, 2)] {
            let mut begin = above;
            begin[5] += offset;
            assert_eq!(Route::around(&p, &begin, &START, false).count, legs, "{offset}");
            begin = above;
            begin[0] += 1.01 * offset;
            assert_eq!(Route::around(&p, &begin, &START, false).count, 2);
        }
    }

    #[test]
    fn a_held_route_rests_within_a_leg_and_between_two() {
        let p = Parameters::START;
        for begin in [60, 151, 200] {
            let mut route = Route::around(&p, &END, &START, true);
            (0..begin).for_each(|_| assert!(!route.over() && route.step(0.01, false).len() == AXES));
            (0..40).for_each(|_| assert!(route.step(0.01, true).len() == AXES));
            let position = route.step(0.01, true);
            assert!(route.stopped() && position == route.step(0.01, true));
            assert_eq!(positions(route).last().map(|position| position.0), Some(START));
        }
    }
}
