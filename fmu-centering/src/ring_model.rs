//! Recursive model of the ring: where its centre is, how far the line of measurement, and what form it has.
//!
//! State: b0, centre (c_x, c_y) in the table frame, cosine and sine of the form harmonics. One scalar measurement
//! y = s - q at a time, through the exact geometry (eq. 4), so that a part of a revolution is enough once b0 and the
//! form are known, and all angles count at once. The covariance says how much is known.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};
use serde::{Deserialize, Serialize};

/// Highest form harmonic of the model; the lowest is 2, since 1 is the centre.
pub const HARMONIC_MAX: usize = 6;
/// b0, centre, two per harmonic.
const STATES: usize = 3 + 2 * (HARMONIC_MAX - 1);
/// Standard deviation of b0 before the first measurement, m: anywhere on the slide.
const LINE_SIGMA: f64 = 1.0;

type Vector = SVector<f64, STATES>;
type Matrix = SMatrix<f64, STATES, STATES>;

/// What is assumed before and between the measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assumptions {
    /// Radius of the ring, m.
    pub radius: f64,
    /// Standard deviation of one measurement: probe, roughness, error motion, m.
    pub noise: f64,
    /// Standard deviation of each coordinate of the centre before the first measurement, m.
    pub centre: f64,
    /// Standard deviation of each form coefficient before the first measurement, m.
    pub form: f64,
    /// Innovations beyond this many standard deviations are dirt.
    pub gate: f64,
    /// So many rejected measurements in a row mean that the model is wrong, not the measurements.
    pub rejections_max: u32,
}

/// Belief about the ring: mean and covariance.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RingModel {
    assumed: Assumptions,
    mean: Vector,
    covariance: Matrix,
    rejections: u32,
}

/// What the model expects to measure at one angle.
struct Expectation {
    value: f64,
    gradient: Vector,
    variance: f64,
}

impl RingModel {
    /// Nothing known but the assumptions.
    pub fn new(assumed: Assumptions) -> Self {
        let mut variances = Vector::from_element(assumed.form.powi(2));
        variances[0] = LINE_SIGMA.powi(2);
        (variances[1], variances[2]) = (assumed.centre.powi(2), assumed.centre.powi(2));
        Self { assumed, mean: Vector::zeros(), covariance: Matrix::from_diagonal(&variances), rejections: 0 }
    }

    /// Takes in y = s - q (m) at the spindle angle (rad); false if it was taken for dirt.
    pub fn observe(&mut self, angle: f64, y: f64) -> bool {
        let expected = self.expect(angle);
        let cross = self.covariance * expected.gradient;
        let spread = expected.gradient.dot(&cross) + expected.variance;
        let innovation = y - expected.value;
        if innovation.powi(2) > self.assumed.gate.powi(2) * spread {
            self.rejections += 1;
            if self.rejections > self.assumed.rejections_max {
                self.forget(innovation.abs());
            }
            return false;
        }
        self.rejections = 0;
        let gain = cross / spread;
        self.mean += gain * innovation;
        // joseph's form for one measurement; the mean of both triangles keeps it symmetric
        let corrected = self.covariance - gain * cross.transpose();
        self.covariance = 0.5 * (corrected + corrected.transpose());
        true
    }

    /// The ring was moved: its centre is now near `centre` (table frame, m), within `sigma` (m) in each coordinate.
    pub fn displaced(&mut self, centre: Vector2<f64>, sigma: f64) {
        self.mean.fixed_rows_mut::<2>(1).copy_from(&centre);
        for i in [1, 2] {
            self.covariance.row_mut(i).fill(0.0);
            self.covariance.column_mut(i).fill(0.0);
            self.covariance[(i, i)] = sigma.powi(2);
        }
        self.rejections = 0;
    }

    /// Centre of the ring in the table frame, m.
    pub fn centre(&self) -> Vector2<f64> {
        self.mean.fixed_rows::<2>(1).into_owned()
    }

    /// Covariance of the centre, m2.
    pub fn centre_covariance(&self) -> Matrix2<f64> {
        self.covariance.fixed_view::<2, 2>(1, 1).into_owned()
    }

    /// Eccentricity B, m.
    pub fn eccentricity(&self) -> f64 {
        self.centre().norm()
    }

    /// Standard deviation of the centre along its direction, m; of its worst direction if it has none.
    pub fn eccentricity_sigma(&self) -> f64 {
        let (centre, covariance) = (self.centre(), self.centre_covariance());
        match centre.try_normalize(0.0) {
            Some(u) => (u.dot(&(covariance * u))).max(0.0).sqrt(),
            None => covariance.symmetric_eigenvalues().max().max(0.0).sqrt(),
        }
    }

    /// What y = s - q would be at `angle` (rad) with the centre of the ring on the axis of the spindle, m.
    pub fn centred_line(&self, angle: f64) -> f64 {
        self.mean[0] - self.form(-angle)
    }

    /// What y = s - q is expected to be at `angle` (rad), m.
    pub fn line(&self, angle: f64) -> f64 {
        self.expect(angle).value
    }

    /// Deviation of the ring from its radius in the direction `phi` (rad, ring frame), m.
    fn form(&self, phi: f64) -> f64 {
        let terms = harmonics(phi);
        (3..STATES).map(|i| self.mean[i] * terms[i]).sum()
    }

    /// y = b0 + r - (c_x + sqrt(R^2 - c_y^2)), eq. 4, with the centre in the world frame.
    fn expect(&self, angle: f64) -> Expectation {
        let (sine, cosine) = angle.sin_cos();
        let centre = self.centre();
        let across = sine * centre.x + cosine * centre.y;
        let along = cosine * centre.x - sine * centre.y;
        let radius = self.assumed.radius;
        let lever = (across / radius).clamp(-0.99, 0.99);
        let phi = -lever.asin() - angle;
        let root = radius * (1.0 - lever * lever).sqrt();
        let tilt = radius * lever / root;
        let mut gradient = -harmonics(phi);
        gradient[0] = 1.0;
        gradient[1] = -cosine + tilt * sine;
        gradient[2] = sine + tilt * cosine;
        // curvature of the circle: an unknown c_y shifts and blurs the measurement
        let side = Vector2::new(sine, cosine);
        let blur = side.dot(&(self.centre_covariance() * side)) / radius;
        Expectation {
            value: self.mean[0] + radius - along - root - self.form(phi) + 0.5 * blur,
            gradient,
            variance: self.assumed.noise.powi(2) + 0.5 * blur * blur,
        }
    }

    /// The ring is not where it was thought: only b0 and the form are kept.
    fn forget(&mut self, surprise: f64) {
        let sigma = surprise.max(10.0 * self.assumed.noise);
        self.displaced(self.centre(), sigma);
        self.covariance[(0, 0)] += self.assumed.noise.powi(2);
    }
}

/// Cosine and sine of each harmonic of `phi` at their places in the state, the rest 0.
fn harmonics(phi: f64) -> Vector {
    let mut terms = Vector::zeros();
    let (s1, c1) = phi.sin_cos();
    let (mut s, mut c) = (s1, c1);
    for i in (3..STATES).step_by(2) {
        (s, c) = (s * c1 + c * s1, c * c1 - s * s1);
        (terms[i], terms[i + 1]) = (c, s);
    }
    terms
}
