//! Tool path at any slide position: harmonics of depth and angle, cubic in the slide position.
//!
//! Between two rows the table is Hermite's cubic, [`crate::path::hermite`].

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::lists::harmonics::HIGHEST;
use crate::path::correction::Correction;
use crate::path::depth_table::DepthTable;
use crate::path::fourier::Fourier;
use crate::path::hermite;
use crate::path::kinematics::Arm;

/// Range beyond the ends of the table, in rows: a slide position at the very end may be noisy.
const MARGIN: f64 = 0.1;

/// The table with what follows from it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PathTable {
    arm: Arm,
    first: f64,
    step: f64,
    rows: usize,
    depth_count: usize,
    /// coefficients of depth, then of angle, row after row
    values: Vec<Complex<f64>>,
    /// Largest db/dtheta, 1.
    pub velocity: f64,
    /// Largest d2b/dtheta2, 1.
    pub acceleration: f64,
    /// Largest depth that the harmonics leave out, m.
    pub truncation: f64,
    correction: Option<Correction>,
}

/// The path at one slide position.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    depth_count: usize,
    values: Vec<Complex<f64>>,
}

/// Depth (m) and its derivatives to the spindle angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// z, m.
    pub value: f64,
    /// dz/dtheta, m.
    pub first: f64,
    /// d2z/dtheta2, m.
    pub second: f64,
}

impl PathTable {
    /// The path of a table, with `angle_harmonics` harmonics of the encoder angle b_d = asin(z / R_a) - b_0; 0 for none,
    /// else at least those of the depth.
    pub fn new(arm: Arm, table: &DepthTable, angle_harmonics: usize) -> Self {
        let fourier = Fourier::new();
        let depth_count = table.rows.iter().map(Vec::len).max().unwrap_or(0);
        let angle_harmonics = if angle_harmonics == 0 { 0 } else { angle_harmonics.max(depth_count - 1) };
        let (mut rows, mut velocity, mut acceleration) = (Vec::new(), 0.0, 0.0);
        for depth in &table.rows {
            let angles: Vec<f64> = fourier.values(depth).into_iter().map(|z| arm.angle(z)).collect();
            // the limits hold for the whole angle, not only for the harmonics that are pre-shifted
            let exact = fourier.harmonics(&angles, HIGHEST);
            let peak = |order: i32| {
                let derivative: Vec<_> = exact.iter().enumerate().map(|(n, c)| derivative(*c, n, order)).collect();
                fourier.values(&derivative).into_iter().fold(0.0, |peak: f64, x| peak.max(x.abs()))
            };
            velocity = f64::max(velocity, peak(1));
            acceleration = f64::max(acceleration, peak(2));
            let mut row = depth.clone();
            row.resize(depth_count, Complex::default());
            row.extend_from_slice(&exact[..=angle_harmonics]);
            rows.push(row);
        }
        Self {
            arm,
            first: table.first,
            step: table.step,
            rows: rows.len(),
            depth_count,
            values: hermite::continued(&rows).concat(),
            velocity,
            acceleration,
            truncation: table.truncation,
            correction: None,
        }
    }

    /// Corrects the path, in place of the correction before; harmonics that it does not have are left out.
    pub fn correct(&mut self, correction: Option<Correction>) {
        let correction = correction.map(|correction| correction.up_to(self.harmonics()));
        let added = |correction: Option<Correction>, order| {
            correction.map_or(0.0, |correction| correction.bound(order) / self.arm.length)
        };
        let [velocity, acceleration] = [1, 2].map(|order| added(correction, order) - added(self.correction, order));
        self.velocity += velocity;
        self.acceleration += acceleration;

        self.correction = correction;
    }

    /// The correction that is in force.
    pub fn correction(&self) -> Option<&Correction> {
        self.correction.as_ref()
    }

    /// Whether the table reaches to a slide position (m).
    pub fn covers(&self, slide_position: f64) -> bool {
        let position = (slide_position - self.first) / self.step;
        position >= -MARGIN && position <= (self.rows - 1) as f64 + MARGIN
    }

    /// Whether the slide has left the table by an end to which it has come from where the path was joined (m): at least
    /// a row of the way is cut then.
    pub fn cut_over(&self, joined: f64, slide_position: f64) -> bool {
        let end = if slide_position < self.first { self.first } else { self.first + self.extent() };
        !self.covers(slide_position) && (end - joined).abs() >= self.step
    }

    /// Slide positions between which it is, m.
    pub fn ends(&self) -> [f64; 2] {
        [self.first, self.first + (self.rows - 1) as f64 * self.step]
    }

    /// Way of the slide through the table, m.
    pub fn extent(&self) -> f64 {
        (self.rows - 1) as f64 * self.step.abs()
    }

    /// A row to interpolate into.
    pub fn row(&self) -> Row {
        Row { depth_count: self.depth_count, values: vec![Complex::default(); self.width()] }
    }

    /// Interpolates at a slide position (m); outside the table the nearest end counts.
    pub fn interpolate(&self, slide_position: f64, row: &mut Row) {
        let (neighbors, t) = self.neighbors(slide_position);
        let weights = hermite::weights(t);
        let [r0, r1, r2, r3] = neighbors;
        for ((((value, c0), c1), c2), c3) in row.values.iter_mut().zip(r0).zip(r1).zip(r2).zip(r3) {
            *value = c0 * weights[0] + c1 * weights[1] + c2 * weights[2] + c3 * weights[3];
        }
        if let Some(correction) = &self.correction {
            row.add(&correction.harmonics(slide_position), &self.arm);
        }
    }

    /// Depth z (m) of the nominal path, without a correction, and dz/dx, with e^(j n theta), n = 0 first.
    pub fn nominal_depth(&self, slide_position: f64, phasors: &[Complex<f64>]) -> [f64; 2] {
        let (neighbors, t) = self.neighbors(slide_position);
        let (weights, slopes) = (hermite::weights(t), hermite::slopes(t));
        let mut found = [0.0; 2];
        for ((row, weight), slope) in neighbors.iter().zip(weights).zip(slopes) {
            let depth: f64 = row[..self.depth_count].iter().zip(phasors).map(|(c, phasor)| (c * phasor).re).sum();
            found[0] += weight * depth;
            found[1] += slope / self.step * depth;
        }
        found
    }

    /// The four rows about a slide position (m), and its fraction between the middle two.
    fn neighbors(&self, slide_position: f64) -> ([&[Complex<f64>]; 4], f64) {
        let last = (self.rows - 2) as f64;
        let position = ((slide_position - self.first) / self.step).clamp(-MARGIN, last + 1.0 + MARGIN);
        let before = position.floor().clamp(0.0, last);
        // the row before the first one is number 0
        let (from, width) = (before as usize, self.width());
        ([0, 1, 2, 3].map(|i| &self.values[(from + i) * width..][..width]), position - before)
    }

    /// The arm for which the angles are made.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// Harmonics of the depth.
    pub fn harmonics(&self) -> usize {
        self.depth_count - 1
    }

    fn width(&self) -> usize {
        self.values.len() / (self.rows + 2)
    }
}

impl Row {
    /// Adds harmonics (m) to the depth, and to the angle what they are there: dz = R_a cos(phi) db, phi that of the
    /// mean depth.
    fn add(&mut self, harmonics: &[Complex<f64>], arm: &Arm) {
        let (depths, angles) = self.values.split_at_mut(self.depth_count);
        let lever = arm.lever(arm.angle(depths[0].re));
        depths.iter_mut().zip(harmonics).for_each(|(depth, c)| *depth += c);
        let corrected = harmonics.iter().take(self.depth_count);
        angles.iter_mut().zip(corrected).for_each(|(angle, c)| *angle += c / lever);
    }

    /// Depth and derivatives from e^(j n theta), n = 0 first.
    pub fn depth(&self, phasors: &[Complex<f64>]) -> Depth {
        let (mut n, mut depth) = (0.0, Depth { value: 0.0, first: 0.0, second: 0.0 });
        for (c, phasor) in self.values[..self.depth_count].iter().zip(phasors) {
            let term = c * phasor;
            depth.value += term.re;
            depth.first -= n * term.im;
            depth.second -= n * n * term.re;
            n += 1.0;
        }
        depth
    }

    /// A depth (m) that the path never goes below.
    pub fn lowest(&self) -> f64 {
        let [mean, harmonics @ ..] = &self.values[..self.depth_count] else { return 0.0 };
        mean.re - harmonics.iter().map(|c| c.norm()).sum::<f64>()
    }

    /// Harmonics of the encoder angle, n = 1 first, rad.
    pub fn angle_harmonics(&self) -> &[Complex<f64>] {
        &self.values[self.depth_count + 1..]
    }
}

/// Harmonic n of a derivative to the angle.
fn derivative(c: Complex<f64>, n: usize, order: i32) -> Complex<f64> {
    c * Complex::new(0.0, n as f64).powi(order)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::{Parameters, SurfaceKind};
    use crate::path::surface::ToolPath;
    use crate::tracking::phasors::Phasors;

    fn path(p: &Parameters) -> PathTable {
        PathTable::new(Arm::new(p), &DepthTable::of_surface(p).unwrap(), 24)
    }

    /// Largest error (m) of the interpolated depth between 25 and 45 mm.
    fn error(grid: f64) -> f64 {
        let mut p = Parameters::START;
        p.path.grid = grid;
        p.path.harmonics = 32;
        let (path, exact) = (path(&p), ToolPath::new(&p));
        let mut row = path.row();
        let mut largest: f64 = 0.0;
        for k in 0..400 {
            let x = path.arm().slide_position(0.025 + 0.02 * f64::from(k) / 400.0, 0.0);
            path.interpolate(x, &mut row);
            for theta in [0.0, 0.4, 0.8, 1.2, 1.6] {
                let z = row.depth(Phasors::new(theta, 64).from_zero()).value;
                largest = largest.max((z - exact.depth(x, theta).unwrap()).abs());
            }
        }
        largest
    }

    #[test]
    fn cubic_interpolation_errs_by_23_3_and_0_4_nm() {
        for (grid, expected) in [(2e-3, 23e-9), (1e-3, 3e-9), (0.5e-3, 0.4e-9)] {
            let error = error(grid);
            println!("grid {grid} m: {error:e} m");
            assert!(error < 1.3 * expected, "grid {grid} m: {error} m");
        }
    }

    #[test]
    fn the_ends_are_as_good_as_the_middle() {
        let p = Parameters::START;
        let (path, exact) = (path(&p), ToolPath::new(&p));
        let mut row = path.row();
        for rho in [0.04999, 0.0498, 0.0002, 0.00001] {
            let x = path.arm().slide_position(rho, 0.0);
            assert!(path.covers(x));
            path.interpolate(x, &mut row);
            let z = row.depth(Phasors::new(0.7, 24).from_zero()).value;
            assert!((z - exact.depth(x, 0.7).unwrap()).abs() < 30e-9, "{rho}");
        }
        for rho in [0.0502, -0.0002] {
            assert!(!path.covers(path.arm().slide_position(rho, 0.0)), "{rho}");
        }
    }

    #[test]
    fn the_cut_is_over_at_the_end_that_it_has_come_to() {
        let path = path(&Parameters::START);
        let at = |rho: f64| path.arm().slide_position(rho, 0.0);
        let (rim, axis) = (0.0502, -0.0002);
        for (joined, left, over) in [
            (0.05, rim, false),
            (0.0496, rim, false),
            (0.05, axis, true),
            (0.03, axis, true),
            (0.001, axis, true),
            (0.0004, axis, false),
            (0.0, rim, true),
            (0.03, 0.01, false),
        ] {
            assert_eq!(path.cut_over(at(joined), at(left)), over, "{joined} {left}");
        }
    }

    #[test]
    fn outside_the_table_everything_stays_finite() {
        let path = path(&Parameters::START);
        let mut row = path.row();
        for x in [-1e3, 1e3, 0.0] {
            path.interpolate(x, &mut row);
            assert!(row.depth(Phasors::new(0.7, 24).from_zero()).value.abs() < 0.01);
        }
    }

    #[test]
    fn the_table_reaches_a_tenth_of_a_row_beyond_both_ends() {
        let path = path(&Parameters::START);
        let last = path.first + path.extent() * path.step.signum();
        assert!((path.extent() - 0.05).abs() < 1e-12);
        assert!((path.ends()[0] - path.first).abs() < 1e-15 && (path.ends()[1] - last).abs() < 1e-12);
        for (end, out) in [(path.first, -path.step), (last, path.step)] {
            assert!(path.covers(end) && path.covers(end + 0.09 * out) && !path.covers(end + 0.11 * out), "{end}");
            // and what is asked for further out is the path there
            let (mut near, mut far) = (path.row(), path.row());
            path.interpolate(end + MARGIN * out, &mut near);
            path.interpolate(end + 5.0 * out, &mut far);
            assert!(near.values.iter().zip(&far.values).all(|(a, b)| (a - b).norm() < 1e-15));
        }
    }

    #[test]
    fn the_angles_have_no_fewer_harmonics_than_the_depth_or_none() {
        let mut p = Parameters::START;
        p.path.harmonics = 20;
        let table = DepthTable::of_surface(&p).unwrap();
        for (requested, given) in [(0, 0), (4, 20), (20, 20), (32, 32)] {
            let path = PathTable::new(Arm::new(&p), &table, requested);
            assert_eq!((path.harmonics(), path.row().angle_harmonics().len()), (20, given));
        }
    }

    #[test]
    fn the_derivatives_are_those_of_the_depth() {
        let path = path(&Parameters::START);
        let mut row = path.row();
        path.interpolate(0.041, &mut row);
        let at = |theta: f64| row.depth(Phasors::new(theta, 24).from_zero());
        let (before, here, after) = (at(0.9 - 1e-5), at(0.9), at(0.9 + 1e-5));
        let lowest = (0..6283).map(|k| at(1e-3 * f64::from(k)).value).fold(f64::INFINITY, f64::min);
        assert!(row.lowest() <= lowest && row.lowest() > lowest - 100e-6, "{} {lowest}", row.lowest());
        assert!(((after.value - before.value) / 2e-5 - here.first).abs() < 1e-11);
        assert!(((after.first - before.first) / 2e-5 - here.second).abs() < 1e-10);
    }

    #[test]
    fn a_correction_needs_torque_as_long_as_it_is_in_force() {
        let mut path = path(&Parameters::START);
        let bare = [path.velocity, path.acceleration];
        let mut correction = Correction { span: [0.04, 0.05], coefficients: Default::default() };
        correction.coefficients[3][1] = Complex::new(0.0, 8e-6);
        for (weight, given) in [(1.0, Some(correction)), (1.0, Some(correction)), (0.0, None)] {
            path.correct(given);
            let added = [path.velocity - bare[0], path.acceleration - bare[1]];
            assert!((added[0] - weight * 3e-4).abs() < 1e-12 && (added[1] - weight * 9e-4).abs() < 1e-12, "{added:?}");
        }
    }

    #[test]
    fn the_angle_harmonics_are_those_of_the_exact_angle() {
        let mut p = Parameters::START;
        p.surface.kind = SurfaceKind::Wave;
        p.surface.wave_harmonic = 2;
        p.surface.wave_amplitude = 0.015;
        let path = path(&p);
        let mut row = path.row();
        path.interpolate(0.041, &mut row);
        let b = row.angle_harmonics();
        // asin(a cos x): a + 3/24 a^3 + ... and the third harmonic a^3/24 of it
        let a: f64 = 0.015 / 0.08;
        assert!((b[1].re - (a + a.powi(3) / 8.0 + 3.0 / 64.0 * a.powi(5))).abs() < 2e-6);
        assert!((b[5].re - (a.powi(3) / 24.0 + 3.0 / 128.0 * a.powi(5))).abs() < 2e-6);
        assert_eq!(b.len(), 24);
        assert!((path.acceleration - 4.0 * a).abs() < 0.02, "{}", path.acceleration);
        // largest where the wave passes its middle
        assert!((path.velocity - 2.0 * a).abs() < 1e-6, "{}", path.velocity);
    }
}
