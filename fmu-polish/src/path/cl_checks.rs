//! Checks of the path: spacing, normals, folds, slope, stroke.

use nalgebra::Vector3;

use super::cl_data::{ClError, Point};
use crate::interface::Parameters;

/// Points closer than this are merged, m.
pub const SPACING_MIN: f64 = 1e-6;
/// Maximum distance of two points, m.
const SPACING_MAX: f64 = 0.2e-3;
/// Minimum number of points of a path.
const POINTS_MIN: usize = 10;
/// Tolerance of the length of a normal.
const NORMAL_TOLERANCE: f64 = 1e-3;
/// Maximum angle between the normals of two points, rad.
const ROTATION_MAX: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Maximum fraction of a step along the normal.
const CLIMB_MAX: f64 = 0.2;
/// Tolerance of the tool diameter.
const CUTTER_TOLERANCE: f64 = 0.01;

/// The normal, scaled to length 1.
///
/// # Errors
/// When its length is not near 1.
pub fn unit_normal(normal: Vector3<f64>) -> Result<Vector3<f64>, String> {
    let length = normal.norm();
    if (length - 1.0).abs() > NORMAL_TOLERANCE {
        return Err(format!("the normal has the length `{length:.4}`, must be `1` within `{NORMAL_TOLERANCE}`"));
    }
    Ok(normal / length)
}

/// Checks the diameter (m) of the tool for which the path was made.
///
/// # Errors
/// When it is not twice `tool.radius`.
pub fn cutter(diameter: f64, p: &Parameters) -> Result<(), String> {
    let expected = 2.0 * p.tool_radius;
    if (diameter / expected - 1.0).abs() > CUTTER_TOLERANCE {
        return Err(format!("CUTTER is `{diameter} m`, must be twice `tool.radius`, `{expected} m`, within 1 %"));
    }
    Ok(())
}

/// Checks a whole path of a file with `lines` lines.
///
/// # Errors
/// Names the first invalid point and the reason.
pub fn path(points: &[Point], lines: usize, p: &Parameters) -> Result<(), ClError> {
    if points.len() < POINTS_MIN {
        let reason = format!("only `{}` different points, must be at least `{POINTS_MIN}`", points.len());
        return Err(ClError::new(lines, reason, "Write the whole path."));
    }
    points.iter().try_for_each(|point| alone(point, p))?;
    points.windows(2).try_for_each(|pair| neighbours(&pair[0], &pair[1], p))
}

/// Checks one point.
fn alone(point: &Point, p: &Parameters) -> Result<(), ClError> {
    let upright = p.path.slope_max.cos();
    let error = |reason, hint| Err(ClError::new(point.line, reason, hint));
    if point.normal.z < -upright {
        let reason = format!("the normal points down (k = `{:.4}`), into the material", point.normal.z);
        return error(reason, "Write normals that point out of the material, k > 0.");
    }
    if point.normal.z < upright {
        let slope = point.normal.z.clamp(-1.0, 1.0).acos();
        let reason = format!(
            "the surface is `{slope:.3} rad` steep, at most `expert.path.slope_max` = `{} rad`",
            p.path.slope_max
        );
        return error(
            reason,
            "Tilt the mold, or increase `expert.path.slope_max` if the shank stays clear of the wall.",
        );
    }
    if p.feed.uses_file() && point.feed <= 0.0 {
        return error(
            "a point before the first FEDRAT".into(),
            "Write FEDRAT before GOTO, or set `expert.feed.source` = Parameter.",
        );
    }
    let centre = point.contact + p.tool_radius * point.normal;
    let reach = centre.abs() + p.retract.distance * point.normal.abs();
    let axes = [("x", reach.x, p.stroke.x), ("y", reach.y, p.stroke.y), ("z", reach.z, p.stroke.z)];
    for (axis, reach, stroke) in axes {
        if reach > 0.5 * stroke {
            let reason =
                format!("`{axis}` reaches `{reach:.6} m` from the middle of the stroke, at most `{} m`", 0.5 * stroke);
            return error(reason, "Check the unit and the origin of the path, and `stroke`.");
        }
    }
    Ok(())
}

/// Checks two consecutive points.
fn neighbours(a: &Point, b: &Point, p: &Parameters) -> Result<(), ClError> {
    let error = |reason, hint| Err(ClError::new(b.line, reason, hint));
    let step = b.contact - a.contact;
    let spacing = step.norm();
    if spacing > SPACING_MAX {
        let reason =
            format!("a gap of `{:.4} mm` to the point before, at most `{} mm`", 1e3 * spacing, 1e3 * SPACING_MAX);
        return error(reason, "Reduce the spacing of the points, and check the unit.");
    }
    let rotation = a.normal.dot(&b.normal).clamp(-1.0, 1.0).acos();
    if rotation > ROTATION_MAX {
        let reason =
            format!("the normal rotates by `{rotation:.3} rad` from the point before, at most `{ROTATION_MAX:.3} rad`");
        return error(reason, "Reduce the spacing of the points in curved regions, and check the normals.");
    }
    let climb = step.dot(&(a.normal + b.normal)).abs() / (2.0 * spacing);
    if climb > CLIMB_MAX {
        let reason = format!("the step has `{climb:.3}` of its length along the normal, at most `{CLIMB_MAX}`");
        return error(reason, "Check the normals: they do not fit the surface.");
    }
    let centre_step = step + p.tool_radius * (b.normal - a.normal);
    if centre_step.dot(&step) <= 0.0 {
        let reason = format!(
            "the path of the ball center folds: the surface has a smaller radius than the tool, `{} m`",
            p.tool_radius
        );
        return error(reason, "Use a smaller tool.");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_may_be_as_far_apart_as_the_limit() {
        let at = |x: f64| Point { contact: Vector3::new(x, 0.0, 0.0), normal: Vector3::z(), feed: 1e-3, line: 1 };
        let gap = |x: f64| neighbours(&at(0.0), &at(x), &Parameters::START);
        assert!(gap(SPACING_MAX).is_ok());
        let message = gap(1.01 * SPACING_MAX).unwrap_err().to_string();
        assert!(message.contains("`0.2020 mm`") && message.contains("`0.2 mm`"), "{message}");
    }
}
