//! Checks the inputs of a sample: what can be used, and what is wrong with the rest.

use control_blocks::{Edge, believable, wrap};
use serde::{Deserialize, Serialize};

use crate::interface::{Input, Parameters};

/// Angles beyond this lose their last digits, rad.
const ANGLE_MAX: f64 = 1e7;
/// No slide of this kind is longer, m.
const POSITION_MAX: f64 = 100.0;
/// No table of this kind turns faster, rad/s.
const SPEED_MAX: f64 = 100.0;
/// The slide cannot be faster than this multiple of its largest velocity.
const SLIDE_SPEED_RATIO: f64 = 10.0;

/// One good sample of the three encoders.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Spindle angle as it came, rad.
    pub angle: f64,
    /// Slide position s, m.
    pub slide: f64,
    /// Probe collapse q, m.
    pub probe: f64,
}

impl Sample {
    /// Position of the measuring tip, m.
    pub fn tip(&self) -> f64 {
        // eq. 13: const - x_s, x_s the place of the surface
        self.slide - self.probe
    }
}

/// The usable part of the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The encoders; none if one of them is not believable.
    pub sample: Option<Sample>,
    /// Slide position, if that is believable, m.
    pub slide: Option<f64>,
    /// The sample is the first one, or spindle or slide are where they cannot have gone.
    pub jumped: bool,
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
}

/// Remembers what one reading needs from the ones before; by default nothing, before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    before: Option<Sample>,
    enable: Edge,
    reset: Edge,
}

impl Reader {
    /// Reads one sample.
    pub fn read(&mut self, p: &Parameters, input: &Input) -> Reading {
        let slide = believable(input.slide_position, POSITION_MAX).then_some(input.slide_position);
        let good = slide.is_some()
            && believable(input.probe_position, POSITION_MAX)
            && believable(input.spindle_angle, ANGLE_MAX);
        let sample = good.then_some(Sample {
            angle: input.spindle_angle,
            slide: input.slide_position,
            probe: input.probe_position,
        });
        let jumped = sample.is_some_and(|now| self.before.is_none_or(|before| jump(p, &before, &now)));
        if sample.is_some() {
            self.before = sample;
        }
        let (start, reset) = (self.enable.rises(input.enable), self.reset.rises(input.reset_fault));
        Reading { sample, slide, jumped, enabled: input.enable, start, reset }
    }
}

fn jump(p: &Parameters, before: &Sample, now: &Sample) -> bool {
    let turned = wrap(now.angle - before.angle).abs();
    let moved = (now.slide - before.slide).abs();
    turned > SPEED_MAX * p.sample_period || moved > SLIDE_SPEED_RATIO * p.slide.velocity_max * p.sample_period
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::PAPER;

    fn at(angle: f64, slide: f64, probe: f64) -> Input {
        Input { spindle_angle: angle, slide_position: slide, probe_position: probe, ..Input::START }
    }

    #[test]
    fn nonsense_is_never_used() {
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            for (k, input) in
                [at(nonsense, 0.0, 0.0), at(0.0, nonsense, 0.0), at(0.0, 0.0, nonsense)].iter().enumerate()
            {
                let reading = Reader::default().read(&P, input);
                assert_eq!(reading.sample, None);
                assert_eq!(reading.slide.is_some(), k != 1);
            }
        }
    }

    #[test]
    fn a_jump_is_seen_and_a_wrap_is_none() {
        let mut reader = Reader::default();
        assert!(reader.read(&P, &at(6.27, 0.1, 0.0)).jumped, "the first sample");
        assert!(!reader.read(&P, &at(0.001, 0.1001, 0.02)).jumped);
        assert!(reader.read(&P, &at(3.0, 0.1001, 0.02)).jumped);
        assert!(reader.read(&P, &at(3.0, 0.2, 0.02)).jumped);
        assert!(!reader.read(&P, &at(3.0, 0.2, 0.0)).jumped, "a probe springs out at once");
    }

    #[test]
    fn enable_and_reset_are_edges() {
        let mut reader = Reader::default();
        let high = Input { enable: true, reset_fault: true, ..Input::START };
        let edges = [&high, &high, &Input::START, &high].map(|input| {
            let reading = reader.read(&P, input);
            (reading.enabled, reading.start, reading.reset)
        });
        assert_eq!(edges, [(true, true, true), (true, false, false), (false, false, false), (true, true, true)]);
    }

    #[test]
    fn the_tip_is_slide_less_probe() {
        assert_eq!(Sample { angle: 0.0, slide: 0.5, probe: 0.25 }.tip(), 0.25);
    }
}
