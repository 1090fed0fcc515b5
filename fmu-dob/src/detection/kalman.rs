//! Kalman filter of the stage, its disturbance and the spindle harmonics; its innovation is white before contact.

use std::array;
use std::f64::consts::PI;

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use crate::detection::transition::{STATES, Transition};
use crate::interface::Parameters;

/// Riccati iterations, one per sample, after a start or a speed change; then the gain is constant.
pub const ITERATIONS: u32 = 2000;
/// Relative speed change that makes a new model.
const RETUNE: f64 = 1e-3;
/// Relative speed change that makes a new gain; the harmonics follow a smaller one with the gain they have.
const REGAIN: f64 = 0.05;
/// Random walk of each spindle harmonic in one sample, standard deviation, N: noise of such stages.
const HARMONIC_WALK: f64 = 1e-4;
/// Harmonics above this fraction of the Nyquist frequency are not modeled.
const NYQUIST_RATIO: f64 = 0.9;
/// Standard deviations at the start: velocity (m/s), disturbance (N), harmonic (N).
const START_SIGMA: [f64; 3] = [1e-3, 1.0, 0.1];

type Vector = SVector<f64, STATES>;
type Matrix = SMatrix<f64, STATES, STATES>;

/// Predictor with one Riccati iteration per sample until its gain is constant.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct KalmanFilter {
    sample_period: f64,
    force_constant: f64,
    harmonics: usize,
    /// fraction of a current step that remains at the end of a sample, and on average over it
    lag: [f64; 2],
    current: f64,
    tuned_speed: f64,
    gain_speed: f64,
    iterations_left: u32,
    noise: NoiseModel,
    force_input: Vector,
    transition: Transition,
    process: Matrix,
    covariance: Matrix,
    gain: Vector,
    state: Vector,
}

/// Variances of the model.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct NoiseModel {
    force: f64,
    disturbance: f64,
    harmonic: f64,
    position: f64,
}

impl KalmanFilter {
    /// Filter at rest at position 0, spindle unknown.
    pub fn new(p: &Parameters) -> Self {
        let (dt, mass) = (p.sample_period, p.stage.mass);
        let decay = p.stage.current_bandwidth * dt;
        let mut force_input = Vector::zeros();
        (force_input[0], force_input[1]) = (0.5 * dt * dt / mass, dt / mass);
        let mut filter = Self {
            sample_period: dt,
            force_constant: p.stage.force_constant,
            harmonics: p.notch_harmonics as usize,
            lag: [(-decay).exp(), (1.0 - (-decay).exp()) / decay],
            current: 0.0,
            tuned_speed: 0.0,
            gain_speed: 0.0,
            iterations_left: 0,
            noise: NoiseModel {
                force: p.kalman.force_noise.powi(2),
                disturbance: p.kalman.disturbance_walk.powi(2),
                harmonic: HARMONIC_WALK.powi(2),
                position: p.kalman.position_noise.powi(2),
            },
            force_input,
            transition: Transition::default(),
            process: Matrix::zeros(),
            covariance: Matrix::zeros(),
            gain: Vector::zeros(),
            state: Vector::zeros(),
        };
        filter.tune(0.0);
        filter.reset(0.0);
        filter
    }

    /// Starts again at rest at `position` m, with everything else unknown.
    pub fn reset(&mut self, position: f64) {
        let [velocity, disturbance, harmonic] = START_SIGMA.map(|sigma| sigma * sigma);
        let mut variances = Vector::from_element(harmonic);
        variances[0] = self.noise.position;
        variances[1] = velocity;
        variances[2] = disturbance;
        self.covariance = Matrix::from_diagonal(&variances);
        self.state = Vector::zeros();
        self.state[0] = position;
        self.iterations_left = ITERATIONS;
    }

    /// Innovation (m) of the position (m), given the current that acted since the last sample (A);
    /// without a position the filter only predicts and the innovation is 0.
    pub fn update(&mut self, position: Option<f64>, acted: f64, spindle_speed: f64) -> f64 {
        let speed = spindle_speed.abs();
        if (speed - self.tuned_speed).abs() > RETUNE * self.tuned_speed {
            self.tune(speed);
        }
        if (speed - self.gain_speed).abs() > REGAIN * self.gain_speed {
            (self.gain_speed, self.iterations_left) = (speed, ITERATIONS);
        }
        let force = self.force_constant * self.mean_current(acted);
        self.state = Vector::from(self.transition.of(self.state.data.0[0])) + self.force_input * force;
        if self.iterations_left > 0 {
            self.iterations_left -= 1;
            self.iterate();
        }
        let innovation = position.map_or(0.0, |z| z - self.state[0]);
        self.state += self.gain * innovation;
        innovation
    }

    /// Whether the gain is constant.
    pub fn settled(&self) -> bool {
        self.iterations_left == 0
    }

    /// One sample of the prediction error under an extra `force` (N) against the stage: (innovation, next error).
    pub fn error_step(&self, error: &Vector, force: f64) -> (f64, Vector) {
        let predicted = Vector::from(self.transition.of(error.data.0[0])) - self.force_input * force;
        (predicted[0], predicted - self.gain * predicted[0])
    }

    /// Mean current over the last sample after a first-order current loop.
    fn mean_current(&mut self, command: f64) -> f64 {
        let step = self.current - command;
        self.current = command + step * self.lag[0];
        command + step * self.lag[1]
    }

    /// One iteration of the Riccati equation.
    fn iterate(&mut self) {
        let rotated = self.transition.around(self.covariance.data.0);
        let predicted = square(|i, j| rotated[i][j] + self.process.data.0[i][j]);
        let cross = predicted.map(|row| row[0]);
        self.gain = Vector::from(cross) / (cross[0] + self.noise.position);
        let gain = self.gain.data.0[0];
        let corrected = square(|i, j| predicted[i][j] - gain[i] * cross[j]);
        self.covariance.data.0 = square(|i, j| 0.5 * (corrected[i][j] + corrected[j][i]));
    }

    /// Model for the speed: M z'' = K_tn I - d - sum c_h, where (c_h, s_h) turns by h omega T_s per sample.
    fn tune(&mut self, speed: f64) {
        self.tuned_speed = speed;
        self.transition = Transition::free(self.sample_period, [-self.force_input[0], -self.force_input[1]]);
        self.process = self.force_input * self.force_input.transpose() * self.noise.force;
        self.process[(2, 2)] = self.noise.disturbance;
        for harmonic in 1..=self.harmonics {
            let theta = harmonic as f64 * speed * self.sample_period;
            if theta > 0.0 && theta <= NYQUIST_RATIO * PI {
                self.transition.rotate(harmonic, theta);
                for i in [1 + 2 * harmonic, 2 + 2 * harmonic] {
                    self.process[(i, i)] = self.noise.harmonic;
                }
            }
        }
    }
}

/// Rows of numbers by row and column.
fn square(number: impl Fn(usize, usize) -> f64) -> [[f64; STATES]; STATES] {
    array::from_fn(|i| array::from_fn(|j| number(i, j)))
}

/// Prediction error of the filter, one per state.
pub type PredictionError = Vector;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::HARMONICS_MAX;

    const SPEED: f64 = 3141.592653589793;

    /// Innovations of a stage at nominal mass under `force(t)` N, current 0, after the gain is constant.
    fn innovations(force: impl Fn(f64) -> f64) -> (KalmanFilter, Vec<f64>) {
        innovations_of(&Parameters::START, force)
    }

    fn innovations_of(p: &Parameters, force: impl Fn(f64) -> f64) -> (KalmanFilter, Vec<f64>) {
        let (dt, sub) = (p.sample_period, 100);
        let mut filter = KalmanFilter::new(p);
        let (mut z, mut v) = (0.0, 0.0);
        let mut trace = Vec::new();
        for k in 0..6000 {
            trace.push(filter.update(Some(z), 0.0, SPEED));
            for i in 0..sub {
                let h = dt / f64::from(sub);
                let a = -force(f64::from(k) * dt + (f64::from(i) + 0.5) * h) / p.stage.mass;
                z += h * v + 0.5 * h * h * a;
                v += h * a;
            }
        }
        (filter, trace)
    }

    #[test]
    fn learns_a_constant_force_and_the_harmonics() {
        let (filter, trace) = innovations(|t| 0.3 + 0.02 * (SPEED * t).sin() + 0.01 * (2.0 * SPEED * t).cos());
        assert!(filter.settled());
        let largest = trace[5000..].iter().fold(0.0, |m, x| f64::max(m, x.abs()));
        assert!(largest < 1e-13, "innovation {largest} m");
        assert!((filter.state[2] - 0.3).abs() < 1e-3, "{}", filter.state[2]);
    }

    #[test]
    fn as_many_harmonics_as_there_can_be_are_learned() {
        let p = Parameters { notch_harmonics: HARMONICS_MAX as i32, ..Parameters::START };
        let highest = HARMONICS_MAX as f64 * SPEED;
        let (_, trace) = innovations_of(&p, |t| 0.3 + 0.02 * (highest * t).sin());
        let largest = trace[5000..].iter().fold(0.0, |m, x| f64::max(m, x.abs()));
        assert!(largest < 1e-12, "innovation {largest} m");
    }

    #[test]
    fn gain_is_close_to_the_riccati_solution() {
        let (filter, _) = innovations(|_| 0.0);
        let mut solution = filter.clone();
        (0..100_000).for_each(|_| solution.iterate());
        // position, velocity and disturbance; the harmonics come slower and matter less
        for i in 0..3 {
            let ratio = filter.gain[i] / solution.gain[i];
            assert!((ratio - 1.0).abs() < 0.01, "gain {i}: ratio {ratio}");
        }
        let mut next = solution.clone();
        next.iterate();
        assert!((next.gain - solution.gain).norm() < 1e-12 * solution.gain.norm());
    }

    #[test]
    fn contact_ramp_gives_the_predicted_innovation() {
        let onset = 0.55;
        let ramp = 20.0;
        let (filter, trace) = innovations(|t| ramp * (t - onset).max(0.0));
        let mut error = PredictionError::zeros();
        for (n, innovation) in trace[5501..5560].iter().enumerate() {
            let force = ramp * (n as f64 + 0.5) * 1e-4;
            let (expected, next) = filter.error_step(&error, force);
            error = next;
            assert!((innovation - expected).abs() < 1e-2 * expected.abs() + 1e-12, "{n}: {innovation} {expected}");
        }
    }

    #[test]
    fn the_current_lags_its_command() {
        let mut filter = KalmanFilter::new(&Parameters::START);
        // 1 kHz at 10 kHz: exp(-0.6283) = 0.5335 of a step is left, and on average (1 - 0.5335) / 0.6283 = 0.7425
        for mean in [1.0 - 0.7425, 1.0 - 0.5335 * 0.7425] {
            let value = filter.mean_current(1.0);
            assert!((value - mean).abs() < 1e-4, "{value} {mean}");
        }
    }

    #[test]
    fn a_new_speed_makes_a_new_gain() {
        let (mut filter, _) = innovations(|_| 0.0);
        let gain = filter.gain;
        for wobble in [1.0005, 1.003, 0.997, 1.04] {
            filter.update(Some(0.0), 0.0, wobble * SPEED);
            assert!(filter.settled() && filter.gain == gain);
        }
        filter.update(Some(0.0), 0.0, 1.1 * SPEED);
        assert!(!filter.settled() && filter.gain != gain);
    }

    #[test]
    fn missing_positions_are_predicted() {
        let p = Parameters::START;
        let mut filter = KalmanFilter::new(&p);
        let position = |k: i32| 1e-4 * f64::from(k) * p.sample_period;
        for k in 0..5000 {
            filter.update(Some(position(k)), 0.0, 0.0);
        }
        for _ in 5000..5003 {
            assert_eq!(filter.update(None, 0.0, 0.0), 0.0);
        }
        let innovation = filter.update(Some(position(5003)), 0.0, 0.0);
        assert!(innovation.abs() < 1e-11, "{innovation} m");
    }

    #[test]
    fn the_thrust_is_foreseen() {
        let mut p = Parameters::START;
        p.stage.current_bandwidth = 1e6;
        let mut filter = KalmanFilter::new(&p);
        let (current, dt) = (0.05, p.sample_period);
        let acceleration = p.stage.force_constant * current / p.stage.mass;
        for k in 0..3000 {
            let innovation = filter.update(Some(0.5 * acceleration * (f64::from(k) * dt).powi(2)), current, 0.0);
            assert!(k < 2000 || innovation.abs() < 1e-12, "{k}: {innovation} m");
        }
        assert!(filter.state[2].abs() < 1e-3, "{} N", filter.state[2]);
    }

    #[test]
    fn a_harmonic_close_to_nyquist_is_not_modelled() {
        let p = Parameters::START;
        let still = KalmanFilter::new(&p);
        for (ratio, modelled) in [(0.89, true), (0.91, false), (1.2, false)] {
            let mut filter = still.clone();
            filter.update(Some(0.0), 0.0, ratio * PI / p.sample_period);
            assert_eq!(filter.transition != still.transition, modelled, "{ratio}");
        }
    }
}
