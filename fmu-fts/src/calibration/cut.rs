//! Means and largest motions of arm and slide, and mean torque, while the tool cuts a part for the calibration.

use serde::{Deserialize, Serialize};

/// Means and largest motions over one cut; by default without a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cut {
    samples: u32,
    first: Moment,
    /// Sums of the differences to the first sample.
    sum: Moment,
    deflection: f64,
    travel: f64,
}

/// One sample of a cut, or the mean of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// Encoder angle b of the arm, rad.
    pub arm_angle: f64,
    /// Torque of the arm, N.m.
    pub torque: f64,
    /// Slide position x, m.
    pub slide_position: f64,
}

impl Cut {
    /// Takes one sample.
    pub fn add(&mut self, now: Moment) {
        if self.samples == 0 {
            self.first = now;
        }
        let deflection = now.arm_angle - self.first.arm_angle;
        let travel = now.slide_position - self.first.slide_position;
        self.sum.arm_angle += deflection;
        self.sum.torque += now.torque - self.first.torque;
        self.sum.slide_position += travel;
        self.deflection = self.deflection.max(deflection.abs());
        self.travel = self.travel.max(travel.abs());
        self.samples = self.samples.saturating_add(1);
    }

    /// The mean; none if nothing was cut.
    pub fn mean(&self) -> Option<Moment> {
        let n = f64::from(self.samples);
        (self.samples > 0).then(|| Moment {
            arm_angle: self.first.arm_angle + self.sum.arm_angle / n,
            torque: self.first.torque + self.sum.torque / n,
            slide_position: self.first.slide_position + self.sum.slide_position / n,
        })
    }

    /// Largest difference of the arm angle from that of the first sample, rad.
    pub fn deflection(&self) -> f64 {
        self.deflection
    }

    /// Largest difference of the slide position from that of the first sample, m.
    pub fn travel(&self) -> f64 {
        self.travel
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_largest_differences() {
        let mut cut = Cut::default();
        assert_eq!(cut.mean(), None);
        for k in 0..=10 {
            let k = f64::from(k);
            cut.add(Moment { arm_angle: 0.7 + 1e-6 * k, torque: 0.2 * k, slide_position: 0.1 - 1e-3 * k });
        }
        let mean = cut.mean().unwrap();
        assert!((mean.arm_angle - 0.700_005).abs() < 1e-15);
        assert!((mean.torque - 1.0).abs() < 1e-12 && (mean.slide_position - 0.095).abs() < 1e-15);
        assert!((cut.deflection() - 1e-5).abs() < 1e-15 && (cut.travel() - 0.01).abs() < 1e-15);
    }
}
