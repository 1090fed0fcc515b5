//! Look-up table of eq. 2: harmonics of the depth z(x, theta) on a grid of slide positions.

use control_blocks::{ParameterError, require};
use nalgebra::Complex;

use crate::interface::Parameters;
use crate::path::fourier::{Fourier, angles};
use crate::path::kinematics::Arm;
use crate::path::surface::{Directions, ToolPath};

/// Largest number of rows.
const ROWS_MAX: usize = 2000;

/// Harmonics of the depth over the slide position.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthTable {
    /// Slide position of the first row, m.
    pub first: f64,
    /// Distance of two rows, m.
    pub step: f64,
    /// Coefficients c_0 to c_N = a_n - j b_n of each row, m; at least three rows, all of one length.
    pub rows: Vec<Vec<Complex<f64>>>,
    /// Largest depth that the harmonics leave out, m.
    pub truncation: f64,
}

impl DepthTable {
    /// The table of the built-in surface.
    ///
    /// # Errors
    /// Where the tool cannot reach the surface, or when there are too many rows.
    pub fn of_surface(p: &Parameters) -> Result<Self, ParameterError> {
        let arm = Arm::new(p);
        let (first, last) =
            (arm.slide_position(p.surface.outer_radius, 0.0), arm.slide_position(p.surface.inner_radius, 0.0));
        let count = rows(p, last - first)?;
        let (path, fourier) = (ToolPath::new(p), Fourier::new());
        let directions = Directions::new(angles());
        let mut table = Self { first, step: (last - first) / (count - 1) as f64, rows: Vec::new(), truncation: 0.0 };
        for row in 0..count {
            let x = first + row as f64 * table.step;
            let depths = path.depths(x, &directions)?;
            let harmonics = fourier.harmonics(&depths, p.path.harmonics as usize);
            require(depths.iter().all(|z| arm.reaches(*z)), || too_deep(p, arm.length))?;
            let left_out = depths.iter().zip(fourier.values(&harmonics)).map(|(z, sum)| (z - sum).abs());
            table.truncation = left_out.fold(table.truncation, f64::max);
            table.rows.push(harmonics);
        }
        Ok(table)
    }
}

fn too_deep(p: &Parameters, length: f64) -> ParameterError {
    ParameterError {
        name: "tool.arm_length",
        value: format!("{length} m"),
        limit: format!(
            "long enough for the depths of the surface out to `surface.outer_radius` = `{} m`",
            p.surface.outer_radius
        ),
        hint: "reduce the cut surface, or set `expert.surface.depth_auto` = true",
    }
}

/// Number of rows over a length (m), the grid at most `expert.path.grid`.
fn rows(p: &Parameters, length: f64) -> Result<usize, ParameterError> {
    // a length of whole grid steps may be a little more by rounding
    let steps = (length / p.path.grid - 1e-6).ceil().max(2.0);
    require(steps < ROWS_MAX as f64, || ParameterError {
        name: "expert.path.grid",
        value: format!("{} m", p.path.grid),
        limit: format!("at least `{} m`, for at most `{ROWS_MAX}` rows", length / ROWS_MAX as f64),
        hint: "use 0.5 mm: the table is interpolated",
    })?;
    Ok(steps as usize + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_table_has_101_rows_of_half_a_millimetre() {
        let table = DepthTable::of_surface(&Parameters::START).unwrap();
        assert_eq!(table.rows.len(), 101);
        assert!((table.step - 0.5e-3).abs() < 1e-15);
        assert!((table.first - 0.02).abs() < 1e-15);
        // 30 mm; the sag has a maximum at the spindle angle 0, the depth a minimum
        assert!((table.rows[40][2].re + 1748.4e-6).abs() < 0.05e-6);
    }

    #[test]
    fn harmonics_needed_for_0x4_and_0x8() {
        // largest error over theta below 1 um, 0.1 um and 10 nm, at 30 and 50 mm
        let cases =
            [(4.0, 0.03, [4, 6, 6]), (4.0, 0.05, [6, 8, 10]), (8.0, 0.03, [6, 8, 10]), (8.0, 0.05, [16, 22, 28])];
        for (dioptres, rho, expected) in cases {
            let mut p = Parameters::START;
            p.surface.cross_curvature = dioptres / 0.53;
            let path = ToolPath::new(&p);
            let x = Arm::new(&p).slide_position(rho, 0.0);
            let depths: Vec<f64> = angles().map(|theta| path.depth(x, theta).unwrap()).collect();
            let fourier = Fourier::new();
            let error = |n: usize| {
                let sums = fourier.values(&fourier.harmonics(&depths, n));
                depths.iter().zip(sums).map(|(z, sum)| (z - sum).abs()).fold(0.0, f64::max)
            };
            let needed = [1e-6, 1e-7, 1e-8].map(|limit| (1..64).find(|n| error(*n) < limit).unwrap());
            assert_eq!(needed, expected, "{dioptres} dioptres at {rho} m");
        }
    }

    #[test]
    fn what_the_harmonics_leave_out_is_known() {
        let mut p = Parameters::START;
        p.surface.cross_curvature = 8.0 / 0.53;
        p.path.harmonics = 16;
        let table = DepthTable::of_surface(&p).unwrap();
        assert!(table.truncation > 0.1e-6 && table.truncation < 1e-6, "{}", table.truncation);
    }

    #[test]
    fn a_surface_deeper_than_the_arm_reaches_is_rejected() {
        let mut p = Parameters::START;
        (p.surface.depth_auto, p.surface.depth) = (false, 0.0795);
        let message = DepthTable::of_surface(&p).unwrap_err().to_string();
        assert!(message.starts_with("parameter `tool.arm_length` is `0.08 m`"), "{message}");
    }

    #[test]
    fn the_rows_are_no_further_apart_than_the_grid_and_at_most_2000() {
        let mut p = Parameters::START;
        p.path.grid = 1e-3;
        for (length, expected) in [(1e-4, 3), (2e-3, 3), (2.1e-3, 4), (3e-3, 4), (1.999, 2000)] {
            assert_eq!(rows(&p, length).unwrap(), expected, "{length}");
        }
        assert!(rows(&p, 2.0).is_err());
    }

    #[test]
    fn too_fine_a_grid_is_rejected() {
        let mut p = Parameters::START;
        p.surface.kind = crate::interface::SurfaceKind::Wave;
        p.surface.outer_radius = 0.5;
        p.path.grid = 1e-4;
        let message = DepthTable::of_surface(&p).unwrap_err().to_string();
        assert!(message.starts_with("parameter `expert.path.grid` is `0.0001 m`"), "{message}");
    }
}
