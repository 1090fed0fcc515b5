//! Tool path over a surface: depth of the nose center at a slide position and spindle angle.
//!
//! The tool is flat-faced with a round nose in the radial plane. Its center lies R_t along the normal of the section:
//! z = z_c - s + R_t (1 - 1/q), rho = rho_c - R_t s'/q with q = sqrt(1 + s'^2) at the point of contact rho_c. The arm
//! moves sideways with its depth, rho = (x_0 - x) - R_a cos phi, so that the path belongs to the slide position.

use control_blocks::ParameterError;

use crate::interface::{Parameters, Surface, SurfaceKind};
use crate::path::kinematics::Arm;
use crate::path::toric::{Section, rim, section};

/// The point of contact is found this well, m.
const TOLERANCE: f64 = 1e-13;
/// Newton never steps farther, m.
const STEP_MAX: f64 = 2e-3;
/// Newton steps.
const STEPS_MAX: usize = 60;

/// A toric surface under the selected tool.
pub struct ToolPath<'a> {
    surface: &'a Surface,
    arm: Arm,
    nose_radius: f64,
    center_depth: f64,
}

/// The nose center for a point of contact.
struct Nose {
    depth: f64,
    distance: f64,
    /// derivatives to the distance of the point of contact
    depth1: f64,
    distance1: f64,
}

/// Searches that go on side by side, so that they do not wait for each other's divisions.
const BLOCK: usize = 8;

/// Some spindle angles, rad, with their sines and cosines.
pub struct Directions {
    angles: Vec<f64>,
    blocks: Vec<[(f64, f64); BLOCK]>,
}

impl Directions {
    /// The directions of angles, rad.
    pub fn new(angles: impl IntoIterator<Item = f64>) -> Self {
        let angles: Vec<f64> = angles.into_iter().collect();
        // the last block is filled up with its last angle
        let block = |block: &[f64]| std::array::from_fn(|i| block[i.min(block.len() - 1)].sin_cos());
        Self { blocks: angles.chunks(BLOCK).map(block).collect(), angles }
    }
}

/// Result of Newton's method for a point of contact, when it is over.
#[derive(Clone, Copy)]
enum Found {
    /// Depth of the nose center, m.
    Depth(f64),
    /// The surface is concave with a smaller radius than the nose, at this distance from the spindle axis, m.
    TooBlunt(f64),
}

impl<'a> ToolPath<'a> {
    /// The surface of `p` under its selected tool.
    pub fn new(p: &'a Parameters) -> Self {
        Self {
            surface: &p.surface,
            arm: Arm::new(p),
            nose_radius: p.tool.nose_radius[p.tool.index()],
            center_depth: center_depth(&p.surface),
        }
    }

    /// Depths z (m) of the nose center at a slide position (m) and some spindle angles.
    ///
    /// # Errors
    /// Where the tool cannot reach the surface.
    pub fn depths(&self, slide_position: f64, directions: &Directions) -> Result<Vec<f64>, ParameterError> {
        if self.surface.kind == SurfaceKind::Wave {
            return Ok(directions.angles.iter().map(|angle| self.wave(*angle)).collect());
        }
        let conclude = |found: Option<Found>| match found {
            Some(Found::Depth(depth)) => Ok(depth),
            Some(Found::TooBlunt(contact)) => Err(self.too_blunt(contact)),
            None => Err(self.out_of_reach(slide_position)),
        };
        let blocks = directions.blocks.iter().flat_map(|block| self.search(slide_position, block));
        blocks.take(directions.angles.len()).map(conclude).collect()
    }

    /// Depth z (m) of the nose center at a slide position (m) and spindle angle (rad).
    #[cfg(test)]
    pub fn depth(&self, slide_position: f64, spindle_angle: f64) -> Result<f64, ParameterError> {
        self.depths(slide_position, &Directions::new([spindle_angle])).map(|depths| depths[0])
    }

    fn wave(&self, spindle_angle: f64) -> f64 {
        let phase = f64::from(self.surface.wave_harmonic) * spindle_angle;
        self.center_depth + self.surface.wave_amplitude * phase.cos()
    }

    /// Newton's method for the points of contact in some directions (sine, cosine).
    fn search(&self, slide_position: f64, directions: &[(f64, f64); BLOCK]) -> [Option<Found>; BLOCK] {
        let limit = rim(self.surface);
        let mut contacts = [self.arm.distance(slide_position, 0.0).clamp(-limit, limit); BLOCK];
        let mut found = [None; BLOCK];
        for _ in 0..STEPS_MAX {
            let at = |i: usize| section(self.surface, contacts[i], directions[i].0, directions[i].1);
            let sections: [Section; BLOCK] = std::array::from_fn(at);
            let roots = sections.each_ref().map(|section| section.slope.hypot(1.0));
            let noses: [Nose; BLOCK] = std::array::from_fn(|i| self.nose(&sections[i], roots[i], contacts[i]));
            // d(R_a cos phi)/dz = -tan phi
            let tangent = |nose: &Nose| (nose.depth / self.arm.length).clamp(-0.999, 0.999).asin().tan();
            let tangents = noses.each_ref().map(tangent);
            for (((contact, nose), tangent), found) in contacts.iter_mut().zip(&noses).zip(tangents).zip(&mut found) {
                if found.is_none() {
                    *found = self.step(slide_position, limit, nose, tangent, contact);
                }
            }
            if found.iter().all(Option::is_some) {
                break;
            }
        }
        found
    }

    /// One Newton step, unless the search is over.
    fn step(&self, slide_position: f64, limit: f64, nose: &Nose, tangent: f64, contact: &mut f64) -> Option<Found> {
        if nose.distance1 <= 0.0 {
            return Some(Found::TooBlunt(*contact));
        }
        let miss = nose.distance - self.arm.distance(slide_position, nose.depth);
        let step = miss / (nose.distance1 - tangent * nose.depth1);
        if step.abs() < TOLERANCE {
            return Some(Found::Depth(nose.depth));
        }
        *contact = (*contact - step.clamp(-STEP_MAX, STEP_MAX)).clamp(-limit, limit);
        None
    }

    /// The nose at a point of contact, where q = sqrt(1 + s'^2).
    fn nose(&self, section: &Section, q: f64, contact: f64) -> Nose {
        let curvature = self.nose_radius * section.bend / (q * q * q);
        Nose {
            depth: self.center_depth - section.sag + self.nose_radius * (1.0 - 1.0 / q),
            distance: contact - self.nose_radius * section.slope / q,
            depth1: section.slope * (curvature - 1.0),
            distance1: 1.0 - curvature,
        }
    }

    fn too_blunt(&self, contact: f64) -> ParameterError {
        ParameterError {
            name: "tool.nose_radius",
            value: format!("{} m", self.nose_radius),
            limit: format!("less than the radius of the surface `{contact} m` from the spindle axis"),
            hint: "use a sharper tool or a flatter surface",
        }
    }

    fn out_of_reach(&self, slide_position: f64) -> ParameterError {
        ParameterError {
            name: "surface.outer_radius",
            value: format!("{} m", self.surface.outer_radius),
            limit: format!("within reach of the tool, which it is not at the slide position `{slide_position} m`"),
            hint: "reduce the cut surface, or use a flatter one",
        }
    }
}

/// Depth z_c (m) of the nose center at the spindle axis; automatic in the middle of the sag.
pub fn center_depth(surface: &Surface) -> f64 {
    match (surface.depth_auto, surface.kind) {
        (false, _) => surface.depth,
        (true, SurfaceKind::Toric) => {
            let rho = surface.outer_radius.min(rim(surface));
            let sags = (0..64).map(|k| {
                let theta = std::f64::consts::TAU * f64::from(k) / 64.0;
                section(surface, rho, theta.sin(), theta.cos()).sag
            });
            let (low, high) = sags.fold((0.0, 0.0), |(low, high): (f64, f64), sag| (low.min(sag), high.max(sag)));
            0.5 * (low + high)
        }
        (true, _) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Slide position at which the nose center passes `rho` (m) with the arm in its plane.
    fn slide(p: &Parameters, rho: f64) -> f64 {
        Arm::new(p).slide_position(rho, 0.0)
    }

    fn amplitudes(p: &Parameters, rho: f64) -> Vec<f64> {
        let path = ToolPath::new(p);
        let depths: Vec<f64> =
            (0..256).map(|k| path.depth(slide(p, rho), TAU * f64::from(k) / 256.0).unwrap()).collect();
        (0..=32)
            .map(|n| {
                let (c, s) = depths.iter().enumerate().fold((0.0, 0.0), |(c, s), (k, z)| {
                    let phase = TAU * (n * k) as f64 / 256.0;
                    (c + z * phase.cos(), s + z * phase.sin())
                });
                1e6 * c.hypot(s) / 128.0
            })
            .collect()
    }

    #[test]
    fn the_paper_s_0x4_at_30_mm() {
        let a = amplitudes(&Parameters::START, 0.03);
        assert!((a[2] - 1748.4).abs() < 0.05, "{}", a[2]);
        assert!((a[4] - 9.69).abs() < 0.005, "{}", a[4]);
        assert!((a[6] - 0.62).abs() < 0.005, "{}", a[6]);
        assert!((a[8] - 0.006).abs() < 0.0005, "{}", a[8]);
        assert!(a.iter().skip(1).step_by(2).all(|odd| *odd < 1e-6));
    }

    #[test]
    fn a_sharp_tool_on_a_long_arm_follows_the_sag() {
        let mut p = Parameters::START;
        p.tool.nose_radius[0] = 0.0;
        p.tool.arm_length[0] = 1e6;
        // a_2 = rho^2/4R + rho^4/16R^3 + 15 rho^6/512R^5, a_4 = rho^4/64R^3 + 3 rho^6/256R^5
        let (rho, radius) = (0.03f64, 0.1325f64);
        let (a, ratio) = (amplitudes(&p, rho), (rho / radius).powi(2));
        let a2 = rho * rho / radius * (1.0 / 4.0 + ratio / 16.0 + 15.0 * ratio * ratio / 512.0);
        let a4 = rho * rho / radius * (ratio / 64.0 + 3.0 * ratio * ratio / 256.0);
        assert!((a[2] - 1e6 * a2).abs() < 0.03, "{} {a2}", a[2]);
        assert!((a[4] - 1e6 * a4).abs() < 0.03, "{} {a4}", a[4]);
    }

    #[test]
    fn the_nose_touches_the_surface_and_never_cuts_into_it() {
        let mut p = Parameters::START;
        p.surface.base_curvature = 3.0;
        p.surface.tilt_x = 0.03;
        let (path, arm) = (ToolPath::new(&p), Arm::new(&p));
        for (rho, theta) in [(0.03, 0.3), (0.045, 2.0), (0.01, -1.0), (0.0, 1.0)] {
            let z = path.depth(slide(&p, rho), theta).unwrap();
            let center = arm.distance(slide(&p, rho), z);
            let distance = |r: f64| {
                let sag = section(&p.surface, r, theta.sin(), theta.cos()).sag;
                // the surface is R_t deeper than the nose center where it is level
                (r - center).hypot(center_depth(&p.surface) + 0.002 - sag - z)
            };
            let nearest = (-3000..3000).map(|k| distance(center + 1e-6 * f64::from(k))).fold(f64::INFINITY, f64::min);
            assert!((nearest - 0.002).abs() < 1e-9, "{rho} {theta}: {nearest}");
        }
    }

    #[test]
    fn a_blunt_tool_and_an_unreachable_rim_are_rejected() {
        let mut p = Parameters::START;
        p.surface.cross_curvature = 40.0;
        p.tool.nose_radius[0] = 0.03;
        let message = ToolPath::new(&p).depth(slide(&p, 0.002), 0.0).unwrap_err().to_string();
        assert!(message.starts_with("parameter `tool.nose_radius` is `0.03 m`"), "{message}");
        let mut p = Parameters::START;
        p.surface.cross_curvature = 30.0;
        let message = ToolPath::new(&p).depth(slide(&p, 0.05), 0.0).unwrap_err().to_string();
        assert!(message.starts_with("parameter `surface.outer_radius` is `0.05 m`"), "{message}");
    }

    #[test]
    fn the_nose_starts_in_the_middle_of_the_sag_or_at_its_configured_depth() {
        // a cylinder of 0.1325 m out to 30 mm: its sag falls to 0 across
        let surface = |cross_curvature: f64| crate::interface::Surface {
            base_curvature: 0.0,
            cross_curvature,
            outer_radius: 0.03,
            ..Parameters::START.surface
        };
        let sag = 0.1325 - (0.1325f64 * 0.1325 - 0.0009).sqrt();
        for sign in [1.0, -1.0] {
            assert!((center_depth(&surface(sign / 0.1325)) - 0.5 * sign * sag).abs() < 1e-12);
        }
        let configured = crate::interface::Surface { depth_auto: false, depth: 0.007, ..surface(5.0) };
        assert_eq!(center_depth(&configured), 0.007);
    }

    #[test]
    fn the_wave_is_a_wave() {
        let mut p = Parameters::START;
        p.surface.kind = SurfaceKind::Wave;
        let path = ToolPath::new(&p);
        assert!((path.depth(0.1, TAU / 50.0).unwrap() - 50.7e-6).abs() < 1e-15);
        assert!((path.depth(0.2, TAU / 100.0).unwrap() + 50.7e-6).abs() < 1e-15);
    }

    #[test]
    fn a_nose_that_nearly_fills_a_hollow_finds_its_contact_next_to_the_middle() {
        let mut p = Parameters::START;
        (p.surface.cross_curvature, p.surface.outer_radius, p.tool.nose_radius[0]) = (40.0, 0.02, 0.024);
        for rho in [0.0, 2e-4, 4e-4, 7e-4] {
            let z = ToolPath::new(&p).depth(slide(&p, rho), 0.0).unwrap();
            // the center of the nose goes round that of the hollow, 25 mm from its ground, at 1 mm
            let across = Arm::new(&p).distance(slide(&p, rho), z);
            let expected = center_depth(&p.surface) - 1e-3 + (1e-6 - across * across).sqrt();
            assert!((z - expected).abs() < 1e-9, "{rho}: {z} {expected}");
        }
    }
}
