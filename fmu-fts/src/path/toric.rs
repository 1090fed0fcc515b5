//! Toric surface: sag of a radial section with its first two derivatives.
//!
//! X = rho cos theta lies along the cross curvature, Y = rho sin theta along the base curvature; the arc across X rides
//! on the arc g(Y) of the base. Written with curvatures, so that flat and convex need no cases.

use crate::interface::Surface;

/// Sag (m), slope and second derivative (1/m) of a radial section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Sag s, m; positive where the surface comes out of the part.
    pub sag: f64,
    /// ds/drho.
    pub slope: f64,
    /// Second derivative, 1/m.
    pub bend: f64,
}

/// The section at distance `rho` (m) on the side of the spindle angle with `sine` and `cosine`.
pub fn section(surface: &Surface, rho: f64, sine: f64, cosine: f64) -> Section {
    let (x, y) = (rho * cosine, rho * sine);
    // base arc g(Y) = c Y^2 / (1 + sqrt(1 - c^2 Y^2))
    let base = surface.base_curvature;
    let root = (1.0 - base * base * y * y).sqrt();
    let (g, g1, g2) = (base * y * y / (1.0 + root), base * y / root, base / (root * root * root));
    // cross arc on a radius that is shorter by g
    let k = surface.cross_curvature / (1.0 - surface.cross_curvature * g);
    let k1 = k * k * g1 * sine;
    let root = (1.0 - k * k * x * x).sqrt();
    let rise = g1 * sine + k * x * cosine;
    let rise1 = g2 * sine * sine + k1 * x * cosine + k * cosine * cosine;
    let root1 = -(k * k1 * x * x + k * k * x * cosine) / root;
    Section {
        sag: g + k * x * x / (1.0 + root) + surface.tilt_x * x + surface.tilt_y * y,
        slope: rise / root + surface.tilt_x * cosine + surface.tilt_y * sine,
        bend: rise1 / root - rise * root1 / (root * root),
    }
}

/// Largest distance (m) from the spindle axis at which the surface is used: 0.995 of the smaller radius.
pub fn rim(surface: &Surface) -> f64 {
    0.995 / surface.base_curvature.abs().max(surface.cross_curvature.abs()).max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const CASES: [(f64, f64); 6] =
        [(0.0, 1.0 / 0.1325), (1.0 / 0.3, 1.0 / 0.1325), (0.0, 0.0), (4.0, 4.0), (-3.0, 5.0), (2.0, -6.0)];

    fn surface((base_curvature, cross_curvature): (f64, f64)) -> Surface {
        Surface { base_curvature, cross_curvature, tilt_x: 0.02, tilt_y: -0.01, ..Surface::START }
    }

    fn at(surface: &Surface, rho: f64, theta: f64) -> Section {
        section(surface, rho, theta.sin(), theta.cos())
    }

    #[test]
    fn slope_and_bend_are_the_derivatives() {
        for surface in CASES.map(surface) {
            for k in 0..12 {
                let (theta, rho, h) = (0.55 * f64::from(k), 0.004 * f64::from(k) - 0.002, 1e-6);
                let (before, here, after) =
                    (at(&surface, rho - h, theta), at(&surface, rho, theta), at(&surface, rho + h, theta));
                assert!(((after.sag - before.sag) / (2.0 * h) - here.slope).abs() < 1e-8);
                assert!(((after.slope - before.slope) / (2.0 * h) - here.bend).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn the_rim_is_within_the_smaller_radius() {
        for (base, cross, radius) in [(2.0, 6.0, 1.0 / 6.0), (-8.0, 5.0, 0.125), (3.0, -4.0, 0.25)] {
            assert!((rim(&surface((base, cross))) - 0.995 * radius).abs() < 1e-12, "{base} {cross}");
        }
        // a plane has none within any machine
        assert!(rim(&surface((0.0, 0.0))) > 1e6);
    }

    #[test]
    fn the_sections_along_the_axes_are_arcs() {
        let surface = Surface { base_curvature: 2.0, cross_curvature: 6.0, ..Surface::START };
        let arc = |c: f64, r: f64| 1.0 / c - (1.0 / (c * c) - r * r).sqrt();
        assert!((at(&surface, 0.03, 0.0).sag - arc(6.0, 0.03)).abs() < 1e-15);
        assert!((at(&surface, 0.03, PI / 2.0).sag - arc(2.0, 0.03)).abs() < 1e-15);
    }

    #[test]
    fn equal_curvatures_along_x_zero_make_a_sphere() {
        let surface = Surface { base_curvature: 5.0, cross_curvature: 5.0, ..Surface::START };
        // R - sqrt((R - g)^2 - X^2) is the sphere exactly
        for k in 0..10 {
            let sag = at(&surface, 0.04, 0.6 * f64::from(k)).sag;
            assert!((sag - (0.2 - (0.04f64 - 0.0016).sqrt())).abs() < 1e-15, "{sag}");
        }
    }
}
