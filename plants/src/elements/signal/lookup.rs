//! Periodic function of an angle as a table.

use std::f64::consts::TAU;

use crate::element::{Element, Ports};

/// `value(angle)`: linear between samples that are spaced evenly over one revolution.
///
/// Against a harmonic of order n the error is at most its amplitude times `(pi n / samples)^2 / 2`.
#[derive(Clone, Debug)]
pub struct Lookup {
    /// samples of one revolution, the first at zero
    samples: Vec<f64>,
}

impl Lookup {
    /// A table of one revolution, or none if there is no sample.
    pub fn new(samples: Vec<f64>) -> Option<Self> {
        (!samples.is_empty()).then_some(Self { samples })
    }

    /// Value and slope per rad at `angle` rad.
    pub fn at(&self, angle: f64) -> (f64, f64) {
        let count = self.samples.len();
        let spacing = TAU / count as f64;
        let place = angle.rem_euclid(TAU) / spacing;
        // rounding may move an angle just below a revolution to the full revolution
        let index = (place as usize).min(count - 1);
        let (left, right) = (self.samples[index], self.samples[(index + 1) % count]);
        (left + (place - index as f64) * (right - left), (right - left) / spacing)
    }
}

impl Element for Lookup {
    fn ports(&self) -> Ports {
        Ports { inputs: &["angle"], outputs: &["value"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        outputs[0] = self.at(inputs[0]).0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(count: usize) -> Lookup {
        let samples = (0..count).map(|i| (3.0 * TAU * i as f64 / count as f64).sin()).collect();
        Lookup::new(samples).expect("samples")
    }

    #[test]
    fn follows_a_harmonic_and_its_slope_over_many_turns() {
        let table = sine(1024);
        let bound = (std::f64::consts::PI * 3.0 / 1024.0_f64).powi(2) / 2.0;
        for k in -3000..3000 {
            let angle = f64::from(k) * 0.01;
            let (value, slope) = table.at(angle);
            assert!((value - (3.0 * angle).sin()).abs() <= bound, "at {angle} rad: {value}");
            assert!((slope - 3.0 * (3.0 * angle).cos()).abs() < 0.03, "at {angle} rad: slope {slope}");
        }
    }

    #[test]
    fn the_turn_closes() {
        let table = Lookup::new(vec![1.0, 2.0, 5.0, 4.0]).expect("samples");
        assert_eq!(table.at(0.0).0, 1.0);
        assert_eq!(table.at(TAU).0, 1.0);
        assert!((table.at(-TAU / 8.0).0 - 2.5).abs() < 1e-12);
        assert!(table.at(-1e-20).0.is_finite());
        assert!(Lookup::new(Vec::new()).is_none());
    }
}
