//! Three numbers, one for each axis, as the FMU shows them.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// One number for each axis of the work frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axes<T = f64> {
    /// Along x.
    pub x: T,
    /// Along y.
    pub y: T,
    /// Along z.
    pub z: T,
}

impl<T: Copy> Axes<T> {
    /// The same for all axes.
    pub const fn all(value: T) -> Self {
        Self { x: value, y: value, z: value }
    }
}

impl Axes {
    /// Zeros.
    pub const ZERO: Self = Self::all(0.0);

    /// As a vector.
    pub fn vector(self) -> Vector3<f64> {
        Vector3::new(self.x, self.y, self.z)
    }
}

impl<T: Copy> From<Vector3<T>> for Axes<T> {
    fn from(v: Vector3<T>) -> Self {
        Self { x: v[0], y: v[1], z: v[2] }
    }
}
