//! Tool path over a surface: depth of the nose centre at a slide position and spindle angle.
//!
//! The tool is flat-faced with a round nose in the radial plane. Its centre lies R_t along the normal of the section:
//! z = z_c - s + R_t (1 - 1/q), rho = rho_c - R_t s'/q with q = sqrt(1 + s'^2) at the point of contact rho_c. The arm
//! moves sideways while it swings, rho = (x_0 - x) - R_a cos phi, so that the path belongs to the slide position.

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
    centre_depth: f64,
}

/// The nose centre for a point of contact.
struct Nose {
    depth: f64,
    distance: f64,
    /// derivatives to the distance of the point of contact
    depth1: f64,
    distance1: f64,
}

/// A spindle angle, rad, with its sine and cosine.
pub struct Direction {
    angle: f64,
    sine: f64,
    cosine: f64,
}

impl Direction {
    /// The direction of an angle, rad.
    pub fn new(angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        Self { angle, sine, cosine }
    }
}

/// The search for the point of contact at one spindle angle.
#[derive(Clone, Copy)]
struct Search {
    /// Distance of the point of contact from the spindle axis so far, m.
    contact: f64,
    found: Option<Found>,
}

/// What a search ends with.
#[derive(Clone, Copy)]
enum Found {
    /// Depth of the nose centre, m.
    Depth(f64),
    /// The surface is narrower than the tool.
    TooBlunt,
}

impl<'a> ToolPath<'a> {
    /// The surface of `p` under its selected tool.
    pub fn new(p: &'a Parameters) -> Self {
        Self {
            surface: &p.surface,
            arm: Arm::new(p),
            nose_radius: p.tool.nose_radius[p.tool.index()],
            centre_depth: centre_depth(&p.surface),
        }
    }

    /// Depths z (m) of the nose centre at a slide position (m) and some spindle angles.
    ///
    /// The searches go on side by side: they do not wait for each other's divisions.
    ///
    /// # Errors
    /// Where the tool cannot reach the surface.
    pub fn depths(&self, slide_position: f64, directions: &[Direction]) -> Result<Vec<f64>, ParameterError> {
        if self.surface.kind == SurfaceKind::Wave {
            return Ok(directions.iter().map(|direction| self.wave(direction.angle)).collect());
        }
        let limit = rim(self.surface);
        let contact = self.arm.distance(slide_position, 0.0).clamp(-limit, limit);
        let mut searches = vec![Search { contact, found: None }; directions.len()];
        for _ in 0..STEPS_MAX {
            let mut open = false;
            for (search, direction) in searches.iter_mut().zip(directions) {
                if search.found.is_none() {
                    self.step(slide_position, limit, direction, search);
                    open = true;
                }
            }
            if !open {
                break;
            }
        }
        let conclude = |search: Search| match search.found {
            Some(Found::Depth(depth)) => Ok(depth),
            Some(Found::TooBlunt) => Err(self.too_blunt(search.contact)),
            None => Err(self.out_of_reach(slide_position)),
        };
        searches.into_iter().map(conclude).collect()
    }

    /// Depth z (m) of the nose centre at a slide position (m) and spindle angle (rad).
    #[cfg(test)]
    pub fn depth(&self, slide_position: f64, spindle_angle: f64) -> Result<f64, ParameterError> {
        self.depths(slide_position, &[Direction::new(spindle_angle)]).map(|depths| depths[0])
    }

    fn wave(&self, spindle_angle: f64) -> f64 {
        let phase = f64::from(self.surface.wave_harmonic) * spindle_angle;
        self.centre_depth + self.surface.wave_amplitude * phase.cos()
    }

    /// One Newton step of the search for the point of contact.
    fn step(&self, slide_position: f64, limit: f64, direction: &Direction, search: &mut Search) {
        let contact = search.contact;
        let nose = self.nose(&section(self.surface, contact, direction.sine, direction.cosine), contact);
        if nose.distance1 <= 0.0 {
            search.found = Some(Found::TooBlunt);
            return;
        }
        let miss = nose.distance - self.arm.distance(slide_position, nose.depth);
        // d(R_a cos phi)/dz = -tan phi
        let tangent = (nose.depth / self.arm.length).clamp(-0.999, 0.999).asin().tan();
        let step = miss / (nose.distance1 - tangent * nose.depth1);
        if step.abs() < TOLERANCE {
            search.found = Some(Found::Depth(nose.depth));
            return;
        }
        search.contact = (contact - step.clamp(-STEP_MAX, STEP_MAX)).clamp(-limit, limit);
    }

    fn nose(&self, section: &Section, contact: f64) -> Nose {
        let q = section.slope.hypot(1.0);
        let turn = self.nose_radius * section.bend / (q * q * q);
        Nose {
            depth: self.centre_depth - section.sag + self.nose_radius * (1.0 - 1.0 / q),
            distance: contact - self.nose_radius * section.slope / q,
            depth1: section.slope * (turn - 1.0),
            distance1: 1.0 - turn,
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
            limit: format!(
                "where the tool reaches the surface, which it does not at the slide position `{slide_position} m`"
            ),
            hint: "cut less of the surface, or a flatter one",
        }
    }
}

/// Depth z_c (m) of the nose centre at the spindle axis; automatic in the middle of the sag.
pub fn centre_depth(surface: &Surface) -> f64 {
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

    /// Slide position at which the nose centre passes `rho` (m) with the arm in its plane.
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
            let centre = arm.distance(slide(&p, rho), z);
            let distance = |r: f64| {
                let sag = section(&p.surface, r, theta.sin(), theta.cos()).sag;
                // the surface is R_t deeper than the nose centre where it is level
                (r - centre).hypot(centre_depth(&p.surface) + 0.002 - sag - z)
            };
            let nearest = (-3000..3000).map(|k| distance(centre + 1e-6 * f64::from(k))).fold(f64::INFINITY, f64::min);
            assert!((nearest - 0.002).abs() < 1e-9, "{rho} {theta}: {nearest}");
        }
    }

    #[test]
    fn a_blunt_tool_and_an_unreachable_rim_are_refused() {
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
    fn the_wave_is_a_wave() {
        let mut p = Parameters::START;
        p.surface.kind = SurfaceKind::Wave;
        let path = ToolPath::new(&p);
        assert!((path.depth(0.1, TAU / 50.0).unwrap() - 50.7e-6).abs() < 1e-15);
        assert!((path.depth(0.2, TAU / 100.0).unwrap() + 50.7e-6).abs() < 1e-15);
    }
}
