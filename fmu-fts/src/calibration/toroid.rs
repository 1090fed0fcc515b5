//! Calibration toroid: arm length and cross-slide offset from the probed profile of a revolved arc.
//!
//! With the slide fixed at x_F the nose of the tool cuts an arc of the radius R_a + R_t around the arm axis, which the
//! spindle revolves to a toroid. The center of the probe ball follows (l - R_c)^2 + (p - z_c)^2 = (R_a + R_t - R_p)^2,
//! where l counts from the cusp on the spindle axis, and x_0 = R_c + x_F. The arc is fitted with orthogonal distances:
//! depth residuals would be wrong on its flanks.

use control_blocks::{NoEstimate, Observation, least_squares};
use nalgebra::{Matrix3, SVector, Vector3};
use serde::{Deserialize, Serialize};

/// One sample of the probe on the toroid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProbePoint {
    /// Lateral position l, m; negative on the other side of the cusp.
    pub lateral: f64,
    /// Depth p, m.
    pub depth: f64,
}

/// Standard deviations of what is measured, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeAccuracy {
    /// Of the depth.
    pub depth: f64,
    /// Of the lateral position.
    pub lateral: f64,
    /// Standard deviation of the cusp position, where the lateral position should be 0; above 0.
    pub cusp: f64,
}

/// The arc and its standard deviations, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Radius R_a + R_t - R_p.
    pub radius: f64,
    /// Distance R_c of its center from the cusp.
    pub distance: f64,
    /// Standard deviation of the radius.
    pub radius_std: f64,
    /// Standard deviation of the distance.
    pub distance_std: f64,
    /// Root mean square of the orthogonal distances.
    pub residual: f64,
}

/// Place of the cusp, distance and depth of the center, radius.
type ArcUnknowns = SVector<f64, 4>;

/// Fits the arc to points on one or both sides of the cusp. Points on both sides find the cusp by themselves.
///
/// # Errors
/// Says why there is no arc.
pub fn fit(points: &[ProbePoint], accuracy: &ProbeAccuracy) -> Result<Arc, NoEstimate> {
    let start = start(points)?;
    let found = least_squares(start, points.len() + 1, |i, value| match points.get(i) {
        Some(point) => observe(point, accuracy, value),
        // what is known of the cusp beforehand
        None => Observation {
            residual: value[0] / accuracy.cusp,
            gradient: SVector::from([1.0 / accuracy.cusp, 0.0, 0.0, 0.0]),
        },
    })?;
    let squares: f64 = points.iter().map(|point| Gap::of(point, &found.value).distance.powi(2)).sum();
    Ok(Arc {
        radius: found.value[3],
        distance: found.value[1],
        radius_std: found.sigma(3),
        distance_std: found.sigma(1),
        residual: (squares / points.len() as f64).sqrt(),
    })
}

/// Orthogonal distance of a point from the arc, with its direction in the upper half plane.
struct Gap {
    distance: f64,
    side: f64,
    across: f64,
    deep: f64,
}

impl Gap {
    fn of(point: &ProbePoint, value: &ArcUnknowns) -> Self {
        let side = 1.0f64.copysign(point.lateral);
        let (across, deep) = (side * (point.lateral - value[0]) - value[1], point.depth - value[2]);
        let radius = across.hypot(deep);
        Self { distance: radius - value[3], side, across: across / radius, deep: deep / radius }
    }
}

fn observe(point: &ProbePoint, accuracy: &ProbeAccuracy, value: &ArcUnknowns) -> Observation<4> {
    let Gap { distance, side, across, deep } = Gap::of(point, value);
    let sigma = (deep * accuracy.depth).hypot(across * accuracy.lateral);
    let gradient = SVector::from([-side * across, -across, -deep, -1.0]) / sigma;
    Observation { residual: distance / sigma, gradient }
}

/// Circle of Kasa: abs(l)^2 + p^2 + d abs(l) + e p + f = 0 is linear in d, e and f.
fn start(points: &[ProbePoint]) -> Result<ArcUnknowns, NoEstimate> {
    let n = points.len() as f64;
    let (mut lateral, mut depth) = (0.0, 0.0);
    for point in points {
        lateral += point.lateral.abs() / n;
        depth += point.depth / n;
    }
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for point in points {
        // around the mean point, where the sums keep their digits
        let row = Vector3::new(point.lateral.abs() - lateral, point.depth - depth, 1.0);
        matrix += row * row.transpose();
        right -= row * (row.x * row.x + row.y * row.y);
    }
    let solution = matrix.lu().solve(&right).ok_or(NoEstimate::NotObservable)?;
    let (across, deep) = (-0.5 * solution.x, -0.5 * solution.y);
    let square = across * across + deep * deep - solution.z;
    let start = SVector::from([0.0, lateral + across, depth + deep, square.sqrt()]);
    if start.iter().all(|s| s.is_finite()) { Ok(start) } else { Err(NoEstimate::NotObservable) }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    const RADIUS: f64 = 0.0805;
    const DISTANCE: f64 = 0.0901;
    const DEPTH: f64 = -0.012;
    const ACCURACY: ProbeAccuracy = ProbeAccuracy { depth: 65e-9, lateral: 30e-9, cusp: 1e-9 };

    /// `count` points of the arc from `low` to `high` degrees, on one side of the cusp.
    fn arc(low: f64, high: f64, count: usize) -> Vec<ProbePoint> {
        let angle = |i: usize| (low + (high - low) * i as f64 / (count - 1) as f64).to_radians();
        let point = |phi: f64| ProbePoint { lateral: DISTANCE - RADIUS * phi.cos(), depth: DEPTH + RADIUS * phi.sin() };
        (0..count).map(angle).map(point).collect()
    }

    /// The same on the other side of the cusp.
    fn mirrored(points: &[ProbePoint]) -> Vec<ProbePoint> {
        points.iter().map(|point| ProbePoint { lateral: -point.lateral, ..*point }).collect()
    }

    fn noisy(points: &[ProbePoint], accuracy: &ProbeAccuracy, random: &mut Pcg64Mcg) -> Vec<ProbePoint> {
        let (lateral, depth) = (Normal::new(0.0, accuracy.lateral).unwrap(), Normal::new(0.0, accuracy.depth).unwrap());
        let add = |p: &ProbePoint, random: &mut Pcg64Mcg| ProbePoint {
            lateral: p.lateral + lateral.sample(random),
            depth: p.depth + depth.sample(random),
        };
        points.iter().map(|point| add(point, random)).collect()
    }

    #[test]
    fn the_search_begins_at_the_arc_where_the_points_are_exact() {
        for (low, high) in [(60.0, 120.0), (30.0, 60.0), (5.0, 20.0)] {
            let begin = start(&arc(low, high, 50)).unwrap();
            for (value, actual) in begin.iter().zip([0.0, DISTANCE, DEPTH, RADIUS]) {
                assert!((value - actual).abs() < 1e-9, "{low}..{high}: {begin}");
            }
        }
    }

    #[test]
    fn an_exact_arc_is_recovered() {
        for (low, high) in [(60.0, 120.0), (30.0, 60.0), (20.0, 40.0), (5.0, 20.0)] {
            let found = fit(&arc(low, high, 200), &ACCURACY).unwrap();
            assert!((found.radius - RADIUS).abs() < 1e-12, "{low}..{high}: {:e}", found.radius - RADIUS);
            assert!((found.distance - DISTANCE).abs() < 1e-12, "{low}..{high}");
            assert!(found.residual < 1e-13);
        }
    }

    #[test]
    fn both_sides_find_the_cusp_and_one_side_says_that_it_cannot() {
        let unsure = ProbeAccuracy { cusp: 1e-3, ..ACCURACY };
        let one = arc(30.0, 60.0, 100);
        let mut both = [one.clone(), mirrored(&one)].concat();
        // the lateral position starts 0.2 mm off the cusp
        both.iter_mut().for_each(|point| point.lateral += 2e-4);
        let found = fit(&both, &unsure).unwrap();
        assert!((found.distance - DISTANCE).abs() < 1e-11, "{:e}", found.distance - DISTANCE);
        assert!(found.distance_std < 1e-6);
        let found = fit(&one, &unsure).unwrap();
        assert!((found.distance_std - 1e-3).abs() < 1e-5, "{:e}", found.distance_std);
        assert!(found.radius_std < 1e-6);
    }

    /// Root mean square of the error and of error / sigma, for radius and distance, over `runs` samples.
    fn monte_carlo(points: &[ProbePoint], accuracy: &ProbeAccuracy, runs: u32) -> [f64; 4] {
        let mut random = Pcg64Mcg::seed_from_u64(1999);
        let mut squares = [0.0; 4];
        for _ in 0..runs {
            let found = fit(&noisy(points, accuracy, &mut random), accuracy).unwrap();
            let (radius, distance) = (found.radius - RADIUS, found.distance - DISTANCE);
            let all = [radius, distance, radius / found.radius_std, distance / found.distance_std];
            squares.iter_mut().zip(all).for_each(|(sum, error)| *sum += error * error);
        }
        squares.map(|sum| (sum / f64::from(runs)).sqrt())
    }

    #[test]
    fn sigma_is_the_scatter_of_the_estimate() {
        for (low, high) in [(60.0, 120.0), (30.0, 60.0), (20.0, 40.0), (5.0, 20.0)] {
            let [radius, distance, radius_ratio, distance_ratio] = monte_carlo(&arc(low, high, 200), &ACCURACY, 2000);
            println!("arc {low}..{high}: R {radius:.3e} m, R_c {distance:.3e} m");
            println!("against sigma {radius_ratio:.3}, {distance_ratio:.3}");
            assert!((radius_ratio - 1.0).abs() < 0.06, "{low}..{high}: {radius_ratio}");
            assert!((distance_ratio - 1.0).abs() < 0.06, "{low}..{high}: {distance_ratio}");
        }
    }

    #[test]
    fn the_default_arc_keeps_a_micrometre() {
        let [radius, distance, ..] = monte_carlo(&arc(30.0, 60.0, 200), &ACCURACY, 500);
        assert!(radius < 0.4e-6 && distance < 0.35e-6, "{radius:e} {distance:e}");
    }

    #[test]
    fn sigma_too_small_is_corrected_by_the_residuals() {
        let configured = ProbeAccuracy { depth: 65e-10, lateral: 30e-10, ..ACCURACY };
        let points = arc(30.0, 60.0, 200);
        let mut random = Pcg64Mcg::seed_from_u64(7);
        let sample = noisy(&points, &ACCURACY, &mut random);
        let (nominal, corrected) = (fit(&sample, &ACCURACY).unwrap(), fit(&sample, &configured).unwrap());
        assert!((corrected.radius_std / nominal.radius_std - 1.0).abs() < 0.2);
    }

    #[test]
    fn points_that_are_no_arc_are_rejected() {
        assert_eq!(fit(&[], &ACCURACY), Err(NoEstimate::NotObservable));
        assert_eq!(fit(&arc(30.0, 60.0, 3), &ACCURACY), Err(NoEstimate::TooFew));
        let flat: Vec<_> = (0..50).map(|i| ProbePoint { lateral: 0.02 + 1e-4 * f64::from(i), depth: 1e-3 }).collect();
        assert_eq!(fit(&flat, &ACCURACY), Err(NoEstimate::NotObservable));
    }
}
