//! Position of the part, from touches: weighted least squares of the distances from the programmed faces.
//!
//! A tip m that touches the flat face with the normal n through p is on the displaced face. Moved back to the
//! programmed part it is on the programmed face, at any point of it:
//!
//! ```text
//! r = n . (c + R' (m - c - s) - p) = 0
//! ```
//!
//! with three unknowns, s and the angle of R. Each touch has the weight of its standard deviation. The residual r of
//! more touches than unknowns shows whether a part has only moved, or a touch was on something else.

use control_blocks::{NoEstimate, Observation, least_squares};
use nalgebra::{Matrix3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::path::displacement::{Displacement, rotated};
use crate::path::touch::Touch;

/// Fewest touches: three unknowns, and one that tests them.
pub const TOUCHES_MIN: usize = 4;

/// A touched point of the surface from above, m, and its standard deviation, m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Touched {
    /// Place.
    pub position: Vector2<f64>,
    /// Standard deviation along the normal.
    pub deviation: f64,
}

/// Position of the part, and its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Where it lies.
    pub displacement: Displacement,
    /// Standard deviations of x, y (m) and the angle (rad).
    pub deviations: [f64; 3],
    /// Number of the touch that is farthest from it, from 0, and how far, m.
    pub worst: (usize, f64),
}

/// Middle of the programmed positions.
pub fn centre(touches: &[Touch]) -> Vector2<f64> {
    touches.iter().map(|touch| touch.level().0).sum::<Vector2<f64>>() / touches.len() as f64
}

/// Distance from the programmed face, m, and its derivatives by x, y and the angle.
fn distance(touch: &Touch, position: Vector2<f64>, offset: &Displacement) -> (f64, Vector3<f64>) {
    let (point, normal) = touch.level();
    // d/d angle of R' v is R' v turned back by a quarter
    let arm = offset.back(position) - offset.centre;
    let across = rotated(offset.angle, normal);
    (
        normal.dot(&(offset.back(position) - point)),
        Vector3::new(-across.x, -across.y, normal.dot(&Vector2::new(arm.y, -arm.x))),
    )
}

/// Finds where the part lies.
///
/// # Errors
/// Why the touches do not determine it.
pub fn fit(touches: &[Touch], touched: &[Touched]) -> Result<Fit, NoEstimate> {
    let centre = centre(touches);
    let displacement = |value: &Vector3<f64>| Displacement { shift: value.xy(), angle: value.z, centre };
    let observe = |i: usize, value: &Vector3<f64>| {
        let (residual, gradient) = distance(&touches[i], touched[i].position, &displacement(value));
        let weight = touched[i].deviation.recip();
        Observation { residual: residual * weight, gradient: gradient * weight }
    };
    let count = touches.len().min(touched.len());
    let found = least_squares(Vector3::zeros(), count, observe)?;
    let offset = displacement(&found.value);
    let left = |i: usize| distance(&touches[i], touched[i].position, &offset).0;
    let farther = |worst: (usize, f64), i: usize| if left(i).abs() > worst.1.abs() { (i, left(i)) } else { worst };
    let worst = (0..count).fold((0, 0.0), farther);
    Ok(Fit { displacement: offset, deviations: std::array::from_fn(|i| found.sigma(i)), worst })
}

/// Standard deviations of x, y (m) and the angle (rad) for touches that each have one of 1 m; none where the touches do not
/// determine them.
pub fn geometry(touches: &[Touch]) -> Option<[f64; 3]> {
    let centre = centre(touches);
    let information = |touch: &Touch| {
        let gradient = distance(touch, touch.level().0, &Displacement { centre, ..Displacement::default() }).1;
        gradient * gradient.transpose()
    };
    let covariance = touches.iter().map(information).sum::<Matrix3<f64>>().try_inverse()?;
    let deviations = [0, 1, 2].map(|i| covariance[(i, i)].sqrt());
    deviations.iter().all(|deviation| deviation.is_finite()).then_some(deviations)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::touch::tests::touch;
    use std::f64::consts::FRAC_PI_2;

    /// Two faces across each other, with three touches each.
    fn corner() -> Vec<Touch> {
        let along = [-0.03, 0.0, 0.03];
        along
            .iter()
            .map(|x| touch(0.7 + x, 0.1, FRAC_PI_2))
            .chain(along.iter().map(|y| touch(0.8, y - 0.02, 0.0)))
            .collect()
    }

    /// Tips that touch the displaced faces, along the programmed normals, farther out by `off` each.
    fn tips(touches: &[Touch], offset: &Displacement, off: impl Fn(usize) -> f64) -> Vec<Touched> {
        let tip = |(i, touch): (usize, &Touch)| {
            let (point, normal) = touch.level();
            let moved = offset.of(&touch.pose).tip.xy();
            let face = rotated(offset.angle, normal);
            // from the programmed line of approach to the displaced face
            let distance = (moved - point).dot(&face) / normal.dot(&face);
            Touched { position: point + normal * (distance + off(i)), deviation: 1e-6 * (1 + i % 2) as f64 }
        };
        touches.iter().enumerate().map(tip).collect()
    }

    #[test]
    fn a_displaced_part_is_found_where_it_is() {
        let touches = corner();
        let centre = centre(&touches);
        for (x, y, angle) in [(0.0, 0.0, 0.0), (2e-3, -2e-3, 5e-3), (-3e-3, 1e-3, -0.1), (0.0, 0.0, 0.3)] {
            let offset = Displacement { shift: Vector2::new(x, y), angle, centre };
            let found = fit(&touches, &tips(&touches, &offset, |_| 0.0)).unwrap();
            let Displacement { shift, angle: rotation, .. } = found.displacement;
            assert!((shift - offset.shift).norm() < 1e-12 && (rotation - angle).abs() < 1e-11, "{offset:?}: {found:?}");
            assert!(found.worst.1.abs() < 1e-12);
        }
    }

    #[test]
    fn small_distances_are_the_closed_form_of_the_linear_problem() {
        // centered touches of equal weight: x and y are means of their faces except what the angle takes, which is the slope
        let touches = corner();
        let off = [3e-6, 1e-6, -2e-6, 4e-6, -1e-6, 2e-6];
        let touched: Vec<Touched> = touches
            .iter()
            .zip(off)
            .map(|(touch, off)| Touched { position: touch.level().0 + touch.level().1 * off, deviation: 1e-6 })
            .collect();
        let found = fit(&touches, &touched).unwrap();
        // middle of each face from the center of all: 50 mm; slope: sum of arms times distances over sum of squared arms
        let (mean_y, mean_x) = ((off[0] + off[1] + off[2]) / 3.0, (off[3] + off[4] + off[5]) / 3.0);
        let slope = (-0.03 * off[0] + 0.03 * off[2] + 0.03 * off[3] - 0.03 * off[5]) / (4.0 * 0.03 * 0.03);
        let c = centre(&touches);
        let expected = Vector2::new(mean_x + slope * (-0.02 - c.y), mean_y - slope * (0.7 - c.x));
        let offset = found.displacement;
        assert!(
            (offset.angle - slope).abs() < 1e-8 && (offset.shift - expected).norm() < 1e-9,
            "{found:?} {slope} {expected}"
        );
        // the angle rests on four arms of 30 mm; larger residuals than deviations enlarge it
        let residuals = (0..6).map(|i| distance(&touches[i], touched[i].position, &offset).0.powi(2)).sum::<f64>();
        let excess = (residuals / 3.0).sqrt().max(1e-6);
        assert!((found.deviations[2] / (excess / 0.06) - 1.0).abs() < 1e-3, "{found:?}");
        let std = geometry(&touches).unwrap();
        assert!((found.deviations[0] / (excess * std[0]) - 1.0).abs() < 1e-3, "{found:?} {std:?}");
    }

    #[test]
    fn a_touch_on_something_else_is_left_over_and_a_lighter_one_counts_less() {
        let touches = corner();
        let offset = Displacement { shift: Vector2::new(1e-3, 1e-3), angle: 2e-3, centre: centre(&touches) };
        let found = fit(&touches, &tips(&touches, &offset, |i| if i == 3 { 3e-4 } else { 0.0 })).unwrap();
        assert_eq!(found.worst.0, 3);
        assert!(found.worst.1 > 1e-4, "{found:?}");
        // the touches 1, 3 and 5 have twice the deviation of the others
        let moved = |which: usize| {
            let found = fit(&touches, &tips(&touches, &offset, |i| if i == which { 1e-5 } else { 0.0 })).unwrap();
            (found.displacement.shift - offset.shift).norm()
        };
        assert!(moved(4) > 1.5 * moved(1), "{} {}", moved(4), moved(1));
    }

    #[test]
    fn touches_that_show_nothing_are_known() {
        let one_face: Vec<Touch> = [-0.03, 0.0, 0.01, 0.03].map(|x| touch(0.7 + x, 0.1, FRAC_PI_2)).to_vec();
        assert_eq!(geometry(&one_face), None);
        // all normals through one position: it may turn about it
        let round: Vec<Touch> =
            [0.0, 1.0, 2.0, 4.0].map(|a: f64| touch(0.7 + 0.05 * a.cos(), 0.05 * a.sin(), a)).to_vec();
        assert!(geometry(&round).is_none_or(|std| std[2] > 1e6), "{:?}", geometry(&round));
        let offset = Displacement::default();
        assert_eq!(fit(&corner()[..3], &tips(&corner()[..3], &offset, |_| 0.0)), Err(NoEstimate::TooFew));
    }
}
