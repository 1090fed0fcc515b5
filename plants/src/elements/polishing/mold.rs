//! Surface of a mold as a formula: a spherical cap or a saddle, dimples, and a step.

use nalgebra::Vector3;

/// A Gaussian hollow.
#[derive(Clone, Copy, Debug)]
pub struct Dimple {
    /// position of its center, m
    pub x: f64,
    /// position of its center, m
    pub y: f64,
    /// depth in its center, m
    pub depth: f64,
    /// distance from the center at which 61 % of the depth are left, m
    pub sigma: f64,
}

/// A smooth rise across the mold, to both sides of which the surface is parallel.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// start, m along x
    pub place: f64,
    /// height, m
    pub height: f64,
    /// length of the rise, m
    pub width: f64,
}

/// A surface `z(x, y)` with its axis along z and, except for a step, with its origin on the surface.
#[derive(Clone, Debug)]
pub struct Mold {
    /// curvature of a concave spherical cap, 1/m
    cap: f64,
    /// curvature of a saddle, concave along x and convex along y, 1/m
    saddle: f64,
    /// additional hollows
    dimples: Vec<Dimple>,
    /// additional rise
    step: Step,
    /// distance from the axis up to which the formula is valid, m
    rim: f64,
    /// height of cap, saddle and dimples on the axis, m
    datum: f64,
}

/// Height of a surface at one position with its derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub struct Local {
    /// height, m
    pub z: f64,
    /// slopes
    pub zx: f64,
    /// slopes
    pub zy: f64,
    /// second derivatives, 1/m
    pub zxx: f64,
    /// second derivatives, 1/m
    pub zxy: f64,
    /// second derivatives, 1/m
    pub zyy: f64,
}

impl Local {
    fn plus(self, other: Self) -> Self {
        Self {
            z: self.z + other.z,
            zx: self.zx + other.zx,
            zy: self.zy + other.zy,
            zxx: self.zxx + other.zxx,
            zxy: self.zxy + other.zxy,
            zyy: self.zyy + other.zyy,
        }
    }

    /// Unit normal pointing out of the material.
    pub fn normal(&self) -> Vector3<f64> {
        let length = (1.0 + self.zx * self.zx + self.zy * self.zy).sqrt();
        Vector3::new(-self.zx / length, -self.zy / length, 1.0 / length)
    }
}

impl Mold {
    /// A cap and a saddle by their curvatures in 1/m with dimples and a step, out to `rim` m from the axis.
    pub fn new((cap, saddle): (f64, f64), dimples: Vec<Dimple>, step: Step, rim: f64) -> Self {
        let mut mold = Self { cap, saddle, dimples, step, rim, datum: 0.0 };
        mold.datum = mold.at(0.0, 0.0).z - step.at(0.0).z;
        mold
    }

    /// The surface at a position inside the rim.
    pub fn at(&self, x: f64, y: f64) -> Local {
        let base = self.cap_at(x, y).plus(self.saddle_at(x, y)).plus(self.step.at(x));
        let sum = self.dimples.iter().fold(base, |sum, dimple| sum.plus(dimple.at(x, y)));
        Local { z: sum.z - self.datum, ..sum }
    }

    /// The nearest position within the rim.
    pub fn inside(&self, place: [f64; 2]) -> [f64; 2] {
        let distance = place[0].hypot(place[1]);
        if distance > self.rim { place.map(|p| p * self.rim / distance) } else { place }
    }

    fn cap_at(&self, x: f64, y: f64) -> Local {
        let k = self.cap;
        let square = x * x + y * y;
        let rise = (1.0 - k * k * square).sqrt();
        let cube = k * k * k / (rise * rise * rise);
        Local {
            z: k * square / (1.0 + rise),
            zx: k * x / rise,
            zy: k * y / rise,
            zxx: k / rise + cube * x * x,
            zxy: cube * x * y,
            zyy: k / rise + cube * y * y,
        }
    }

    fn saddle_at(&self, x: f64, y: f64) -> Local {
        let k = self.saddle;
        Local { z: 0.5 * k * (x * x - y * y), zx: k * x, zy: -k * y, zxx: k, zxy: 0.0, zyy: -k }
    }
}

impl Dimple {
    fn at(&self, x: f64, y: f64) -> Local {
        let (u, v) = ((x - self.x) / self.sigma, (y - self.y) / self.sigma);
        let z = -self.depth * (-0.5 * (u * u + v * v)).exp();
        let (slope, bend) = (-z / self.sigma, -z / (self.sigma * self.sigma));
        Local {
            z,
            zx: slope * u,
            zy: slope * v,
            zxx: bend * (1.0 - u * u),
            zxy: -bend * u * v,
            zyy: bend * (1.0 - v * v),
        }
    }
}

impl Step {
    fn at(&self, x: f64) -> Local {
        // 6 u^5 - 15 u^4 + 10 u^3: slope and curvature are continuous
        let u = ((x - self.place) / self.width).clamp(0.0, 1.0);
        let (rest, height) = (1.0 - u, self.height);
        Local {
            z: height * u * u * u * (10.0 - u * (15.0 - 6.0 * u)),
            zx: height / self.width * 30.0 * u * u * rest * rest,
            zxx: height / (self.width * self.width) * 60.0 * u * rest * (1.0 - 2.0 * u),
            ..Local::default()
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) const NO_STEP: Step = Step { place: 0.0, height: 0.0, width: 1e-3 };

    pub(crate) fn sphere() -> Mold {
        Mold::new((1.0 / 3e-3, 0.0), Vec::new(), NO_STEP, 2e-3)
    }

    pub(crate) fn rough() -> Mold {
        let dimples = vec![
            Dimple { x: 0.9e-3, y: 0.1e-3, depth: 40e-6, sigma: 0.45e-3 },
            Dimple { x: -0.3e-3, y: -0.9e-3, depth: 35e-6, sigma: 0.42e-3 },
        ];
        let step = Step { place: 0.5e-3, height: 50e-6, width: 0.8e-3 };
        Mold::new((1.0 / 3e-3, 1.0 / 20e-3), dimples, step, 2e-3)
    }

    #[test]
    fn the_origin_is_on_the_surface() {
        for mold in [sphere(), rough()] {
            assert_eq!(mold.at(0.0, 0.0).z, 0.0);
        }
    }

    #[test]
    fn a_cap_is_a_sphere() {
        let mold = sphere();
        for (x, y) in [(0.0, 0.0), (1e-3, -0.5e-3), (-1.2e-3, 1.5e-3)] {
            let here = mold.at(x, y);
            let centre = Vector3::new(x, y, here.z - 3e-3);
            assert!((centre.norm() - 3e-3).abs() < 1e-17);
            assert!((here.normal() + centre / 3e-3).amax() < 1e-12);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_height() {
        let (mold, d) = (rough(), 1e-7);
        for (x, y) in [(0.3e-3, 0.2e-3), (0.8e-3, -0.4e-3), (-0.7e-3, -1.1e-3), (1.31e-3, 0.9e-3)] {
            let [here, east, west, north, south] =
                [(x, y), (x + d, y), (x - d, y), (x, y + d), (x, y - d)].map(|(x, y)| mold.at(x, y));
            let close = |name: &str, found: f64, wanted: f64, tolerance: f64| {
                assert!((found - wanted).abs() < tolerance, "{name} at {x}, {y}: {found} and {wanted}");
            };
            close("zx", here.zx, (east.z - west.z) / (2.0 * d), 1e-7);
            close("zy", here.zy, (north.z - south.z) / (2.0 * d), 1e-7);
            close("zxx", here.zxx, (east.zx - west.zx) / (2.0 * d), 1e-2);
            close("zxy", here.zxy, (east.zy - west.zy) / (2.0 * d), 1e-2);
            close("zyy", here.zyy, (north.zy - south.zy) / (2.0 * d), 1e-2);
        }
    }

    #[test]
    fn a_step_rises_once() {
        let step = Step { place: 1e-3, height: 0.1e-3, width: 0.5e-3 };
        assert_eq!((step.at(0.0).z, step.at(1e-3).z), (0.0, 0.0));
        assert!((step.at(1.25e-3).z - 0.05e-3).abs() < 1e-18);
        assert!((step.at(2e-3).z - 0.1e-3).abs() < 1e-18);
        assert_eq!(step.at(2e-3).zx, 0.0);
    }
}
