//! Checks the inputs of a sample: usable values, replacements for the others, and faults.
//!
//! A value that is not finite, or that the machine cannot have reached, is bridged by the last accepted one. It moves
//! nothing and causes no transition. The reach in one sample is three times the largest velocity of the slide (taps
//! rebound), the fastest plausible table, and for the probe the motion of the slide plus the possible motion of the
//! ring. A ring that is held turns with the table (eq. 2 and 5 with `ring.eccentricity_max`); one that is pushed may be
//! anywhere around the axis, and is hit at up to twice the speed of the slide.

use control_blocks::{Consecutive, Edge, JumpGuard, Reach, is_plausible, wrap};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Input, Parameters};
use crate::limits::GRAVITY;
use crate::sensing::calm::{Calm, CalmFilter};

/// Largest angle without loss of the last digits, rad.
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
        // eq. 13: const - x_s, x_s the surface position
        self.slide - self.probe
    }
}

/// Possible causes of motion until the next sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// By hand: every finite value is accepted.
    Hand,
    /// Spindle and slide; the ring is held by friction.
    Held,
    /// The slide may push the ring as well.
    Pushed,
}

/// Result of the checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// The encoders, or their replacements; none before the first finite values of all three.
    pub sample: Option<Sample>,
    /// All three are new measurements.
    pub fresh: bool,
    /// Position of the probe without single spikes.
    pub calm: Calm,
    /// New slide position, if it is plausible, m.
    pub slide: Option<f64>,
    /// First sample, or spindle or slide have been moved while they were not monitored.
    pub jumped: bool,
    /// Fault of the measurements.
    pub fault: Option<Fault>,
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// `commission` is set.
    pub commission: bool,
    /// Rising edge of `commission`.
    pub begin_commission: bool,
}

/// State between two samples; by default before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    accepted: Option<Sample>,
    angle: JumpGuard,
    slide: JumpGuard,
    probe: JumpGuard,
    sprung: Consecutive,
    calm: CalmFilter,
    begun: bool,
    enable: Edge,
    reset: Edge,
    commission: Edge,
}

impl Reader {
    /// Checks one sample.
    pub fn read(&mut self, p: &Parameters, input: &Input, freedom: Freedom) -> Reading {
        let (start, reset) = (self.enable.rises(input.enable), self.reset.rises(input.reset_fault));
        let begin_commission = self.commission.rises(input.commission);
        // an input that is true from the first sample on has not risen
        let begun = std::mem::replace(&mut self.begun, true);
        let (start, begin_commission) = (begun && start, begun && begin_commission);
        let number = |value: f64, maximum: f64| if is_plausible(value, maximum) { value } else { f64::NAN };
        let raw = Sample {
            angle: number(input.spindle_angle, ANGLE_MAX),
            slide: number(input.slide_position, POSITION_MAX),
            probe: number(input.probe_position, POSITION_MAX),
        };
        let (enabled, commission) = (input.enable, input.commission);
        Reading { enabled, start, reset, commission, begin_commission, ..self.believe(p, &raw, freedom) }
    }

    /// Bridges implausible values.
    fn believe(&mut self, p: &Parameters, raw: &Sample, freedom: Freedom) -> Reading {
        let before = self.accepted.unwrap_or(*raw);
        // the spindle turns without limit: its monitor uses the angle relative to the last accepted one
        let rotated = take(&mut self.angle, wrap(raw.angle - before.angle), turning(p), freedom);
        let slid = take(&mut self.slide, raw.slide, sliding(p), freedom);
        let kept = |guard: &JumpGuard, now: f64, last: f64| if guard.doubted() > 0 { last } else { now };
        let (angle, slide) = (kept(&self.angle, raw.angle, before.angle), kept(&self.slide, raw.slide, before.slide));
        let probe = self.collapse(p, raw.probe, &before, slide, freedom);
        if self.angle.doubted() == 0 {
            self.angle.clear();
            self.angle.update(0.0, turning(p));
        }
        let sample = Sample { angle, slide, probe };
        let known = self.accepted.is_some() || sample == *raw;
        let jumped = self.accepted.is_none() || rotated || slid;
        let events = Reading {
            slide: (self.slide.doubted() == 0).then_some(raw.slide),
            jumped,
            fault: self.fault(p, raw),
            ..Reading::default()
        };
        if !known {
            return events;
        }
        self.accepted = Some(sample);
        let calm = self.calm.update(Calm { probe: sample.probe, tip: sample.tip() });
        Reading { sample: Some(sample), fresh: sample == *raw, calm, ..events }
    }

    /// Collapse of the probe (m) to use, with the slide at `slide` m; `before` is the sample used last.
    ///
    /// A probe that has lost the ring extends immediately, so this is accepted when it lasts.
    fn collapse(&mut self, p: &Parameters, raw: f64, before: &Sample, slide: f64, freedom: Freedom) -> f64 {
        let reach = collapsing(p, (slide - before.slide).abs(), freedom);
        let free = raw < 0.5 * p.probe.contact;
        let springs = free && (self.probe.doubted() > 0 || before.probe - raw > reach.motion + reach.spread);
        take(&mut self.probe, if springs { f64::NAN } else { raw }, reach, freedom);
        let out = self.sprung.update(free && self.probe.doubted() > 0) > p.limits.lost_samples.unsigned_abs();
        if out || self.probe.doubted() == 0 { raw } else { before.probe }
    }

    fn fault(&self, p: &Parameters, raw: &Sample) -> Option<Fault> {
        let lost = |guard: &JumpGuard| guard.doubted() > p.limits.lost_samples.unsigned_abs();
        let probe = lost(&self.probe) && self.sprung.count() == 0;
        let found = [
            (lost(&self.slide), raw.slide, Fault::PositionLost, Fault::PositionJump),
            (lost(&self.angle), raw.angle, Fault::SpindleLost, Fault::SpindleJump),
            (probe, raw.probe, Fault::ProbeLost, Fault::ProbeJump),
        ];
        let (_, value, none, jump) = found.into_iter().find(|(lost, ..)| *lost)?;
        Some(if value.is_nan() { none } else { jump })
    }
}

/// Adds a measurement to its monitor; whether it was accepted only because the machine may be moved by hand.
fn take(guard: &mut JumpGuard, raw: f64, reach: Reach, freedom: Freedom) -> bool {
    guard.update(raw, reach);
    let moved = freedom == Freedom::Hand && raw.is_finite() && guard.doubted() > 0;
    if moved {
        guard.clear();
        guard.update(raw, reach);
    }
    moved
}

fn turning(p: &Parameters) -> Reach {
    Reach { motion: SPEED_MAX * p.sample_period, spread: p.spindle_resolution }
}

fn sliding(p: &Parameters) -> Reach {
    Reach { motion: SLIDE_SPEED_RATIO * p.slide.velocity_max * p.sample_period, spread: RESOLUTION }
}

/// Reach of the probe while the slide moves by `slid` m.
fn collapsing(p: &Parameters, slid: f64, freedom: Freedom) -> Reach {
    // twice the eccentricity of any ring, times the speed at which friction holds it there: more than eq. 5
    let held = |eccentricity: f64| 2.0 * (p.limits.friction * GRAVITY * eccentricity).sqrt();
    let surface = match freedom {
        Freedom::Held => held(p.ring.eccentricity_max.min(p.ring.radius)),
        Freedom::Hand | Freedom::Pushed => held(p.ring.radius) + 2.0 * p.slide.velocity_max,
    };
    Reach { motion: slid + surface * p.sample_period, spread: RESOLUTION }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::PAPER;

    fn at(angle: f64, slide: f64, probe: f64) -> Input {
        Input { spindle_angle: angle, slide_position: slide, probe_position: probe, ..Input::START }
    }

    /// Result for consecutive probe or slide positions (m), with slide and spindle at rest.
    fn read(inputs: &[Input]) -> Vec<Reading> {
        let mut reader = Reader::default();
        inputs.iter().map(|input| reader.read(&P, input, Freedom::Pushed)).collect()
    }

    #[test]
    fn nonsense_is_never_used_and_has_a_name_when_it_lasts() {
        let good = at(1.0, 0.1, 0.01);
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let spoilt = [
                (at(nonsense, 0.1, 0.01), Fault::SpindleLost),
                (at(1.0, 0.1, nonsense), Fault::ProbeLost),
                (at(1.0, nonsense, 0.01), Fault::PositionLost),
            ];
            for (bad, fault) in spoilt {
                // before the first good one there is no replacement
                for (k, reading) in read(&vec![bad.clone(); 4]).iter().enumerate() {
                    assert_eq!((reading.sample, reading.fault), (None, (k == 3).then_some(fault)));
                }
                let readings = read(&[good.clone(), bad.clone(), bad.clone(), bad.clone(), bad, good.clone()]);
                for (k, reading) in readings.iter().enumerate() {
                    assert_eq!(reading.sample, Some(Sample { angle: 1.0, slide: 0.1, probe: 0.01 }), "{k}");
                    assert_eq!(reading.fresh, k == 0 || k == 5, "{k}");
                    assert_eq!(reading.fault, (k == 4).then_some(fault), "{k}");
                }
            }
        }
    }

    #[test]
    fn a_probe_that_shows_nothing_does_not_hide_the_slide() {
        let slid = |k: u32| 0.1 + 1.2e-4 * f64::from(k);
        let inputs: Vec<Input> = (0..100).map(|k| at(1.0, slid(k), if k > 0 { f64::NAN } else { 0.01 })).collect();
        for (k, reading) in (0..).zip(read(&inputs)) {
            assert_eq!((reading.slide, reading.sample.unwrap().slide), (Some(slid(k)), slid(k)));
            assert_eq!(reading.fault, (k > 3).then_some(Fault::ProbeLost));
        }
    }

    #[test]
    fn a_held_ring_goes_with_the_table_and_a_pushed_one_with_the_slide() {
        // 25 mm: 0.22 mm in a sample; a ring that is hit, and the slide springing back
        for (freedom, slid, reach) in [(Freedom::Held, 0.0, 2.41e-4), (Freedom::Pushed, 3e-4, 8.73e-4)] {
            for (step, accepted) in [(reach - 1e-6, true), (reach + 1e-6, false)] {
                let mut reader = Reader::default();
                reader.read(&P, &at(1.0, 0.1, 0.01), freedom);
                let reading = reader.read(&P, &at(1.0, 0.1 + slid, 0.01 + step), freedom);
                assert_eq!(reading.fresh, accepted, "{freedom:?}: {step} m");
            }
        }
    }

    #[test]
    fn the_fastest_machine_is_accepted_and_a_wrap_is_no_jump() {
        let inputs: Vec<Input> = (0..100)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| at((99.0 * t).rem_euclid(std::f64::consts::TAU), 0.3 * t, 0.5 * t))
            .collect();
        for (reading, input) in read(&inputs).iter().zip(&inputs) {
            let accepted = (reading.sample.unwrap(), reading.fresh, reading.fault);
            let raw = Sample { angle: input.spindle_angle, slide: input.slide_position, probe: input.probe_position };
            assert_eq!(accepted, (raw, true, None));
        }
    }

    #[test]
    fn up_to_the_limit_jumps_are_bridged_and_then_they_have_a_name() {
        let good = at(1.0, 0.1, 0.01);
        let here = Sample { angle: 1.0, slide: 0.1, probe: 0.01 };
        let spoilt = [(at(3.0, 0.1, 0.01), Fault::SpindleJump), (at(1.0, 0.1, 0.02), Fault::ProbeJump)];
        for (bad, fault) in spoilt.into_iter().chain([(at(1.0, 0.12, 0.01), Fault::PositionJump)]) {
            let readings = read(&[good.clone(), bad.clone(), bad.clone(), bad.clone(), bad, good.clone()]);
            for (k, reading) in readings.iter().enumerate() {
                assert_eq!(reading.sample, Some(here), "{k}");
                assert_eq!(reading.fresh, k == 0 || k == 5, "{k}");
                assert_eq!(reading.fault, (k == 4).then_some(fault), "{k}");
            }
        }
    }

    #[test]
    fn a_probe_that_springs_out_is_accepted_when_it_lasts_and_when_it_returns() {
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
    fn what_a_hand_does_is_accepted_immediately() {
        let mut reader = Reader::default();
        for (k, slide) in [0.1, 0.3, 0.2].into_iter().enumerate() {
            let reading = reader.read(&P, &at(f64::from(k as u8), slide, 0.0), Freedom::Hand);
            assert_eq!((reading.sample.unwrap().slide, reading.jumped, reading.fault), (slide, true, None));
        }
    }

    #[test]
    fn a_hand_that_moves_one_of_both_has_moved_something() {
        for (angle, slide) in [(3.0, 0.1), (1.0, 0.3)] {
            let mut reader = Reader::default();
            let jumped = [at(1.0, 0.1, 0.0), at(1.0, 0.1, 0.0), at(angle, slide, 0.0), at(angle, slide, 0.0)]
                .map(|input| reader.read(&P, &input, Freedom::Hand).jumped);
            assert_eq!(jumped, [true, false, true, false], "{angle} rad, {slide} m");
        }
    }

    #[test]
    fn a_slow_hand_is_no_jump() {
        let mut reader = Reader::default();
        for k in 0..10 {
            let reading = reader.read(&P, &at(1e-3 * f64::from(k), 0.1 + 1e-6 * f64::from(k), 0.0), Freedom::Hand);
            assert_eq!(reading.jumped, k == 0, "{k}");
        }
    }

    #[test]
    fn enable_and_reset_are_edges_and_an_enable_from_the_beginning_is_none() {
        let mut reader = Reader::default();
        let high = Input { enable: true, reset_fault: true, ..Input::START };
        let edges = [&high, &high, &Input::START, &high].map(|input| {
            let reading = reader.read(&P, input, Freedom::Hand);
            (reading.enabled, reading.start, reading.reset)
        });
        assert_eq!(edges, [(true, false, true), (true, false, false), (false, false, false), (true, true, true)]);
    }

    #[test]
    fn the_tip_is_slide_less_probe() {
        assert_eq!(Sample { angle: 0.0, slide: 0.5, probe: 0.25 }.tip(), 0.25);
    }

    #[test]
    fn a_probe_that_goes_out_within_its_reach_is_accepted_immediately() {
        let reach = collapsing(&P, 0.0, Freedom::Pushed);
        let maximum = reach.motion + reach.spread;
        let free = 0.499 * P.probe.contact;
        for (distance, probe) in [(0.99 * maximum, free), (1.01 * maximum, free + 1.01 * maximum)] {
            let readings = read(&[at(1.0, 0.1, free + distance), at(1.0, 0.1, free)]);
            assert_eq!(readings[1].sample.unwrap().probe, probe, "{distance}");
        }
    }

    #[test]
    fn a_free_probe_that_was_accepted_is_so_from_the_fourth_sample_on() {
        let (good, out) = (at(1.0, 0.1, 0.0195), at(1.0, 0.1, 0.0));
        let mut inputs = vec![good.clone()];
        inputs.extend(std::iter::repeat_n(out, 3));
        inputs.push(good);
        let probes: Vec<f64> = read(&inputs).iter().map(|reading| reading.sample.unwrap().probe).collect();
        assert_eq!(probes, [0.0195; 5]);
        // half of the contact is contact: such a jump is one
        let low = at(1.0, 0.1, 0.5 * P.probe.contact);
        let readings = read(&[at(1.0, 0.1, 0.0195), low.clone(), low.clone(), low.clone(), low]);
        assert_eq!(readings[4].fault, Some(Fault::ProbeJump));
    }
}
