//! Axial position of one cutting edge on a tool that is tilted on its spindle.

use crate::element::{Element, Ports};

/// `retreat[m] = shortfall + tilt (1 - cos(angle + offset))`: axial distance of the edge from the longest point.
#[derive(Clone, Debug)]
pub struct Flute {
    /// length missing against the longest edge, m
    shortfall: f64,
    /// axial run-out from the tilt, amplitude, m
    tilt: f64,
    /// position of the edge on the circumference, rad
    offset: f64,
}

impl Flute {
    /// An edge at `offset` rad, `shortfall` m short, on a tool with an axial run-out amplitude of `tilt` m.
    pub fn new(shortfall: f64, tilt: f64, offset: f64) -> Self {
        Self { shortfall, tilt, offset }
    }
}

impl Element for Flute {
    fn ports(&self) -> Ports {
        Ports { inputs: &["angle"], outputs: &["retreat"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        outputs[0] = self.shortfall + self.tilt * (1.0 - (inputs[0] + self.offset).cos());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn retreat_is_the_shortfall_at_best_and_two_tilts_more_at_worst() {
        let mut flute = Flute::new(1e-7, 5e-8, PI);
        let mut out = [0.0];
        for (angle, retreat) in [(PI, 1e-7), (0.0, 2e-7), (PI / 2.0, 1.5e-7)] {
            flute.step(&[angle], &mut out, 1e-4);
            assert!((out[0] - retreat).abs() < 1e-20, "at {angle} rad: {} m", out[0]);
        }
    }
}
