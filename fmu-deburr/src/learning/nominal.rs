//! Nominal closed position loop, sampled: what a compensation does to the position.

use control_blocks::SentCommands;
use nalgebra::Matrix4;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::learning::drive::NominalDrive;

/// y / c with y the position, both in pulses: eq. 1 after the gain Kp, closed over the encoder.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Nominal {
    /// sampled position, velocity and its derivative: x' = A x + b v
    a: [[f64; 3]; 3],
    b: [f64; 3],
    gain: f64,
    delay: usize,
}

/// State of the loop between two samples.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct LoopState {
    x: [f64; 3],
    sent: SentCommands,
}

impl LoopState {
    /// At rest at a position, in counts.
    pub fn resting(position: f64) -> Self {
        Self { x: [position, 0.0, 0.0], sent: SentCommands::default() }
    }

    /// Position in counts.
    pub fn position(&self) -> f64 {
        self.x[0]
    }
}

impl Nominal {
    /// The loop of the axis `axis` (from 0).
    pub fn new(p: &Parameters, axis: usize) -> Self {
        Self::of(&NominalDrive::new(p, axis))
    }

    /// The loop around a drive.
    pub fn of(drive: &NominalDrive) -> Self {
        let (wn, zeta, dt) = (drive.frequency, drive.damping, drive.period);
        let mut continuous = Matrix4::zeros();
        // position, velocity, acceleration and the held command
        continuous[(0, 1)] = dt;
        continuous[(1, 2)] = dt;
        continuous[(2, 1)] = -wn * wn * dt;
        continuous[(2, 2)] = -2.0 * zeta * wn * dt;
        continuous[(2, 3)] = wn * wn * dt;
        let sampled = continuous.exp();
        let row = |i: usize| [sampled[(i, 0)], sampled[(i, 1)], sampled[(i, 2)]];
        Self {
            a: [row(0), row(1), row(2)],
            b: [sampled[(0, 3)], sampled[(1, 3)], sampled[(2, 3)]],
            gain: drive.servo_gain * drive.gain,
            delay: drive.delay,
        }
    }

    /// Position before this sample's command; then one sample with the compensation.
    pub fn step(&self, state: &mut LoopState, compensation: f64) -> f64 {
        let position = state.x[0];
        state.sent.send(self.gain * (compensation - position));
        let v = state.sent.before(self.delay);
        let [x0, x1, x2] = state.x;
        state.x = std::array::from_fn(|i| self.a[i][0] * x0 + self.a[i][1] * x1 + self.a[i][2] * x2 + self.b[i] * v);
        position
    }

    /// Replaces a signal by what the loop makes of it (T), or by what the loop that runs backward in time does (T').
    pub fn apply(&self, signal: &mut [f64], backward: bool) {
        let mut state = LoopState::default();
        let mut step = |value: &mut f64| *value = self.step(&mut state, *value);
        match backward {
            false => signal.iter_mut().for_each(&mut step),
            true => signal.iter_mut().rev().for_each(&mut step),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_compensation_is_the_position_in_the_end() {
        for io_delay in 0..=3 {
            let mut p = Parameters::START;
            p.io_delay = io_delay;
            let mut signal = vec![5.0; 300];
            Nominal::new(&p, 2).apply(&mut signal, false);
            assert!((signal[299] - 5.0).abs() < 1e-6);
            // the hold and the delay: nothing before
            assert!(signal[..=io_delay as usize].iter().all(|value| *value == 0.0));
            assert!(signal[io_delay as usize + 1] > 0.0);
        }
    }

    #[test]
    fn a_slow_loop_is_a_first_order_lag() {
        let mut p = Parameters::START;
        (p.servo_gain, p.io_delay, p.model_natural_frequency, p.model_damping) = ([1.0; 6], 0, 2000.0, 1.0);
        let mut signal = vec![1.0; 200];
        Nominal::new(&p, 0).apply(&mut signal, false);
        for (k, value) in signal.iter().enumerate() {
            assert!((value - 1.0 + (-0.01 * k as f64).exp()).abs() < 6e-3, "{k}: {value}");
        }
    }

    #[test]
    fn backward_is_the_transpose() {
        let nominal = Nominal::new(&Parameters::START, 0);
        let (a, b): (Vec<f64>, Vec<f64>) = (0..80).map(|k| ((k * k % 17) as f64, (k * 7 % 13) as f64 - 6.0)).unzip();
        let (mut ta, mut tb) = (a.clone(), b.clone());
        nominal.apply(&mut ta, false);
        nominal.apply(&mut tb, true);
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        assert!((dot(&ta, &b) - dot(&a, &tb)).abs() < 1e-9 * dot(&ta, &ta));
    }
}
