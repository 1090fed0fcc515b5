//! Frozen probe: a jammed probe looks like a centered ring.
//!
//! In a stroke and its retract the slide moves far relative to the ring, so the probe must respond by more than the coarsest
//! resolution. While following, the probe stays at its position: there only a probe that shows its last bit is distinguished
//! from a jammed one, which flickers by at most that bit. The test before `Centered` detects the remaining cases.

use std::f64::consts::TAU;

use control_blocks::Frozen;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::sensing::{RESOLUTION, Sample};

/// Motion of the slide on the ring that must change the probe signal while following, m (ten times the coarsest
/// resolution); and in a stroke, where slide and surface may move together for 8 ms, at 0.12 m/s as they cross at 2.56 m/s2.
const MOVED: f64 = 10.0 * RESOLUTION;
const MOVED_IN_STROKE: f64 = 1e-3;
/// Uncertainty of the probe position at which the pusher touches, in a push and otherwise, m (default; of a careful set-up).
pub const PRESSED_IN_PUSH: f64 = 1e-3;
const PRESSED: f64 = 1e-4;
/// Following error beyond the dead zone that no surface sustains, m (default: more than 15 mm at 45 rpm).
const FAR: f64 = 5e-4;
/// Distance by which a turning ring may push back a slide that moves out, m (default: 40 mm/s for the travel of 0.1 s).
const PUSHED_BACK: f64 = 5e-3;
/// Time below which a constant value is chance, s (default: three samples at a surface of 80 mm/s).
const STILL_TIME: f64 = 0.02;
/// Rotation (rad) in which an eccentric ring moves its surface by more than a last bit, also at a reversal.
const FROZEN_ANGLE: f64 = 0.125 * TAU;
/// Band of a last bit, in bits.
const FLICKER: f64 = 1.5;
/// Coarsest last bit that can be seen while following, m.
const BIT_MAX: f64 = 6e-7;
/// Coarsest last bit with which no ring gives the same value for a whole revolution, m (default: no ring is that round).
const FINE: f64 = 1e-7;

/// Relative motion of slide and ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The probe is held where it is.
    Follow,
    /// The slide moves to the ring and pushes it.
    Push,
    /// The slide moves away from the ring.
    Retract,
}

/// Since when the probe has kept its value.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FrozenProbe {
    monitor: Frozen,
    before: Option<Sample>,
    /// surface without a change, compared with the rotation (rad) of the ring
    tip: Frozen,
    /// rotation since it moved, rad
    rotation: f64,
    /// smallest change that was ever read, m
    bit: f64,
}

impl Default for FrozenProbe {
    /// Before the first sample.
    fn default() -> Self {
        Self { monitor: Frozen::default(), tip: Frozen::default(), before: None, rotation: 0.0, bit: f64::MAX }
    }
}

impl FrozenProbe {
    /// Whether the surface does not change while the ring turns: a wrong model is then the fault of the probe.
    pub fn tip_frozen(&self) -> bool {
        self.tip.unanswered() > FROZEN_ANGLE
    }

    /// Adds a sample and the rotation (rad) since the one before; whether the probe is frozen.
    pub fn update(&mut self, p: &Parameters, phase: Phase, sample: &Sample, rotation: f64) -> bool {
        let before = self.before.replace(*sample).unwrap_or(*sample);
        let change = (sample.probe - before.probe).abs();
        if change > 0.0 {
            self.bit = self.bit.min(change);
        }
        self.tip.update(sample.tip(), rotation, FLICKER * self.bit.clamp(BIT_MAX / FLICKER, RESOLUTION / FLICKER));
        // a ring at the pusher moves with the slide, and without contact there is no signal
        let pressed = |distance: f64| sample.probe >= p.probe.at_pusher - distance;
        // far from its position a probe returns to it, by more than the coarsest resolution
        let far = (p.null() - sample.probe).abs() > p.dead_zone() + FAR;
        let (band, limit, sees) = match phase {
            Phase::Push => (RESOLUTION, MOVED_IN_STROKE, !pressed(PRESSED_IN_PUSH)),
            Phase::Retract => (RESOLUTION, if pressed(PRESSED) { PUSHED_BACK } else { MOVED_IN_STROKE }, true),
            Phase::Follow if far => (RESOLUTION, MOVED_IN_STROKE, !pressed(PRESSED)),
            Phase::Follow if self.bit < BIT_MAX => (FLICKER * self.bit, MOVED, !pressed(PRESSED)),
            // a coarse one may not change for long: half of the travel to the pusher
            Phase::Follow => {
                (RESOLUTION, (0.5 * (p.probe.at_pusher - p.null())).max(MOVED_IN_STROKE), !pressed(PRESSED))
            }
        };
        if !sees || sample.probe < p.probe.contact {
            self.monitor.clear();
        }
        self.monitor.update(sample.probe, sample.slide - before.slide, band);
        self.rotation = if self.monitor.still() == 0 { 0.0 } else { self.rotation + rotation };
        let fine = self.bit <= FINE;
        let still = self.monitor.still() > p.ticks(STILL_TIME);
        (still && self.monitor.unanswered() > limit) || (fine && self.rotation.abs() >= TAU)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// Angle at which the probe is detected as frozen, in samples of 0.01 rad of a probe that has read steps of `bit` m.
    fn faulty(bit: f64, sample: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
        faulty_in(Phase::Follow, bit, sample)
    }

    fn faulty_in(phase: Phase, bit: f64, sample: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
        let mut frozen = FrozenProbe { bit, ..FrozenProbe::default() };
        (0..3000).map(|k| 0.01 * f64::from(k)).find(|&angle| {
            let (slide, probe) = sample(angle);
            frozen.update(&P, phase, &Sample { angle, slide, probe }, 0.01)
        })
    }

    #[test]
    fn an_updating_probe_is_not_faulty() {
        assert_eq!(faulty(1e-7, |angle| (0.1, 5e-3 + 1e-6 * angle.sin())), None);
        assert_eq!(faulty(1e-7, |angle| (0.1 + 1e-3 * angle, 5e-3 + 1e-3 * angle)), None);
    }

    #[test]
    fn a_slide_that_moves_or_a_whole_turn_shows_a_frozen_one() {
        let moved = faulty(1e-7, |angle| (0.1 + 1e-3 * angle, 5e-3)).unwrap();
        assert!((moved - 0.2).abs() < 0.02, "{moved} rad");
        let rotation = faulty(1e-7, |_| (0.1, 5e-3)).unwrap();
        assert!((rotation - TAU).abs() < 0.02, "{rotation} rad");
    }

    #[test]
    fn a_last_bit_that_flickers_hides_nothing() {
        let flicker = |angle: f64| 5e-3 + if (100.0 * angle) as i32 % 2 == 0 { 0.0 } else { 5e-8 };
        assert!(faulty(5e-8, |angle| (0.1 + 1e-3 * angle, flicker(angle))).is_some_and(|angle| angle < 0.25));
        let rotation = faulty(5e-8, |angle| (0.1, flicker(angle))).unwrap();
        assert!((rotation - TAU).abs() < 0.03, "{rotation} rad");
    }

    #[test]
    fn in_a_stroke_even_a_coarse_probe_must_answer() {
        let rounded = |x: f64| (x / 5e-6).round() * 5e-6;
        let live = |angle: f64| (0.1 + 1e-3 * angle, 5e-3 + rounded(1e-4 * angle));
        assert_eq!(faulty_in(Phase::Push, 5e-6, live), None);
        let jammed = faulty_in(Phase::Push, 5e-6, |angle| (0.1 + 1e-3 * angle, 5e-3)).unwrap();
        assert!((jammed - 1.0).abs() < 0.02, "{jammed} rad");
        // a millimeter before the pusher it may be at the ring
        assert_eq!(faulty_in(Phase::Push, 5e-6, |angle| (0.1 + 1e-3 * angle, 19.5e-3)), None);
    }

    #[test]
    fn far_from_its_position_even_a_coarse_probe_must_return() {
        let jammed = |probe: f64| faulty_in(Phase::Follow, 5e-6, move |angle| (0.1 + 1e-3 * angle, probe));
        assert!(jammed(0.9e-3).is_some_and(|moved| moved < 1.1) && jammed(8.1e-3).is_some_and(|moved| moved < 1.1));
        // otherwise before the pusher meets the ring
        for probe in [1.1e-3, 4.5e-3] {
            let moved = jammed(probe).unwrap();
            assert!((moved - 7.75).abs() < 0.02, "{moved} mm");
        }
    }

    #[test]
    fn a_coarse_probe_may_read_the_same_for_long() {
        assert!(faulty(1e-7, |_| (0.1, 5e-3)).is_some());
        assert_eq!(faulty(1.1e-7, |_| (0.1, 5e-3)), None);
    }

    #[test]
    fn one_that_keeps_its_value_for_an_eighth_of_a_revolution_is_frozen() {
        for (bit, flicker) in [(1e-7, 1e-7), (1e-9, 5e-7), (5e-6, 7e-6)] {
            let mut frozen = FrozenProbe { bit, ..FrozenProbe::default() };
            for k in 0..300 {
                let moves = 1e-4 * f64::from(k.min(100)) + if k % 2 == 0 { flicker } else { 0.0 };
                frozen.update(&P, Phase::Follow, &Sample { probe: 5e-3 + moves, ..Sample::default() }, 0.01);
                assert_eq!(frozen.tip_frozen(), k > 178, "{bit}: {k}");
            }
        }
    }

    #[test]
    fn exactly_an_eighth_of_a_revolution_is_not_yet_frozen() {
        let mut frozen = FrozenProbe::default();
        let mut tip_frozen = |rotation: f64| {
            frozen.update(&P, Phase::Follow, &Sample { probe: 5e-3, ..Sample::default() }, rotation);
            frozen.tip_frozen()
        };
        assert_eq!([0.0, TAU / 8.0, 1e-9].map(&mut tip_frozen), [false, false, true]);
    }

    #[test]
    fn without_contact_and_at_the_pusher_it_may_rest() {
        for probe in [0.0, P.probe.at_pusher - 3e-5, P.probe.at_pusher + 3e-5] {
            assert_eq!(faulty_in(Phase::Push, 1e-7, |angle| (1e-3 * angle, probe)), None);
        }
        // but not while the slide moves away
        assert!(faulty_in(Phase::Retract, 1e-7, |angle| (-1e-3 * angle, P.probe.at_pusher)).is_some());
    }

    #[test]
    fn one_that_flickers_by_more_than_its_last_bit_moves() {
        // the finest relevant last bit is 0.4 um, the coarsest 13 um, and one and a half of it the band
        for (bit, flicker) in [(1e-9, 7e-7), (1e-3, 2.5e-5), (5e-6, 8e-6)] {
            let mut frozen = FrozenProbe { bit, ..FrozenProbe::default() };
            for k in 0..300 {
                let probe = 5e-3 + if k % 2 == 0 { flicker } else { 0.0 };
                frozen.update(&P, Phase::Follow, &Sample { probe, ..Sample::default() }, 0.01);
                assert!(!frozen.tip_frozen(), "{bit}: {k}");
            }
        }
    }

    #[test]
    fn a_value_constant_for_twenty_samples_is_chance() {
        let faulty = |samples: u32| {
            let mut frozen = FrozenProbe { bit: 1e-7, ..FrozenProbe::default() };
            // 0.1 mm a sample
            let at = |k: u32| Sample { slide: 1e-4 * f64::from(k), probe: 5e-3, ..Sample::default() };
            (0..=samples).map(|k| frozen.update(&P, Phase::Follow, &at(k), 0.0)).last().unwrap()
        };
        assert_eq!([20, 22].map(faulty), [false, true]);
    }

    #[test]
    fn a_ring_at_the_pusher_may_push_the_slide_back_during_its_stroke() {
        let moved = |probe: f64| faulty_in(Phase::Retract, 5e-6, move |angle| (-1e-3 * angle, probe)).unwrap();
        // 5 mm at the pusher, otherwise 1 mm
        assert!((moved(P.probe.at_pusher - 0.9e-4) - 5.0).abs() < 0.03);
        assert!((moved(P.probe.at_pusher - 1.1e-4) - 1.0).abs() < 0.03);
    }

    #[test]
    fn the_last_bit_is_the_smallest_change_that_was_read() {
        let mut frozen = FrozenProbe::default();
        let mut read = |k: u32, slide: f64, probe: f64| {
            let sample = Sample { angle: 0.0, slide, probe };
            (frozen.update(&P, Phase::Follow, &sample, 0.0), k)
        };
        // a probe that shows steps of 0.1 and 0.5 um, and then does not change while the slide moves by 0.2 mm
        for k in 0..40 {
            assert!(!read(k, 0.1, 5e-3 + [0.0, 5e-7, 4e-7, 0.0][k as usize % 4]).0);
        }
        let faulty = (0..1000).map(|k| read(k, 0.1 + 5e-6 * f64::from(k), 5e-3)).find(|read| read.0);
        assert!(matches!(faulty, Some((_, 40..=42))), "{faulty:?}");
    }
}
