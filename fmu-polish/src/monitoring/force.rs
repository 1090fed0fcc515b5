//! The force reading held against the motion and against itself: does it live, is it noise, does the loop hold it?
//!
//! At rest and on the approach nothing moves the force but its noise, so a reading that stands to the bit for
//! `limits.still_time` is not alive. In contact it must answer the way into the mold: a short mean of the
//! reading is anchored ([`Frozen`]), and a depth that has changed by more than the surface can have changed since, a way w along the path
//! times `limits.surface_slope`, without that the force has left a band of one and a half steps, was not felt.
//!
//! A tip that is soft across its axis, z, follows a circle where the ball sticks. On a steep part of the mold the circle, square to the normal, goes up
//! and down along z, and the cancellation of the ripple takes that back: what is left across z counts as depth, but the tip only bends. So with
//! a circle no answer is missed but to what both the depth and its part along z say.
//!
//! The noise is told by the second difference, which slow signals do not reach: white noise of the deviation s has
//! d = f(k) - 2 f(k-1) + f(k-2) with the variance 6 s^2.

use control_blocks::{Frozen, ticks};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::axis::BAND;
use super::swings::Swings;
use crate::force::contact::Measurement;
use crate::interface::{Fault, Parameters, State, Sweep};

/// Share of the normal from which on an axis carries the force.
const CARRIES: f64 = 0.5;
/// Memory of the noise, s.
const NOISE_TIME: f64 = 0.1;
/// Variance of the second difference over that of the noise.
const DIFFERENCES: f64 = 6.0;
/// A difference counts as no more than this, in deviations: one spike is no noise.
const CLIP: f64 = 4.0;
/// Memory of the answer to the depth, s: 5 um at `approach.velocity`.
const ANSWER_TIME: f64 = 0.01;
/// Memory of the force error, s.
const ERROR_TIME: f64 = 0.2;
/// Force error of the wanted force where `limits.force_error` is 0.
const ERROR_SHARE: f64 = 0.2;
/// The most that one sample counts, over the largest force error.
const ERROR_CLIP: f64 = 2.0;

/// What is known of the force; by default nothing.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ForceMonitor {
    /// each raw axis, to the bit
    still: [Frozen; 3],
    /// the short mean of each raw axis against the depth
    answers: [Answer; 3],
    /// depth along the normal and along the axis of the tip, m
    depth: Option<[f64; 2]>,
    /// the last two forces along the normal, N
    last: Option<(f64, f64)>,
    /// variance of the noise, N2
    noise: f64,
    /// mean square of the force error, N2
    error: f64,
    swings: Swings,
}

/// One axis of the force against the depth: its short mean, as noise alone leaves the band in the end.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Answer {
    /// N
    mean: Option<f64>,
    /// N
    frozen: Frozen,
    /// what the way along the axis of the tip makes of it since the anchor, N
    along: f64,
    /// way along the path since the anchor, m
    way: f64,
}

/// One sample of the force.
#[derive(Clone, Copy, Debug)]
pub struct ForceSample<'a> {
    /// State of the last sample.
    pub state: State,
    /// Raw force, N.
    pub raw: &'a Vector3<f64>,
    /// What it says.
    pub now: &'a Measurement,
    /// The normal as the sensor shows it.
    pub normal: &'a Vector3<f64>,
    /// Stiffness in use, N/m.
    pub stiffness: f64,
    /// Way along the path in this sample, m.
    pub way: f64,
}

impl ForceMonitor {
    /// Forgets what was before a job, but for how long a reading stands: a sensor needs no job to be alive.
    pub fn restart(&mut self) {
        *self = Self { still: self.still, ..Self::default() };
    }

    /// Takes one sample.
    pub fn update(&mut self, p: &Parameters, sample: &ForceSample) {
        for (still, raw) in self.still.iter_mut().zip(sample.raw.iter()) {
            still.update(*raw, 0.0, 0.0);
        }
        self.update_noise(p, sample.raw.dot(sample.normal));
        self.update_answer(p, sample);
        self.update_error(p, sample);
    }

    fn update_error(&mut self, p: &Parameters, sample: &ForceSample) {
        if sample.state != State::Follow {
            (self.error, self.swings) = Default::default();
            return;
        }
        let (error, limit) = (sample.now.force_error, error_limit(p));
        self.swings.update(p, error, limit);
        // in the air there is nothing to control
        if sample.now.force.controlled >= p.limits.lost_force {
            // a moment beyond all measure is a matter of the largest force
            let square = error.abs().min(ERROR_CLIP * limit).powi(2);
            self.error += memory(p, ERROR_TIME) * (square - self.error);
        }
    }

    fn update_noise(&mut self, p: &Parameters, force: f64) {
        if let Some((one, two)) = self.last {
            let most = DIFFERENCES * (CLIP * p.limits.force_noise).powi(2);
            let difference = (force - 2.0 * one + two).powi(2).min(most);
            self.noise += memory(p, NOISE_TIME) * (difference / DIFFERENCES - self.noise);
        }
        self.last = Some((force, self.last.map_or(force, |(one, _)| one)));
    }

    fn update_answer(&mut self, p: &Parameters, sample: &ForceSample) {
        let depth = [sample.now.error.normal, sample.now.offset.z];
        let last = self.depth.replace(depth).unwrap_or(depth);
        let [moved, along] = [0, 1].map(|i| depth[i] - last[i]);
        // no force, no answer: that is a matter of the contact
        if !sample.state.pressing() || sample.now.force.controlled < p.limits.lost_force {
            self.answers = Default::default();
            return;
        }
        let normal = sample.normal;
        for ((answer, raw), share) in self.answers.iter_mut().zip(sample.raw.iter()).zip(normal.iter()) {
            answer.way += sample.way;
            let before = answer.mean.unwrap_or(*raw);
            let mean = before + memory(p, ANSWER_TIME) * (raw - before);
            answer.mean = Some(mean);
            answer.frozen.update(mean, sample.stiffness * moved * share, BAND * p.sensor_resolution);
            answer.along += sample.stiffness * along * share;
            if answer.frozen.still() == 0 {
                (answer.along, answer.way) = (0.0, 0.0);
            }
        }
    }

    /// What is wrong with the reading while a job is on.
    pub fn reading_fault(&self, p: &Parameters, sample: &ForceSample) -> Option<Fault> {
        let end = p.sensor_range - 0.5 * p.sensor_resolution;
        let faults = [
            (Fault::Saturation, sample.raw.amax() >= end),
            (Fault::FrozenForce, self.stands(p, sample.normal) || self.unanswered(p, sample)),
            (Fault::NoisyForce, self.noise() > p.limits.force_noise),
        ];
        faults.into_iter().find_map(|(fault, holds)| holds.then_some(fault))
    }

    /// What is wrong with the loop.
    pub fn loop_fault(&self, p: &Parameters) -> Option<Fault> {
        let cause = if self.swings.many() { Fault::Oscillation } else { Fault::ForceError };
        let [error, limit] = self.error(p);
        (error > limit).then_some(cause)
    }

    /// Standard deviation of the noise, N.
    pub fn noise(&self) -> f64 {
        self.noise.sqrt()
    }

    /// Force error, root mean square, and its limit, N.
    pub fn error(&self, p: &Parameters) -> [f64; 2] {
        [self.error.sqrt(), error_limit(p)]
    }

    fn stands(&self, p: &Parameters, normal: &Vector3<f64>) -> bool {
        let longest = ticks(p.limits.still_time, p.sample_period);
        let carries = |(still, share): (&Frozen, &f64)| share.abs() > CARRIES && still.still() >= longest;
        longest > 0 && self.still.iter().zip(normal.iter()).any(carries)
    }

    fn unanswered(&self, p: &Parameters, sample: &ForceSample) -> bool {
        let felt = |answer: &Answer, share: f64| {
            let depth = p.limits.frozen_way + p.limits.surface_slope * answer.way;
            let unanswered = match p.stick_slip.sweep {
                Sweep::Linear => answer.frozen.unanswered(),
                Sweep::Circular => answer.frozen.unanswered().min(answer.along.abs()),
            };
            unanswered <= BAND * p.sensor_resolution + sample.stiffness * depth * share.abs()
        };
        self.answers
            .iter()
            .zip(sample.normal.iter())
            .any(|(answer, share)| share.abs() > CARRIES && !felt(answer, *share))
    }
}

/// Largest force error, root mean square, N.
fn error_limit(p: &Parameters) -> f64 {
    match p.limits.force_error {
        0.0 => ERROR_SHARE * p.force.target,
        limit => limit,
    }
}

/// Share of a new sample in a mean over `time` s.
fn memory(p: &Parameters, time: f64) -> f64 {
    -(-p.sample_period / time).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::sensor::MeasuredForce;
    use crate::interface::{ErrorOutput, StickSlip};
    use crate::path::centre_path::Frame;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const P: Parameters = Parameters::START;

    /// Shows `monitor` the force `force` (N) along the normal in `state`: what is wrong with the reading.
    fn show(monitor: &mut ForceMonitor, p: &Parameters, state: State, force: f64) -> Option<Fault> {
        let (zero, normal) = (Vector3::zeros(), Vector3::z());
        let frame = Frame { centre: zero, contact: zero, normal, tangent: Vector3::x(), ratio: 1.0, feed_max: 1.0 };
        let error = ErrorOutput { tangential: 0.0, lateral: 0.0, normal: 0.0 };
        let raw = force * normal;
        let measured = MeasuredForce { vector: raw, unfiltered: raw, norm: force, normal: force, controlled: force };
        let force_error = p.force.target - force;
        let now = Measurement { frame, force: measured, force_error, offset: zero, error, surface: 0.0 };
        let sample = ForceSample { state, raw: &raw, now: &now, normal: &normal, stiffness: 178e3, way: 0.0 };
        monitor.update(p, &sample);
        monitor.reading_fault(p, &sample)
    }

    /// What is wrong with the readings `forces` (N) along the normal, and the noise (N) that they have.
    fn told(p: &Parameters, forces: impl Iterator<Item = f64>) -> (Option<Fault>, f64) {
        let (mut monitor, mut fault) = (ForceMonitor::default(), None);
        for force in forces {
            fault = fault.or(show(&mut monitor, p, State::Approach, force));
        }
        (fault, monitor.noise())
    }

    /// What is wrong on a path that is steep by 0.13, where the force keeps within its band for 0.1 s while the axes go round with
    /// `radius` m, without z, and sink by `sunk` m.
    fn round(sweep: Sweep, radius: f64, sunk: f64) -> Option<Fault> {
        let p = Parameters { stick_slip: StickSlip { sweep, ..P.stick_slip }, ..P };
        let (zero, normal) = (Vector3::zeros(), Vector3::new(0.13, 0.0, 1.0).normalize());
        let frame = Frame { centre: zero, contact: zero, normal, tangent: Vector3::y(), ratio: 1.0, feed_max: 1.0 };
        let (mut monitor, mut fault) = (ForceMonitor::default(), None);
        for k in 0..100 {
            let angle = std::f64::consts::TAU * f64::from(k) / 20.0;
            let offset = Vector3::new(radius * angle.cos(), radius * angle.sin(), sunk * f64::from(k) / 100.0);
            let raw = normal * (5.0 + 0.05 * angle.sin());
            let force = MeasuredForce { vector: raw, unfiltered: raw, norm: 5.0, normal: 5.0, controlled: 5.0 };
            let now = Measurement { frame, force, force_error: 0.0, offset, error: frame.error(&offset), surface: 0.0 };
            let state = State::Follow;
            let sample = ForceSample { state, raw: &raw, now: &now, normal: &normal, stiffness: 178e3, way: 0.0 };
            monitor.update(&p, &sample);
            fault = fault.or(monitor.reading_fault(&p, &sample));
        }
        fault
    }

    #[test]
    fn a_circle_that_only_bends_the_tip_needs_no_answer_but_the_way_along_it_does() {
        // 26 um of depth, without a way along z
        assert_eq!(round(Sweep::Circular, 100e-6, 0.0), None);
        for radius in [0.0, 50e-6, 100e-6] {
            assert_eq!(round(Sweep::Circular, radius, 50e-6), Some(Fault::FrozenForce), "{radius}");
        }
        assert_eq!(round(Sweep::Linear, 100e-6, 0.0), Some(Fault::FrozenForce));
    }

    #[test]
    fn only_the_last_step_of_the_sensor_is_its_end() {
        let at = |force: f64| told(&P, std::iter::once(force)).0;
        assert_eq!(at(P.sensor_range), Some(Fault::Saturation));
        assert_eq!(at(-P.sensor_range), Some(Fault::Saturation));
        assert_eq!(at(P.sensor_range - P.sensor_resolution), None);
    }

    #[test]
    fn noise_is_told_as_its_deviation_whatever_force_it_lies_on() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        let sigma = 0.5 * P.limits.force_noise;
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut noisy = |slope: f64| told(&P, (0..2000).map(|k| slope * f64::from(k) + sigma * normal())).1;
        // in 100 ms there are 100 samples, a third of them independent
        for slope in [0.0, 1e-3] {
            let found = noisy(slope);
            assert!((found / sigma - 1.0).abs() < 0.3, "{slope}: {found} of {sigma}");
        }
    }

    #[test]
    fn a_force_that_stands_is_frozen_only_where_that_is_watched() {
        let mut p = P;
        let standing = |p: &Parameters| told(p, std::iter::repeat_n(1.0, 5000)).0;
        assert_eq!(standing(&p), Some(Fault::FrozenForce));
        p.limits.still_time = 0.0;
        assert_eq!(standing(&p), None);
    }

    #[test]
    fn a_moment_counts_no_more_than_twice_the_largest_error_whatever_that_is() {
        for limit in [0.25, 0.5, 1.0, 4.0] {
            let mut p = P;
            p.limits.force_error = limit;
            // at twice the limit the mean square is the limit's after ERROR_TIME ln (4 / 3)
            let after = |time: f64| {
                let mut monitor = ForceMonitor::default();
                (0..ticks(time, p.sample_period)).for_each(|_| {
                    show(&mut monitor, &p, State::Follow, p.force.target + 20.0);
                });
                monitor.loop_fault(&p)
            };
            let time = ERROR_TIME * (4.0f64 / 3.0).ln();
            assert_eq!(after(0.9 * time), None, "{limit}");
            assert_eq!(after(1.1 * time), Some(Fault::ForceError), "{limit}");
        }
    }
}
