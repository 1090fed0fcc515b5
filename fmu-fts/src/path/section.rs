//! Depth that a probe measures on the part that a path cuts: the nose of the tool and the ball of the probe touch the
//! same section.
//!
//! The section at one angle of the part is the envelope of the nose, so that the center of the ball moves on the curve
//! that is R_t - R_p from that of the center of the nose: with Z' the slope dz/drho of the latter and q = sqrt(1 +
//! Z'^2) it is at rho - (R_t - R_p) Z' / q and z + (R_t - R_p) / q. The slope of both curves is the same there.

use nalgebra::Complex;

use crate::path::path_table::PathTable;

/// The slide position is found this well, m.
const TOLERANCE: f64 = 1e-12;
/// Steps of the search, each of which leaves a tenth of the error or less.
const STEPS_MAX: usize = 30;

/// A position on the section that the path cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Slide position at which the tool cuts it, m.
    pub slide_position: f64,
    /// Depth of the lowest point of the ball there, m.
    pub depth: f64,
    /// Slope of that depth to the distance from the spindle axis.
    pub slope: f64,
    /// Change of the probed depth per depth that is added to the path: 1 - Z' tan(phi), because the arm also moves
    /// sideways.
    pub gain: f64,
}

/// Where a ball of radius `ball` (m) at a distance (m) from the spindle axis rests on what a nose of radius `nose` (m)
/// cuts on the path without its correction, at the spindle angle of `phasors` (n = 0 first); none where the path does
/// not reach.
pub fn contact(path: &PathTable, [nose, ball]: [f64; 2], distance: f64, phasors: &[Complex<f64>]) -> Option<Contact> {
    let (arm, nose_offset) = (path.arm(), nose - ball);
    let mut slide_position = arm.slide_position(distance, 0.0);
    for _ in 0..STEPS_MAX {
        let [depth, along] = path.nominal_depth(slide_position, phasors);
        let tangent = arm.angle_tangent(depth);
        // drho/dx = -1 + tan(phi) dz/dx
        let slope = along / (tangent * along - 1.0);
        let root = slope.hypot(1.0);
        let miss = arm.distance(slide_position, depth) - nose_offset * slope / root - distance;
        if miss.abs() < TOLERANCE {
            let depth = depth + nose_offset / root + ball;
            let found = Contact { slide_position, depth, slope, gain: 1.0 - slope * tangent };
            return path.covers(slide_position).then_some(found);
        }
        slide_position += miss;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use crate::path::depth_table::DepthTable;
    use crate::path::kinematics::Arm;
    use crate::path::surface::center_depth;
    use crate::path::toric::section;
    use crate::tracking::phasors::Phasors;

    fn path(p: &Parameters) -> PathTable {
        PathTable::new(Arm::new(p), &DepthTable::of_surface(p).unwrap(), 24)
    }

    fn lens() -> Parameters {
        let mut p = Parameters::START;
        (p.surface.base_curvature, p.surface.tilt_x, p.surface.outer_radius) = (2.0, 0.02, 0.035);
        p.path.harmonics = 24;
        p
    }

    #[test]
    fn the_ball_rests_on_the_requested_surface() {
        let p = lens();
        let (path, nose) = (path(&p), p.tool.nose_radius[0]);
        for ball in [0.0, 1.5e-3, 4e-3] {
            for (distance, theta) in [(0.01, 0.0), (0.02, 0.7), (0.03, 1.6), (0.033, 4.0)] {
                let phasors = Phasors::new(theta, 24);
                let found = contact(&path, [nose, ball], distance, phasors.from_zero()).unwrap();
                // lowest center of a ball that nowhere cuts into the section
                let center = |k: i32| {
                    let across = 1e-6 * f64::from(k);
                    let sag = section(&p.surface, distance + across, theta.sin(), theta.cos()).sag;
                    center_depth(&p.surface) + nose - sag - (ball * ball - across * across).max(0.0).sqrt()
                };
                let reach = (1e6 * ball) as i32;
                let lowest = (-reach..=reach).map(center).fold(f64::INFINITY, f64::min) + ball;
                assert!((found.depth - lowest).abs() < 3e-9, "{ball} {distance} {theta}: {:e}", found.depth - lowest);
            }
        }
    }

    #[test]
    fn slope_and_gain_are_the_derivatives() {
        let p = lens();
        let (bare, theta, distance) = (path(&p), 0.4, 0.031);
        let phasors = Phasors::new(theta, 24);
        let at =
            |path: &PathTable, distance: f64| contact(path, [2e-3, 1.5e-3], distance, phasors.from_zero()).unwrap();
        let here = at(&bare, distance);
        let slope = (at(&bare, distance + 1e-6).depth - at(&bare, distance - 1e-6).depth) / 2e-6;
        assert!((here.slope - slope).abs() < 1e-6, "{} {slope}", here.slope);
        // a table that is 1 um deeper everywhere
        let mut table = DepthTable::of_surface(&p).unwrap();
        table.rows.iter_mut().for_each(|row| row[0] += 1e-6);
        let deeper = at(&PathTable::new(*bare.arm(), &table, 24), distance);
        let gain = (deeper.depth - here.depth) / 1e-6;
        assert!((here.gain - gain).abs() < 1e-4 && (gain - 1.0).abs() > 1e-3, "{} {gain}", here.gain);
    }

    #[test]
    fn beyond_the_path_there_is_nothing() {
        let path = path(&lens());
        let phasors = Phasors::new(0.3, 24);
        for (distance, there) in [(-0.001, false), (0.0005, true), (0.0345, true), (0.036, false), (f64::NAN, false)] {
            let found = contact(&path, [2e-3, 1.5e-3], distance, phasors.from_zero());
            assert_eq!(found.is_some(), there, "{distance}");
        }
    }
}
