//! Checks the inputs of a sample: what can be used, what stands in for the rest, and what is wrong with it.
//!
//! A reading where the machine cannot be is bridged by the last believed one: it moves nothing, and it begins and ends
//! nothing. Reach in one sample: three times the largest velocity of the slide (taps spring back), the fastest believable
//! table, and for the probe what slide and ring can do together, the ring at most 2 sqrt(mu g r) (eq. 2 and 5).

use control_blocks::{Consecutive, Edge, JumpGuard, Reach, believable, wrap};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Input, Parameters};
use crate::limits::GRAVITY;
use crate::sensing::calm::{Calm, CalmFilter};

/// Angles beyond this lose their last digits, rad.
const ANGLE_MAX: f64 = 1e7;
/// No slide of this kind is longer, m.
const POSITION_MAX: f64 = 100.0;
/// No table of this kind turns faster, rad/s.
const SPEED_MAX: f64 = 100.0;
/// The slide cannot be faster than this multiple of its largest velocity.
const SLIDE_SPEED_RATIO: f64 = 3.0;
/// The coarsest resolution of a length, m.
pub const RESOLUTION: f64 = 2e-5;

/// One good sample of the three encoders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
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

/// What is made of the inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// The encoders, or what stands in for them; none before the first numbers, or if one is no number.
    pub sample: Option<Sample>,
    /// All three are what has just been read.
    pub fresh: bool,
    /// Place of the probe without single spikes.
    pub calm: Calm,
    /// Slide position as it has just been read, if that is believable, m.
    pub slide: Option<f64>,
    /// First sample, or spindle or slide have been taken elsewhere while nobody watched.
    pub jumped: bool,
    /// What is wrong with the readings.
    pub fault: Option<Fault>,
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
    believed: Option<Sample>,
    angle: JumpGuard,
    slide: JumpGuard,
    probe: JumpGuard,
    sprung: Consecutive,
    calm: CalmFilter,
    begun: bool,
    enable: Edge,
    reset: Edge,
}

impl Reader {
    /// Reads one sample; a machine that is not `watched` may be moved by hand, and is believed.
    pub fn read(&mut self, p: &Parameters, input: &Input, watched: bool) -> Reading {
        let (start, reset) = (self.enable.rises(input.enable), self.reset.rises(input.reset_fault));
        // an `enable` that stands from the first sample on has not risen
        let start = std::mem::replace(&mut self.begun, true) && start;
        let events = Reading { enabled: input.enable, start, reset, ..Reading::default() };
        let slide = believable(input.slide_position, POSITION_MAX).then_some(input.slide_position);
        let Some(slide) = slide else { return Reading { fault: Some(Fault::LostReading), ..events } };
        if !(believable(input.probe_position, POSITION_MAX) && believable(input.spindle_angle, ANGLE_MAX)) {
            return Reading { slide: Some(slide), fault: Some(Fault::InvalidInput), ..events };
        }
        let raw = Sample { angle: input.spindle_angle, slide, probe: input.probe_position };
        Reading { enabled: input.enable, start, reset, ..self.believe(p, &raw, watched) }
    }

    /// Bridges what the machine cannot have done.
    fn believe(&mut self, p: &Parameters, raw: &Sample, watched: bool) -> Reading {
        let before = self.believed.unwrap_or(*raw);
        // the spindle turns for ever: its guard sees the angle from the last believed one
        self.angle.update(wrap(raw.angle - before.angle), turning(p));
        self.slide.update(raw.slide, sliding(p));
        let doubted = self.angle.doubted() > 0 || self.slide.doubted() > 0;
        let jumped = self.believed.is_none() || (doubted && !watched);
        if !watched {
            (self.angle, self.slide, self.probe) = Default::default();
            self.slide.update(raw.slide, sliding(p));
        }
        let probe = self.collapse(p, raw.probe, before.probe);
        let kept = |guard: &JumpGuard, now: f64, last: f64| if guard.doubted() > 0 { last } else { now };
        let sample = Sample {
            angle: kept(&self.angle, raw.angle, before.angle),
            slide: kept(&self.slide, raw.slide, before.slide),
            probe,
        };
        if self.angle.doubted() == 0 {
            self.angle.clear();
            self.angle.update(0.0, turning(p));
        }
        self.believed = Some(sample);
        Reading {
            sample: Some(sample),
            fresh: sample == *raw,
            calm: self.calm.update(Calm { probe: sample.probe, tip: sample.tip() }),
            slide: (self.slide.doubted() == 0).then_some(raw.slide),
            jumped,
            fault: self.fault(p),
            ..Reading::default()
        }
    }

    /// Collapse of the probe (m) to use; `before` is the one used last.
    ///
    /// A probe that has lost the ring springs out at once, so that is believed when it lasts.
    fn collapse(&mut self, p: &Parameters, raw: f64, before: f64) -> f64 {
        let reach = collapsing(p);
        let free = raw < 0.5 * p.probe.contact;
        let springs = free && (self.probe.doubted() > 0 || before - raw > reach.motion + reach.spread);
        let believed = self.probe.update(if springs { f64::NAN } else { raw }, reach);
        let out = self.sprung.update(free && self.probe.doubted() > 0) > p.limits.lost_samples.unsigned_abs();
        if out { raw } else { believed }
    }

    fn fault(&self, p: &Parameters) -> Option<Fault> {
        let lost = |guard: &JumpGuard| guard.doubted() > p.limits.lost_samples.unsigned_abs();
        let jumping = lost(&self.angle) || (lost(&self.probe) && self.sprung.count() == 0);
        lost(&self.slide).then_some(Fault::LostReading).or(jumping.then_some(Fault::ReadingJump))
    }
}

fn turning(p: &Parameters) -> Reach {
    Reach { motion: SPEED_MAX * p.sample_period, spread: p.spindle_quantum }
}

fn sliding(p: &Parameters) -> Reach {
    Reach { motion: SLIDE_SPEED_RATIO * p.slide.velocity_max * p.sample_period, spread: RESOLUTION }
}

fn collapsing(p: &Parameters) -> Reach {
    // a ring that is hit goes at most at twice the speed of the slide
    let surface = 2.0 * (p.limits.friction * GRAVITY * p.ring.radius).sqrt() + 2.0 * p.slide.velocity_max;
    let slide = sliding(p);
    Reach { motion: slide.motion + surface * p.sample_period, spread: RESOLUTION }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::PAPER;

    fn at(angle: f64, slide: f64, probe: f64) -> Input {
        Input { spindle_angle: angle, slide_position: slide, probe_position: probe, ..Input::START }
    }

    /// What is made of the probe or slide positions (m), read one after the other beside a slide and a spindle at rest.
    fn read(inputs: &[Input]) -> Vec<Reading> {
        let mut reader = Reader::default();
        inputs.iter().map(|input| reader.read(&P, input, true)).collect()
    }

    #[test]
    fn nonsense_is_never_used() {
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            for (k, input) in
                [at(nonsense, 0.0, 0.0), at(0.0, nonsense, 0.0), at(0.0, 0.0, nonsense)].iter().enumerate()
            {
                let reading = Reader::default().read(&P, input, true);
                let (slide, fault) = if k == 1 { (None, Fault::LostReading) } else { (Some(0.0), Fault::InvalidInput) };
                assert_eq!((reading.sample, reading.slide, reading.fault), (None, slide, Some(fault)));
            }
        }
    }

    #[test]
    fn the_fastest_machine_is_believed_and_a_wrap_is_no_jump() {
        let inputs: Vec<Input> = (0..100)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| at((99.0 * t).rem_euclid(std::f64::consts::TAU), 0.3 * t, 0.5 * t))
            .collect();
        for (reading, input) in read(&inputs).iter().zip(&inputs) {
            let believed = (reading.sample.unwrap(), reading.fresh, reading.fault);
            let raw = Sample { angle: input.spindle_angle, slide: input.slide_position, probe: input.probe_position };
            assert_eq!(believed, (raw, true, None));
        }
    }

    #[test]
    fn up_to_the_limit_jumps_are_bridged_and_then_they_have_a_name() {
        let good = at(1.0, 0.1, 0.01);
        let here = Sample { angle: 1.0, slide: 0.1, probe: 0.01 };
        let spoilt = [(at(3.0, 0.1, 0.01), Fault::ReadingJump), (at(1.0, 0.1, 0.02), Fault::ReadingJump)];
        for (bad, fault) in spoilt.into_iter().chain([(at(1.0, 0.12, 0.01), Fault::LostReading)]) {
            let readings = read(&[good.clone(), bad.clone(), bad.clone(), bad.clone(), bad, good.clone()]);
            for (k, reading) in readings.iter().enumerate() {
                assert_eq!(reading.sample, Some(here), "{k}");
                assert_eq!(reading.fresh, k == 0 || k == 5, "{k}");
                assert_eq!(reading.fault, (k == 4).then_some(fault), "{k}");
            }
        }
    }

    #[test]
    fn a_probe_that_springs_out_is_believed_when_it_lasts_and_when_it_comes_back() {
        let (good, out) = (at(1.0, 0.1, 0.0195), at(1.0, 0.1, 0.0));
        let mut inputs = vec![good.clone()];
        inputs.extend(std::iter::repeat_n(out, 80));
        inputs.push(good);
        let probes: Vec<f64> = read(&inputs).iter().map(|reading| reading.sample.unwrap().probe).collect();
        assert!(probes[..4] == [0.0195; 4] && probes[4..81].iter().all(|&probe| probe == 0.0));
        assert_eq!(probes[81], 0.0195);
        assert!(read(&inputs).iter().all(|reading| reading.fault.is_none()));
    }

    #[test]
    fn what_a_hand_does_is_believed_at_once() {
        let mut reader = Reader::default();
        for (k, slide) in [0.1, 0.3, 0.2].into_iter().enumerate() {
            let reading = reader.read(&P, &at(f64::from(k as u8), slide, 0.0), false);
            assert_eq!((reading.sample.unwrap().slide, reading.jumped, reading.fault), (slide, true, None));
        }
    }

    #[test]
    fn enable_and_reset_are_edges_and_an_enable_from_the_beginning_is_none() {
        let mut reader = Reader::default();
        let high = Input { enable: true, reset_fault: true, ..Input::START };
        let edges = [&high, &high, &Input::START, &high].map(|input| {
            let reading = reader.read(&P, input, true);
            (reading.enabled, reading.start, reading.reset)
        });
        assert_eq!(edges, [(true, false, true), (true, false, false), (false, false, false), (true, true, true)]);
    }

    #[test]
    fn the_tip_is_slide_less_probe() {
        assert_eq!(Sample { angle: 0.0, slide: 0.5, probe: 0.25 }.tip(), 0.25);
    }
}
