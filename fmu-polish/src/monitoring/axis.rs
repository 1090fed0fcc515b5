//! Compares the axes with their model: the position commanded by the pulses, and the position of the encoder.
//!
//! The model is `drive` with the pulses as held velocity u, exact between two samples: z' = A z + B u with
//! z = (r, a, s, v, x), r' = u, a' = w_ff (u - a), s' = e, v' = w_v (e + w_i s), x' = v, e = K_pp (r - x) + K_ff a - v.

use control_blocks::{Frozen, Response, SentCommands, ticks};
use nalgebra::{Matrix6, SMatrix, SVector, Vector3};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};

/// Limits of measured over commanded motion: below the first a wrong sign, below the second a weak drive.
const RATIOS: (f64, f64) = (-0.2, 0.5);
/// Fraction of the largest following error from which on motions are compared.
const BEGIN: f64 = 0.25;
/// Minimum number of these samples: a jump of the measurement is no property of the drive.
const COMPARED: u32 = 3;
/// Time for which a measurement may not change where an axis reverses later than configured, s.
const REVERSAL_TIME: f64 = 0.015;
/// Distance of a frozen measurement from the model, as a fraction of the travel without a response.
const APART: f64 = 0.5;
/// A measurement has changed beyond this, in its steps: the last bit may flicker.
pub const BAND: f64 = 1.5;

type State = SVector<f64, 5>;

/// The model of every axis between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Model {
    transition: SMatrix<f64, 5, 5>,
    input: State,
}

impl Model {
    fn new(p: &Parameters) -> Self {
        let d = &p.drive;
        let (wv, wi) = (d.velocity_bandwidth, d.velocity_integral);
        let (kp, ff, wf) = (d.position_gain, d.feedforward, d.feedforward_bandwidth);
        #[rustfmt::skip]
        let rates = Matrix6::new(
            0.0,     0.0,     0.0,     0.0, 0.0,      1.0,
            0.0,     -wf,     0.0,     0.0, 0.0,      wf,
            kp,      ff,      0.0,     -1.0, -kp,     0.0,
            wv * kp, wv * ff, wv * wi, -wv, -wv * kp, 0.0,
            0.0,     0.0,     0.0,     1.0, 0.0,      0.0,
            0.0,     0.0,     0.0,     0.0, 0.0,      0.0,
        );
        let whole = (rates * p.sample_period).exp();
        Self { transition: whole.fixed_view::<5, 5>(0, 0).into(), input: whole.fixed_view::<5, 1>(0, 5).into() }
    }
}

/// One axis.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Axis {
    /// measurement where the model began, m
    origin: f64,
    state: State,
    sent: SentCommands,
    frozen: Frozen,
    /// measured over modeled motion of each sample, since the error began to grow
    response: Response,
    compared: u32,
    /// last measurement, m
    before: f64,
    /// measurement less model, m
    error: f64,
}

impl Axis {
    fn starting(reading: f64) -> Self {
        Self { origin: reading, before: reading, ..Self::default() }
    }

    fn update(&mut self, p: &Parameters, model: &Model, reading: f64) {
        let before = self.state[4];
        let velocity = self.sent.before(p.io_delay.unsigned_abs() as usize);
        self.state = model.transition * self.state + model.input * velocity;
        let motion = self.state[4] - before;
        self.error = reading - self.origin - self.state[4];
        self.frozen.update(reading, motion, BAND * p.encoder_resolution);
        if self.error.abs() < BEGIN * p.limits.following_error {
            (self.response, self.compared) = (Response::default(), 0);
        } else {
            self.response.update(motion, reading - self.before, f64::INFINITY);
            self.compared = self.compared.saturating_add(1);
        }
        self.before = reading;
    }

    /// Fault of the axis; none if it follows.
    fn fault(&self, p: &Parameters) -> Option<Fault> {
        let beyond = self.error.abs() > p.limits.following_error;
        let threshold = BAND * p.encoder_resolution + p.limits.frozen;
        // an axis that comes to rest earlier than configured rests where the model will arrive
        let constant =
            self.frozen.still() > ticks(REVERSAL_TIME, p.sample_period) && self.error.abs() > APART * threshold;
        if self.frozen.unanswered() > threshold && (beyond || constant) {
            return Some(Fault::PositionFrozen);
        }
        beyond.then(|| match self.motion_ratio(p) {
            Some(ratio) if ratio < RATIOS.0 => Fault::DriveSign,
            Some(ratio) if ratio < RATIOS.1 => Fault::WeakDrive,
            _ => Fault::FollowingError,
        })
    }

    /// Measured over commanded motion, if the commanded motion is significant.
    fn motion_ratio(&self, p: &Parameters) -> Option<f64> {
        let ratio = self.response.ratio((3.0 * p.encoder_resolution).powi(2))?;
        (self.compared >= COMPARED).then_some(ratio)
    }
}

/// All axes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AxisMonitor {
    model: Model,
    axes: [Axis; 3],
}

impl AxisMonitor {
    /// At rest at the origin.
    pub fn new(p: &Parameters) -> Self {
        Self { model: Model::new(p), axes: Default::default() }
    }

    /// Begins at rest at the measurement `position` (m), with the drives of now.
    pub fn restart(&mut self, p: &Parameters, position: &Vector3<f64>) {
        self.model = Model::new(p);
        for (axis, reading) in self.axes.iter_mut().zip(position.iter()) {
            *axis = Axis::starting(*reading);
        }
    }

    /// Takes the measurements of a sample, m.
    pub fn update(&mut self, p: &Parameters, position: &Vector3<f64>) {
        for (axis, reading) in self.axes.iter_mut().zip(position.iter()) {
            axis.update(p, &self.model, *reading);
        }
    }

    /// Takes the pulses that are sent in this sample.
    pub fn send(&mut self, p: &Parameters, pulses: &Vector3<i32>) {
        for (axis, count) in self.axes.iter_mut().zip(pulses.iter()) {
            axis.sent.send(f64::from(*count) * p.pulses_size / p.sample_period);
        }
    }

    /// Fault of the first axis that has one; none if all axes follow.
    pub fn fault(&self, p: &Parameters) -> Option<Fault> {
        self.axes.iter().find_map(|axis| axis.fault(p))
    }

    /// Measured over commanded motion of the first axis with a fault, if the commanded motion is significant.
    pub fn motion_ratio(&self, p: &Parameters) -> Option<f64> {
        self.axes.iter().find(|axis| axis.fault(p).is_some())?.motion_ratio(p)
    }

    /// Distance of each axis from where its pulses bring it, m.
    pub fn errors(&self) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.axes[i].error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::pulses::Remainder;

    const P: Parameters = Parameters::START;

    /// The first fault of a machine that moves by `machine` from (commanded position, sample), reciprocating along x.
    fn found(machine: impl Fn(f64, u32) -> f64) -> Option<(Fault, u32)> {
        let (mut monitor, mut commanded) = (AxisMonitor::new(&P), Axis::default());
        let model = Model::new(&P);
        let mut remainder = Remainder::new();
        for k in 0..2000u32 {
            let velocity = if (k / 10).is_multiple_of(2) { 10e-3 } else { -10e-3 } + 1e-3;
            commanded.update(&P, &model, 0.0);
            let reading = (machine(commanded.state[4], k) * 1e6).round() * 1e-6;
            monitor.update(&P, &Vector3::new(reading, 0.0, 0.0));
            if let Some(fault) = monitor.fault(&P) {
                return Some((fault, k));
            }
            let pulses = remainder.step(&P, &Vector3::new(velocity, 0.0, 0.0));
            monitor.send(&P, &pulses);
            commanded.sent.send(f64::from(pulses.x) * P.pulses_size / P.sample_period);
        }
        None
    }

    /// An axis that is `error` m off and moved `ratio` of the commanded travel in `compared` samples.
    fn axis(error: f64, ratio: f64, compared: u32) -> Axis {
        let mut response = Response::default();
        response.update(1.0, ratio, f64::INFINITY);
        Axis { error, response, compared, ..Axis::default() }
    }

    #[test]
    fn a_gain_ratio_names_the_fault_from_three_samples_on_and_only_beyond_the_limit() {
        let limit = P.limits.following_error;
        for (ratio, compared, expected) in [
            (-0.21, 3, Fault::DriveSign),
            (-0.2, 3, Fault::WeakDrive),
            (0.49, 3, Fault::WeakDrive),
            (0.5, 3, Fault::FollowingError),
            (-1.0, 2, Fault::FollowingError),
        ] {
            for sign in [1.0, -1.0] {
                assert_eq!(axis(sign * 1.001 * limit, ratio, compared).fault(&P), Some(expected), "{ratio} {compared}");
                assert_eq!(axis(sign * limit, ratio, compared).fault(&P), None);
            }
        }
    }

    #[test]
    fn a_measurement_may_be_constant_for_the_time_in_which_an_axis_reverses() {
        let frozen = |threshold: f64, samples: u32, error: f64| {
            let mut axis = axis(error, 1.0, 3);
            (0..=samples).for_each(|k| axis.frozen.update(0.0, if k == 1 { threshold } else { 0.0 }, 1.0));
            axis.fault(&P)
        };
        let (threshold, far) = (BAND * P.encoder_resolution + P.limits.frozen, 1.001 * P.limits.following_error);
        assert_eq!(
            (frozen(1.001 * threshold, 15, -0.501 * threshold), frozen(1.001 * threshold, 16, -0.501 * threshold)),
            (None, Some(Fault::PositionFrozen))
        );
        // it has come to rest where the model comes to
        assert_eq!(frozen(1.001 * threshold, 100, 0.5 * threshold), None);
        assert_eq!(
            (frozen(threshold, 16, -0.501 * threshold), frozen(threshold, 16, far)),
            (None, Some(Fault::FollowingError))
        );
        assert_eq!(frozen(1.001 * threshold, 1, far), Some(Fault::PositionFrozen));
    }

    #[test]
    fn the_model_is_exact_between_samples_of_any_length() {
        let coarse = Parameters { sample_period: 5e-3, ..P };
        let fine = Parameters { sample_period: 1e-3, ..P };
        let (mut one, mut other) = (State::zeros(), State::zeros());
        for _ in 0..20 {
            let (a, b) = (Model::new(&coarse), Model::new(&fine));
            one = a.transition * one + a.input * 3e-3;
            (0..5).for_each(|_| other = b.transition * other + b.input * 3e-3);
            assert!((one - other).amax() < 1e-12, "{one} {other}");
        }
        // what is not fed forward: (1 - 0.8) v / 80
        assert!((one[0] - one[4] - 0.2 * 3e-3 / 80.0).abs() < 1e-6, "{one}");
    }

    #[test]
    fn the_machine_of_the_model_has_no_fault() {
        assert_eq!(found(|x, _| x), None);
        // a drive with half the amplitude: 45 um
        assert_eq!(found(|x, k| x - 20e-6 * (f64::from(k) * 0.31).sin()), None);
    }

    #[test]
    fn a_constant_measurement_is_frozen_and_a_flickering_last_bit_hides_nothing() {
        let at = |fault: Option<(Fault, u32)>| fault.map(|(fault, k)| (fault, k < 40));
        assert_eq!(at(found(|_, _| 0.0)), Some((Fault::PositionFrozen, true)));
        assert_eq!(at(found(|_, k| f64::from(k % 2) * 1e-6)), Some((Fault::PositionFrozen, true)));
        let (fault, k) = found(|x, k| if k < 500 { x } else { 0.48e-3 }).unwrap();
        assert!(fault == Fault::PositionFrozen && (500..540).contains(&k), "{fault:?} {k}");
    }

    #[test]
    fn sign_strength_and_offset_are_distinguished() {
        let name = |found: Option<(Fault, u32)>| found.map(|(fault, _)| fault);
        assert_eq!(name(found(|x, _| -x)), Some(Fault::DriveSign));
        assert_eq!(name(found(|x, _| 0.3 * x)), Some(Fault::WeakDrive));
        // from the middle of the motion on
        let position = std::cell::Cell::new(0.0);
        let reversed = found(|x, k| {
            if k <= 905 {
                position.set(x);
            }
            2.0 * position.get() - x
        });
        assert_eq!(name(reversed), Some(Fault::DriveSign));
        assert_eq!(name(found(|x, k| if k < 300 { x } else { x + 0.15e-3 })), Some(Fault::FollowingError));
        assert_eq!(name(found(|x, k| x + 1e-6 * f64::from(k))), Some(Fault::FollowingError));
    }
}
