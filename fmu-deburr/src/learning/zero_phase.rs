//! Zero-phase low-pass: a Butterworth filter of second order, run forward and backward.

use std::f64::consts::SQRT_2;

use serde::{Deserialize, Serialize};

/// Samples by which the signal is continued at both ends.
pub const PAD: usize = 64;

/// The filter; its gain is that of the Butterworth filter, squared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ZeroPhase {
    b: f64,
    a1: f64,
    a2: f64,
}

impl ZeroPhase {
    /// From its bandwidth (rad/s, below half the sampling rate) and the sample period (s).
    pub fn new(bandwidth: f64, dt: f64) -> Self {
        let k = (0.5 * bandwidth * dt).tan();
        let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
        Self { b: k * k * scale, a1: 2.0 * (k * k - 1.0) * scale, a2: (1.0 - SQRT_2 * k + k * k) * scale }
    }

    /// Filters `values`; `work` has `2 PAD` numbers more. Beyond its ends the signal is constant, or it is periodic.
    pub fn filter(&self, values: &mut [f64], work: &mut [f64], periodic: bool) {
        let count = values.len();
        if count == 0 {
            return;
        }
        let work = &mut work[..count + 2 * PAD];
        for (k, slot) in work.iter_mut().enumerate() {
            let index = if periodic { (k + count * PAD - PAD) % count } else { k.saturating_sub(PAD).min(count - 1) };
            *slot = values[index];
        }
        self.run(work.iter_mut());
        self.run(work.iter_mut().rev());
        values.copy_from_slice(&work[PAD..PAD + count]);
    }

    /// One way, from rest at the first value.
    fn run<'a>(&self, mut signal: impl Iterator<Item = &'a mut f64>) {
        let Self { b, a1, a2 } = *self;
        let Some(first) = signal.next() else { return };
        let mut late = (b - a2) * *first;
        let mut soon = (2.0 * b - a1) * *first + late;
        for value in signal {
            let x = *value;
            let y = b * x + soon;
            soon = 2.0 * b * x - a1 * y + late;
            late = b * x - a2 * y;
            *value = y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.01;

    fn filtered(signal: impl Fn(f64) -> f64, count: usize, cutoff: f64, periodic: bool) -> Vec<f64> {
        let mut values: Vec<f64> = (0..count).map(|k| signal(k as f64)).collect();
        ZeroPhase::new(std::f64::consts::TAU * cutoff, DT).filter(
            &mut values,
            &mut vec![0.0; count + 2 * PAD],
            periodic,
        );
        values
    }

    #[test]
    fn a_constant_passes_unchanged() {
        for periodic in [false, true] {
            assert!(filtered(|_| 7.0, 300, 20.0, periodic).iter().all(|value| (value - 7.0).abs() < 1e-12));
        }
    }

    #[test]
    fn a_sine_keeps_its_phase_and_is_halved_at_the_cut_off() {
        for (hertz, gain) in [(1.0, 1.0), (20.0, 0.5), (45.0, 0.0)] {
            let sine = |k: f64| (std::f64::consts::TAU * hertz * DT * k + 0.3).sin();
            for (k, value) in filtered(sine, 400, 20.0, true).iter().enumerate() {
                assert!((value - gain * sine(k as f64)).abs() < 2e-3, "{hertz} Hz, {k}: {value}");
            }
        }
    }

    #[test]
    fn time_reversal_changes_nothing() {
        let pulse = |k: f64| if (140.0..150.0).contains(&k) { 1.0 } else { 0.0 };
        let forward = filtered(pulse, 300, 10.0, false);
        let mut backward = filtered(|k| pulse(299.0 - k), 300, 10.0, false);
        backward.reverse();
        assert!(forward.iter().zip(&backward).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
