//! Checks the inputs of a sample: usable values and their plausibility.

use control_blocks::{Consecutive, Edge, JumpGuard, Reach, is_plausible};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::interface::{Input, Parameters};

/// No such machine has a longer axis, m.
const POSITION_MAX: f64 = 1e3;
/// No such sensor measures more, N.
const FORCE_MAX: f64 = 1e5;
/// Maximum override; larger values are limited.
const OVERRIDE_MAX: f64 = 2.0;

/// Spread of measurements at rest, in steps of the encoders or of the force sensor.
const SPREAD: f64 = 10.0;
/// The same of a sensor of finer steps, in largest deviations of its noise.
const NOISE: f64 = 5.0;

/// The usable inputs: those of this sample, or the last good ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Ball center by the encoders, m.
    pub position: Vector3<f64>,
    /// Raw force on the tool, N.
    pub force: Vector3<f64>,
    /// Factor of the feed, 0 to 2.
    pub feed_override: f64,
    /// Factor of the target force, 0 to 2.
    pub force_override: f64,
    /// `enable` is set.
    pub enabled: bool,
    /// `estop` is set.
    pub stopped: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// `commission` is set.
    pub commission: bool,
    /// Rising edge of `commission`.
    pub begin_commission: bool,
    /// A rising edge of `enable` or `commission` waits for a valid sample.
    pub pending: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// Every measurement is of this sample.
    pub fresh: bool,
    /// What is wrong with the position.
    pub position_doubt: Doubt,
    /// What is wrong with the force.
    pub force_doubt: Doubt,
    /// Consecutive samples with an override that is not a number.
    pub invalid: u32,
}

/// What is wrong with the three measurements of a vector; by default nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Doubt {
    /// Consecutive samples without one of them.
    pub lost: u32,
    /// Consecutive samples without one of them, or with one that is out of reach.
    pub doubted: u32,
}

/// Stores the last valid inputs; at the origin without force before the first sample.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reader {
    overrides: (f64, f64),
    position: [JumpGuard; 3],
    force: [JumpGuard; 3],
    lost: [Consecutive; 2],
    invalid: Consecutive,
    /// `enable` and `commission`, accepted with a valid sample; set before the first, so that nothing moves by itself
    enabled: bool,
    commission: bool,
    reset: Edge,
}

impl Reader {
    /// Before the first sample.
    pub fn new() -> Self {
        Self {
            overrides: (1.0, 1.0),
            position: Default::default(),
            force: Default::default(),
            lost: [Consecutive::NONE; 2],
            invalid: Consecutive::NONE,
            enabled: true,
            commission: true,
            reset: Edge::default(),
        }
    }

    /// Accepts the next sample at any position, as outside a cycle the machine may be moved; with `enable` or
    /// `commission`, which may start a motion, only after too many implausible samples.
    pub fn rest(&mut self, p: &Parameters, input: &Input) {
        let doubted = doubted(&self.position).max(doubted(&self.force));
        if !(input.enable || input.commission) || doubted > p.limits.lost_samples.unsigned_abs() {
            (self.position, self.force) = Default::default();
        }
    }

    /// Reads one sample, in which the tool presses at most by `growth` N more.
    pub fn read(&mut self, p: &Parameters, input: &Input, growth: f64) -> Reading {
        let noise = (SPREAD * p.sensor_resolution).max(NOISE * p.limits.force_noise);
        let force = Reach { motion: growth, spread: noise };
        let position = Reach { motion: p.velocity_max * p.sample_period, spread: SPREAD * p.encoder_resolution };
        let (x, f) = (input.position.vector(), input.force.vector());
        let missing = [x.map(|x| !is_plausible(x, POSITION_MAX)), f.map(|f| !is_plausible(f, FORCE_MAX))];
        let lost = [0, 1].map(|i| self.lost[i].update(missing[i].iter().any(|missing| *missing)));
        let reading = Reading {
            position: believe(&mut self.position, &x, missing[0], position),
            force: believe(&mut self.force, &f, missing[1], force),
            enabled: input.enable,
            stopped: input.estop,
            start: input.enable && !self.enabled,
            commission: input.commission,
            begin_commission: input.commission && !self.commission,
            pending: false,
            reset: self.reset.rises(input.reset_fault),
            fresh: false,
            position_doubt: Doubt { lost: lost[0], doubted: doubted(&self.position) },
            force_doubt: Doubt { lost: lost[1], doubted: doubted(&self.force) },
            invalid: self.read_overrides(input),
            feed_override: self.overrides.0,
            force_override: self.overrides.1,
        };
        let fresh = [reading.position_doubt, reading.force_doubt] == [Doubt::default(); 2];
        let Reading { start, begin_commission, .. } = reading;
        // an edge waits for the first valid sample; a low input needs none, as it starts nothing
        self.enabled = input.enable && (self.enabled || fresh);
        self.commission = input.commission && (self.commission || fresh);
        let pending = !fresh && (start || begin_commission);
        Reading { fresh, start: fresh && start, begin_commission: fresh && begin_commission, pending, ..reading }
    }

    /// Stores the overrides; returns the consecutive invalid samples.
    fn read_overrides(&mut self, input: &Input) -> u32 {
        let valid = input.feed_override.is_finite() && input.force_override.is_finite();
        if valid {
            let usable = |value: f64| value.clamp(0.0, OVERRIDE_MAX);
            self.overrides = (usable(input.feed_override), usable(input.force_override));
        }
        self.invalid.update(!valid)
    }
}

/// Consecutive samples in which a measurement was implausible.
fn doubted(guards: &[JumpGuard; 3]) -> u32 {
    guards.iter().map(JumpGuard::doubted).max().unwrap_or_default()
}

/// The usable measurements: the last accepted one where the present one is missing or out of reach.
fn believe(guards: &mut [JumpGuard; 3], readings: &Vector3<f64>, missing: Vector3<bool>, reach: Reach) -> Vector3<f64> {
    let usable = readings.zip_map(&missing, |reading, missing| if missing { f64::NAN } else { reading });
    Vector3::from_fn(|i, _| guards[i].update(usable[i], reach))
}

impl Default for Reader {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axes::Axes;
    use control_blocks::with_nonsense;

    const P: Parameters = Parameters::START;
    /// 178 N/mm at the fastest, N.
    const GROWTH: f64 = 178e3 * 50e-6;

    fn resting() -> Input {
        Input { position: Axes::all(1e-3), force: Axes::all(2.0), feed_override: 0.5, ..Input::START }
    }

    #[test]
    fn nonsense_in_any_input_is_counted_and_never_used() {
        let changes: [fn(&mut Input) -> &mut f64; 5] = [
            |i| &mut i.position.x,
            |i| &mut i.position.z,
            |i| &mut i.force.y,
            |i| &mut i.feed_override,
            |i| &mut i.force_override,
        ];
        for bad in with_nonsense(&resting(), &changes) {
            let mut reader = Reader::new();
            let before = reader.read(&P, &resting(), GROWTH);
            assert!(before.fresh && before.invalid == 0);
            for k in 1..4 {
                let now = reader.read(&P, &bad, GROWTH);
                assert_eq!((now.position, now.force), (before.position, before.force));
                assert_eq!((now.feed_override, now.force_override), (0.5, 1.0));
                assert_eq!(now.position_doubt.lost + now.force_doubt.lost + now.invalid, k);
            }
            assert!(reader.read(&P, &resting(), GROWTH).fresh);
        }
    }

    #[test]
    fn one_spike_is_not_used() {
        for (position, force) in [(0.2e-3, 0.0), (0.0, -30.0), (0.0, 12.0), (-5e-3, 0.0)] {
            let mut reader = Reader::new();
            let before = reader.read(&P, &resting(), GROWTH);
            let mut spike = resting();
            spike.position.y += position;
            spike.force.z += force;
            let now = reader.read(&P, &spike, GROWTH);
            assert_eq!((now.position, now.force), (before.position, before.force));
            let moved = u32::from(position != 0.0);
            assert_eq!([now.position_doubt, now.force_doubt].map(|doubt| doubt.doubted), [moved, 1 - moved]);
            assert!(!now.fresh && reader.read(&P, &resting(), GROWTH).fresh);
        }
    }

    #[test]
    fn the_fastest_machine_is_accepted() {
        let mut reader = Reader::new();
        for k in 0..200 {
            let mut input = resting();
            input.position.z -= 50e-6 * f64::from(k);
            input.force.z += GROWTH * f64::from(k);
            assert!(reader.read(&P, &input, GROWTH).fresh);
        }
    }

    #[test]
    fn a_force_that_has_grown_faster_than_the_tool_presses_is_not_accepted() {
        // ten steps of 0.178 N, or five times 0.35 N of noise
        for (step, spread) in [(0.178, 1.78), (0.4, 4.0), (0.01, 1.75)] {
            let p = Parameters { sensor_resolution: step, ..P };
            for (grown, fresh) in [(0.999 * (spread + 0.2), true), (1.001 * (spread + 0.2), false)] {
                let mut reader = Reader::new();
                reader.read(&p, &resting(), 0.2);
                let mut input = resting();
                input.force.z += grown;
                assert_eq!(reader.read(&p, &input, 0.2).fresh, fresh, "{step}: {grown}");
            }
        }
    }

    #[test]
    fn overrides_are_limited_and_switches_are_edges() {
        let mut reader = Reader::new();
        let input = Input { feed_override: 7.0, force_override: -1.0, ..Input::START };
        reader.read(&P, &input, GROWTH);
        let on = Input { enable: true, ..input };
        let first = reader.read(&P, &on, GROWTH);
        assert_eq!((first.feed_override, first.force_override, first.start), (2.0, 0.0, true));
        assert!(!reader.read(&P, &on, GROWTH).start);
    }

    #[test]
    fn a_bad_sample_with_the_edge_is_not_accepted_and_what_stays_is() {
        let (off, on) = (resting(), Input { enable: true, ..resting() });
        let mut moved = on.clone();
        (moved.force.z, moved.position.x) = (30.0, 0.1);
        let mut reader = Reader::new();
        let mut read = |input: &Input| {
            reader.rest(&P, input);
            reader.read(&P, input, GROWTH)
        };
        read(&off);
        let edge = read(&moved);
        assert_eq!((edge.force, edge.fresh, edge.start), (Vector3::from_element(2.0), false, false));
        assert!(read(&on).start);
        // moved by hand with `enable`, and without
        assert!((0..10).any(|_| read(&moved).fresh));
        assert!(read(&off).fresh && read(&Input { enable: false, ..moved.clone() }).fresh);
    }

    #[test]
    fn at_rest_a_position_is_doubted_for_as_many_samples_as_may_be_lost() {
        let mut reader = Reader::new();
        let on = Input { enable: true, ..resting() };
        reader.read(&P, &on, GROWTH);
        let mut moved = on;
        moved.position.x = 0.1;
        let doubts = (0..20).take_while(|_| {
            reader.rest(&P, &moved);
            !reader.read(&P, &moved, GROWTH).fresh
        });
        // one more than that is a fault during a motion
        assert_eq!(doubts.count(), P.limits.lost_samples as usize + 1);
    }

    #[test]
    fn an_edge_before_the_first_valid_sample_waits_for_it() {
        let (on, never) = (Input { enable: true, commission: true, ..resting() }, resting());
        for lose in [|i: &mut Input| i.force.x = f64::NAN, |i: &mut Input| i.position.y = f64::INFINITY] {
            let mut reader = Reader::new();
            let mut read = |input: &Input, lost: bool| {
                let mut input = input.clone();
                if lost {
                    lose(&mut input);
                }
                reader.rest(&P, &input);
                reader.read(&P, &input, GROWTH)
            };
            assert!((0..20).all(|_| !read(&never, true).pending));
            assert!((0..20).map(|_| read(&on, true)).all(|now| now.pending && !now.start && !now.begin_commission));
            let first = read(&on, false);
            assert!(first.start && first.begin_commission && !first.pending);
            // also an edge between two bad samples
            assert!(!read(&on, true).pending && !read(&never, true).pending && read(&on, true).pending);
            assert!(read(&on, false).start && !read(&on, false).start);
        }
    }

    #[test]
    fn an_enable_or_a_commission_that_was_never_off_starts_nothing() {
        let mut reader = Reader::new();
        let on = Input { enable: true, commission: true, ..Input::START };
        assert!((0..10).map(|_| reader.read(&P, &on, GROWTH)).all(|now| !now.start && !now.begin_commission));
    }

    #[test]
    fn a_commission_is_an_edge_of_a_good_sample() {
        let mut reader = Reader::new();
        reader.read(&P, &resting(), GROWTH);
        let on = Input { commission: true, ..resting() };
        let lost = Input { force: Axes::all(f64::NAN), ..on.clone() };
        assert!(!reader.read(&P, &lost, GROWTH).begin_commission);
        assert!(reader.read(&P, &on, GROWTH).begin_commission);
        let after = reader.read(&P, &on, GROWTH);
        assert!(after.commission && !after.begin_commission);
    }
}
