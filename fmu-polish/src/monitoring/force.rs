//! Compares the force with the motion and with its own past: frozen signals, noise, and the error of the loop.
//!
//! At rest and during the approach only noise changes the force, so a signal that is identical for
//! `expert.limits.frozen_time` is frozen. In contact the force must respond to the travel into the mold. A short mean
//! of the force is an anchor ([`Frozen`]). Let the tool move w along the path. The surface explains a change of depth
//! of w times `limits.surface_slope`. If the depth changes by more and the force stays within a band of one and a half
//! steps, the force did not respond. The noise of the encoders is subtracted from the depth.
//!
//! A tip that is soft across its axis, z, follows a wide sweep where the ball sticks. On a steep part of the mold the
//! sweep, orthogonal to the normal, moves up and down along z, and the ripple cancellation corrects that. The rest
//! across z looks like depth, but the tip only bends. So with a circle, and with an increased half period, both the
//! depth and its component along z must lack a response.

use control_blocks::{Frozen, ticks};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::axis::BAND;
use super::noise::{Noise, memory};
use super::oscillation::Oscillations;
use crate::force::contact::Measurement;
use crate::interface::{Fault, Parameters, State};
use crate::motion::stick_slip::bends;

/// Fraction of the normal from which on an axis carries the force.
const CARRIES: f64 = 0.5;
/// Noise of a depth beyond the step of the encoders that is no way, in deviations: the farthest two of 10,000 samples
/// are 7.7 apart.
const NOISES: f64 = 8.0;
/// Memory of the answer to the depth, s: 5 um at `approach.velocity`.
const ANSWER_TIME: f64 = 0.01;
/// Memory of the force error, s.
const ERROR_TIME: f64 = 0.2;
/// Force error of the target force where `limits.force_error` is 0.
const ERROR_RATIO: f64 = 0.2;
/// The most that one sample counts, over the largest force error.
const ERROR_CLIP: f64 = 2.0;

/// Monitor of the force signal and of the force loop; by default nothing is measured.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ForceMonitor {
    /// each raw axis, to the bit
    still: [Frozen; 3],
    /// the short mean of each raw axis against the depth
    answers: [Answer; 3],
    /// depth along the normal and along the axis of the tip, m
    depth: Option<[f64; 2]>,
    /// of the depth along the normal, m
    depth_noise: Noise,
    /// of the force along the normal, N
    noise: Noise,
    /// mean square of the force error, N2
    error: f64,
    oscillations: Oscillations,
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
    distance: f64,
}

/// One sample of the force.
#[derive(Clone, Copy, Debug)]
pub struct ForceSample<'a> {
    /// State of the last sample.
    pub state: State,
    /// Raw force, N.
    pub raw: &'a Vector3<f64>,
    /// Path, force and errors of the sample.
    pub now: &'a Measurement,
    /// The normal as the sensor shows it.
    pub normal: &'a Vector3<f64>,
    /// Stiffness in use, N/m.
    pub stiffness: f64,
    /// Travel along the path in this sample, m.
    pub distance: f64,
}

impl ForceMonitor {
    /// Discards the previous cycle, except the time without a change: a valid sensor has noise outside a cycle too.
    pub fn restart(&mut self) {
        *self = Self { still: self.still, ..Self::default() };
    }

    /// Takes one sample.
    pub fn update(&mut self, p: &Parameters, sample: &ForceSample) {
        for (still, raw) in self.still.iter_mut().zip(sample.raw.iter()) {
            still.update(*raw, 0.0, 0.0);
        }
        self.noise.update(p, sample.raw.dot(sample.normal), p.limits.force_noise);
        self.depth_noise.update(p, sample.now.error.normal, p.limits.frozen);
        self.update_answer(p, sample);
        self.update_error(p, sample);
    }

    fn update_error(&mut self, p: &Parameters, sample: &ForceSample) {
        if sample.state != State::Follow {
            (self.error, self.oscillations) = Default::default();
            return;
        }
        let (error, limit) = (sample.now.force_error, error_limit(p));
        self.oscillations.update(p, error, limit);
        // in the air there is nothing to control
        if sample.now.force.controlled >= p.limits.lost_force {
            // a moment beyond all measure is a matter of the largest force
            let square = error.abs().min(ERROR_CLIP * limit).powi(2);
            self.error += memory(p, ERROR_TIME) * (square - self.error);
        }
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
        for ((answer, raw), ratio) in self.answers.iter_mut().zip(sample.raw.iter()).zip(normal.iter()) {
            answer.distance += sample.distance;
            let before = answer.mean.unwrap_or(*raw);
            let mean = before + memory(p, ANSWER_TIME) * (raw - before);
            answer.mean = Some(mean);
            answer.frozen.update(mean, sample.stiffness * moved * ratio, BAND * p.sensor_resolution);
            answer.along += sample.stiffness * along * ratio;
            if answer.frozen.still() == 0 {
                (answer.along, answer.distance) = (0.0, 0.0);
            }
        }
    }

    /// The fault of the signal during a cycle.
    pub fn reading_fault(&self, p: &Parameters, sample: &ForceSample) -> Option<Fault> {
        let end = p.sensor_range - 0.5 * p.sensor_resolution;
        let faults = [
            (Fault::Saturation, sample.raw.amax() >= end),
            (Fault::ForceFrozen, self.frozen_normal(p, sample.normal) || self.unanswered(p, sample)),
            (Fault::NoisyForce, self.noise() > p.limits.force_noise),
        ];
        faults.into_iter().find_map(|(fault, holds)| holds.then_some(fault))
    }

    /// Fault of the force loop: an oscillation or a force error; none while the rms force error is within its limit.
    pub fn loop_fault(&self, p: &Parameters) -> Option<Fault> {
        let cause = if self.oscillations.many() { Fault::Oscillation } else { Fault::ForceError };
        let [error, limit] = self.error(p);
        (error > limit).then_some(cause)
    }

    /// Standard deviation of the noise, N.
    pub fn noise(&self) -> f64 {
        self.noise.deviation()
    }

    /// Force error, root mean square, and its limit, N.
    pub fn error(&self, p: &Parameters) -> [f64; 2] {
        [self.error.sqrt(), error_limit(p)]
    }

    fn frozen_normal(&self, p: &Parameters, normal: &Vector3<f64>) -> bool {
        let longest = ticks(p.limits.frozen_time, p.sample_period);
        let carries = |(still, ratio): (&Frozen, &f64)| ratio.abs() > CARRIES && still.still() >= longest;
        longest > 0 && self.still.iter().zip(normal.iter()).any(carries)
    }

    fn unanswered(&self, p: &Parameters, sample: &ForceSample) -> bool {
        let noise = NOISES * (self.depth_noise.deviation() - p.encoder_resolution).max(0.0);
        let sensed = |answer: &Answer, ratio: f64| {
            let depth = p.limits.frozen + p.limits.surface_slope * answer.distance + noise;
            let unanswered = if bends(&p.stick_slip) {
                answer.frozen.unanswered().min(answer.along.abs())
            } else {
                answer.frozen.unanswered()
            };
            unanswered <= BAND * p.sensor_resolution + sample.stiffness * depth * ratio.abs()
        };
        self.answers
            .iter()
            .zip(sample.normal.iter())
            .any(|(answer, ratio)| ratio.abs() > CARRIES && !sensed(answer, *ratio))
    }
}

/// Largest force error, root mean square, N.
fn error_limit(p: &Parameters) -> f64 {
    match p.limits.force_error {
        0.0 => ERROR_RATIO * p.force.target,
        limit => limit,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::sensor::MeasuredForce;
    use crate::interface::{ErrorOutput, Mode, StickSlip};
    use crate::path::centre_path::Frame;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const P: Parameters = Parameters::START;

    /// Updates `monitor` with the force `force` (N) along the normal in `state`; returns the fault of the measurement.
    fn show(monitor: &mut ForceMonitor, p: &Parameters, state: State, force: f64) -> Option<Fault> {
        let (zero, normal) = (Vector3::zeros(), Vector3::z());
        let frame = Frame { centre: zero, contact: zero, normal, tangent: Vector3::x(), ratio: 1.0, feed_max: 1.0 };
        let error = ErrorOutput { tangential: 0.0, lateral: 0.0, normal: 0.0 };
        let raw = force * normal;
        let measured = MeasuredForce { vector: raw, unfiltered: raw, norm: force, normal: force, controlled: force };
        let force_error = p.force.target - force;
        let now = Measurement { frame, force: measured, force_error, offset: zero, error, surface: 0.0 };
        let sample = ForceSample { state, raw: &raw, now: &now, normal: &normal, stiffness: 178e3, distance: 0.0 };
        monitor.update(p, &sample);
        monitor.reading_fault(p, &sample)
    }

    /// First fault of the measurements `forces` (N) along the normal during an approach.
    fn fault_of(p: &Parameters, forces: impl Iterator<Item = f64>) -> Option<Fault> {
        let mut monitor = ForceMonitor::default();
        forces.fold(None, |fault, force| fault.or(show(&mut monitor, p, State::Approach, force)))
    }

    /// A force that keeps within its band on a path along y that is steep by `slope`, wherever the tool goes.
    struct Evaluation {
        p: Parameters,
        normal: Vector3<f64>,
        state: State,
        monitor: ForceMonitor,
        samples: u32,
        fault: Option<Fault>,
    }

    impl Evaluation {
        fn new(sweep: Mode, slope: f64) -> Self {
            let p = Parameters { stick_slip: StickSlip { mode: sweep, ..P.stick_slip }, ..P };
            let normal = Vector3::new(slope, 0.0, 1.0).normalize();
            let (state, monitor) = (State::Follow, ForceMonitor::default());
            Self { p, normal, state, monitor, samples: 0, fault: None }
        }

        /// Takes a sample `offset` m off the path.
        fn show(mut self, offset: Vector3<f64>) -> Self {
            let (zero, normal) = (Vector3::zeros(), self.normal);
            let frame = Frame { centre: zero, contact: zero, normal, tangent: Vector3::y(), ratio: 1.0, feed_max: 1.0 };
            let raw = normal * (5.0 + 0.05 * (0.3 * f64::from(self.samples)).sin());
            let force = MeasuredForce { vector: raw, unfiltered: raw, norm: 5.0, normal: 5.0, controlled: 5.0 };
            let now = Measurement { frame, force, force_error: 0.0, offset, error: frame.error(&offset), surface: 0.0 };
            let state = self.state;
            let sample = ForceSample { state, raw: &raw, now: &now, normal: &normal, stiffness: 178e3, distance: 0.0 };
            self.monitor.update(&self.p, &sample);
            self.fault = self.fault.or(self.monitor.reading_fault(&self.p, &sample));
            self.samples += 1;
            self
        }
    }

    /// First fault of `evaluation` while the axes move for 0.1 s on a circle of the radius `radius` m in the xy plane,
    /// and sink by `sunk` m along z.
    fn round(evaluation: Evaluation, radius: f64, sunk: f64) -> Option<Fault> {
        let offset = |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k) / 20.0;
            Vector3::new(radius * angle.cos(), radius * angle.sin(), sunk * f64::from(k) / 100.0)
        };
        (0..100).map(offset).fold(evaluation, Evaluation::show).fault
    }

    #[test]
    fn a_wide_sweep_that_only_bends_the_tip_needs_no_answer_but_the_way_along_it_does() {
        let evaluation = |sweep: Mode, half_period: i32, half_period_max: i32| {
            let mut evaluation = Evaluation::new(sweep, 0.13);
            evaluation.p.stick_slip = StickSlip { half_period, half_period_max, ..evaluation.p.stick_slip };
            evaluation
        };
        for (sweep, half, longest) in [(Mode::Circular, 10, 0), (Mode::Circular, 10, 20), (Mode::Cross, 20, 20)] {
            // 26 um of depth, without travel along z
            assert_eq!(round(evaluation(sweep, half, longest), 100e-6, 0.0), None);
            for radius in [0.0, 50e-6, 100e-6] {
                let fault = round(evaluation(sweep, half, longest), radius, 50e-6);
                assert_eq!(fault, Some(Fault::ForceFrozen), "{sweep:?} {half} {radius}");
            }
        }
        for (half, longest) in [(10, 0), (10, 20), (20, 0)] {
            let fault = round(evaluation(Mode::Cross, half, longest), 100e-6, 0.0);
            assert_eq!(fault, Some(Fault::ForceFrozen), "{half} {longest}");
        }
    }

    /// The fault with 10 um of encoder noise, during the descent and for 4 s in which the force stays within its band
    /// and the tool sinks by `sunk` m.
    fn noisy(sweep: Mode, sunk: f64) -> Option<Fault> {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(8);
        let mut depth = |depth: f64| -> Vector3<f64> {
            let noise: f64 = StandardNormal.sample(&mut random);
            Vector3::z() * (depth + 10e-6 * noise)
        };
        let evaluation = Evaluation { state: State::Approach, ..Evaluation::new(sweep, 0.0) };
        let above = (0..300).map(|_| depth(0.0)).fold(evaluation, Evaluation::show);
        let pressing = Evaluation { state: State::Follow, ..above };
        (0..4000).map(|k| depth(sunk * f64::from(k) / 4e3)).fold(pressing, Evaluation::show).fault
    }

    #[test]
    fn noise_of_the_encoders_is_no_way_and_hides_none() {
        for sweep in [Mode::Cross, Mode::Circular] {
            assert_eq!([0.0, 150e-6].map(|sunk| noisy(sweep, sunk)), [None, Some(Fault::ForceFrozen)], "{sweep:?}");
        }
    }

    #[test]
    fn the_last_bit_of_an_encoder_is_no_noise_that_a_way_may_hide_in() {
        // 21.5 um may be unanswered, and noise of 0.8 steps would allow 6.5 um more
        let fault = |sweep: Mode, sunk: f64| {
            let depth = |k: u32| sunk * f64::from(k) / 1e3 + P.encoder_resolution * f64::from(k % 2);
            (0..1000).map(|k| Vector3::z() * depth(k)).fold(Evaluation::new(sweep, 0.0), Evaluation::show).fault
        };
        for sweep in [Mode::Cross, Mode::Circular] {
            assert_eq!([18e-6, 25e-6].map(|sunk| fault(sweep, sunk)), [None, Some(Fault::ForceFrozen)], "{sweep:?}");
        }
    }

    #[test]
    fn only_the_last_step_of_the_sensor_is_its_end() {
        let at = |force: f64| fault_of(&P, std::iter::once(force));
        assert_eq!(at(P.sensor_range), Some(Fault::Saturation));
        assert_eq!(at(-P.sensor_range), Some(Fault::Saturation));
        assert_eq!(at(P.sensor_range - P.sensor_resolution), None);
    }

    #[test]
    fn a_constant_force_is_frozen_only_where_that_is_monitored() {
        let mut p = P;
        let constant = |p: &Parameters| fault_of(p, std::iter::repeat_n(1.0, 5000));
        assert_eq!(constant(&p), Some(Fault::ForceFrozen));
        p.limits.frozen_time = 0.0;
        assert_eq!(constant(&p), None);
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
