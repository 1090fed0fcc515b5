//! Finds the faults of a sample, the most severe first.

mod message;

pub use message::numbers;

use control_blocks::ticks;
use nalgebra::Vector3;

use crate::force::contact::{ContactMonitor, Measurement};
use crate::interface::{Fault, Parameters, State};
use crate::monitoring::axis::AxisMonitor;
use crate::monitoring::force::{ForceMonitor, ForceSample};
use crate::reading::{Doubt, Reading};

/// The data from which faults are found.
pub struct Evidence<'a> {
    /// State of the last sample; during a commissioning run the state of a cycle with the same monitors.
    pub state: State,
    /// The zero of the sensor is being taken.
    pub taring: bool,
    /// Samples since the state began.
    pub ticks: u32,
    /// Travel of approach or retract so far, m.
    pub travelled: f64,
    /// In the state `Fault`: is at rest.
    pub halted: bool,
    /// The inputs.
    pub reading: &'a Reading,
    /// The measurements of this sample.
    pub now: &'a Measurement,
    /// The zero of the force sensor (N) that was taken in this sample.
    pub zero: Option<Vector3<f64>>,
    /// Counters and means.
    pub contact: &'a ContactMonitor,
    /// The axes against their pulses.
    pub axes: &'a AxisMonitor,
    /// The force against the motion.
    pub force: &'a ForceMonitor,
    /// The force of this sample.
    pub sample: &'a ForceSample<'a>,
    /// Stiffness that was found over the nominal one, or the reciprocal.
    pub stiffness_ratio: f64,
    /// The force loop has its phase margin.
    pub stable: bool,
    /// The ball slides as fast as it should.
    pub slides: bool,
    /// The results of a commissioning run are not usable.
    pub rejected: bool,
    /// The cycle has used up its time.
    pub overdue: bool,
    /// The samples of this communication step have the same inputs.
    pub long_step: bool,
}

impl Evidence<'_> {
    /// A cycle is active, the tare included.
    fn working(&self) -> bool {
        self.taring || self.state.moving()
    }

    /// Pulses are sent, after a fault too.
    fn moves(&self) -> bool {
        self.working() || (self.state == State::Fault && !self.halted)
    }

    /// A cycle or commissioning run is active, or is requested and waits for a valid sample.
    fn active_or_requested(&self) -> bool {
        self.working() || (self.reading.pending && matches!(self.state, State::Idle | State::Done))
    }

    fn longer_than(&self, p: &Parameters, state: State, time: f64) -> bool {
        self.state == state && self.ticks > ticks(time, p.sample_period)
    }
}

/// The most severe fault of one sample: inputs first, then the axes, the force, and their consequences.
pub fn find(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    readings(p, seen)
        .or_else(|| start(p, seen))
        .or_else(|| axes(p, seen))
        .or_else(|| cycle(p, seen))
        .or_else(|| rejected(seen))
}

fn rejected(seen: &Evidence) -> Option<Fault> {
    seen.rejected.then_some(Fault::CommissionRejected)
}

fn first<const N: usize>(faults: [(Fault, bool); N]) -> Option<Fault> {
    faults.into_iter().find_map(|(fault, holds)| holds.then_some(fault))
}

fn readings(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    let (reading, maximum) = (seen.reading, p.limits.lost_samples.unsigned_abs());
    let beyond = reading.position.abs() - 0.5 * p.stroke.vector();
    first([
        (Fault::EmergencyStop, reading.stopped),
        (Fault::LongStep, seen.moves() && seen.long_step),
        (Fault::PositionLost, (seen.moves() || seen.active_or_requested()) && reading.position_doubt.lost > maximum),
        (Fault::PositionJump, seen.moves() && reading.position_doubt.doubted > maximum),
        (Fault::Stroke, seen.moves() && beyond.max() > 0.0),
        // during the retract no force is needed
        (Fault::ForceLost, seen.active_or_requested() && reading.force_doubt.lost > maximum),
        (Fault::ForceJump, seen.working() && reading.force_doubt.doubted > maximum),
        (Fault::InvalidInput, seen.working() && reading.invalid > maximum),
    ])
}

fn start(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    first([
        (Fault::TareRejected, seen.zero.is_some_and(|zero| zero.norm() > p.limits.tare_force)),
        (Fault::NotAtStart, seen.zero.is_some() && away_from_start(p, seen.now)),
    ])
}

fn axes(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    // the model continues to move while the last valid measurement replaces an invalid one
    if seen.moves() && seen.reading.position_doubt == Doubt::default() { seen.axes.fault(p) } else { None }
}

fn cycle(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    if !seen.working() {
        return None;
    }
    seen.force.reading_fault(p, seen.sample).or_else(|| contact(p, seen)).or_else(|| control(p, seen))
}

fn contact(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    let Evidence { state, now, contact, .. } = *seen;
    let on_path = matches!(state, State::Settle | State::Follow);
    let too_deep = now.error.normal > p.limits.approach_depth;
    let maximum = p.settle.time_max;
    let out = p.retract.distance / p.retract.velocity + maximum;
    first([
        (Fault::ForceLimit, now.force.norm > p.limits.force && (state.pressing() || state == State::Approach)),
        (Fault::InvalidPath, on_path && contact.misdirected(p, &now.frame.normal)),
        (Fault::ApproachTimeout, state == State::Approach && (seen.travelled > p.approach.travel_max || too_deep)),
        (Fault::SettleTimeout, seen.longer_than(p, State::Settle, maximum)),
        (Fault::UnloadTimeout, seen.longer_than(p, State::Unload, maximum) || seen.longer_than(p, State::Retract, out)),
        (Fault::ContactLost, contact.lost(p)),
    ])
}

fn control(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    let Evidence { state, now, .. } = *seen;
    let on_path = matches!(state, State::Settle | State::Follow);
    let in_plane = now.error.tangential.abs().max(now.error.lateral.abs());
    first([
        (Fault::PositionError, state == State::Follow && in_plane > p.limits.position_error),
        (Fault::SurfaceError, on_path && now.surface.abs() > p.limits.surface_error),
        (Fault::WrongStiffness, state == State::Follow && seen.stiffness_ratio > p.limits.stiffness_ratio),
        (Fault::UnstableLoop, state.pressing() && !seen.stable),
        (Fault::NoSliding, state == State::Follow && !seen.slides),
    ])
    .or_else(|| seen.force.loop_fault(p))
    .or_else(|| seen.overdue.then_some(Fault::NoProgress))
}

/// The tool is laterally away from the start of the path, or below it.
fn away_from_start(p: &Parameters, now: &Measurement) -> bool {
    let height = -now.error.normal;
    let in_plane = (now.offset - now.frame.normal * now.error.normal).norm();
    in_plane > p.limits.start_offset || height < -p.limits.start_offset
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::sensor::MeasuredForce;
    use crate::interface::{ErrorOutput, Input};
    use crate::path::centre_path::Frame;
    use crate::reading::Reader;

    const P: Parameters = Parameters::START;
    use State::{Approach, Follow, Retract, Settle, Unload};

    /// The data of a sample; without a fault by default.
    struct Sample {
        state: State,
        taring: bool,
        halted: bool,
        ticks: u32,
        travelled: f64,
        reading: Reading,
        now: Measurement,
        zero: Option<Vector3<f64>>,
        stiffness_ratio: f64,
        stable: bool,
        slides: bool,
        rejected: bool,
        overdue: bool,
        long_step: bool,
    }

    impl Sample {
        fn good(state: State) -> Self {
            let (none, normal) = (Vector3::zeros(), Vector3::z());
            let frame = Frame { centre: none, contact: none, normal, tangent: Vector3::x(), ratio: 1.0, feed_max: 1.0 };
            let force = MeasuredForce { vector: none, unfiltered: none, norm: 0.0, normal: 0.0, controlled: 0.0 };
            let error = ErrorOutput { tangential: 0.0, lateral: 0.0, normal: 0.0 };
            Self {
                state,
                taring: false,
                halted: false,
                ticks: 0,
                travelled: 0.0,
                reading: Reader::new().read(&P, &Input::START, 0.0),
                now: Measurement { frame, force, force_error: 0.0, offset: none, error, surface: 0.0 },
                zero: None,
                stiffness_ratio: 1.0,
                stable: true,
                slides: true,
                rejected: false,
                overdue: false,
                long_step: false,
            }
        }

        fn fault(&self) -> Option<Fault> {
            let (contact, force, axes) = (ContactMonitor::default(), ForceMonitor::default(), AxisMonitor::new(&P));
            let Self {
                state,
                taring,
                halted,
                ticks,
                travelled,
                zero,
                stiffness_ratio,
                stable,
                slides,
                rejected,
                overdue,
                long_step,
                ..
            } = *self;
            let (raw, stiffness) = (&self.reading.force, P.stiffness_nominal);
            let sample =
                &ForceSample { state, raw, now: &self.now, normal: &self.now.frame.normal, stiffness, distance: 0.0 };
            let (reading, now, contact, axes, force) = (&self.reading, &self.now, &contact, &axes, &force);
            let evidence = Evidence {
                state,
                taring,
                ticks,
                travelled,
                halted,
                reading,
                now,
                zero,
                contact,
                axes,
                force,
                sample,
                stiffness_ratio,
                stable,
                slides,
                rejected,
                overdue,
                long_step,
            };
            find(&P, &evidence)
        }
    }

    /// A fault, the states in which it is active, and a function that sets its value to a multiple of its limit.
    type Limit = (Fault, &'static [State], fn(&mut Sample, f64));

    const WORKING: &[State] = &[Approach, Settle, Follow, Unload, Retract, State::Commission];
    const MOVING: &[State] = &[Approach, Settle, Follow, Unload, Retract, State::Commission, State::Fault];

    fn samples(times: f64, limit: f64) -> u32 {
        (times * limit).ceil() as u32
    }

    #[test]
    fn at_its_limit_nothing_is_a_fault_and_beyond_it_is_one_where_it_counts() {
        let limits: &[Limit] = &[
            (Fault::EmergencyStop, State::ALL, |s, x| s.reading.stopped = x > 1.0),
            (Fault::LongStep, MOVING, |s, x| s.long_step = x > 1.0),
            (Fault::PositionLost, MOVING, |s, x| s.reading.position_doubt.lost = samples(x, 5.0)),
            (Fault::PositionJump, MOVING, |s, x| s.reading.position_doubt.doubted = samples(x, 5.0)),
            (Fault::ForceLost, WORKING, |s, x| s.reading.force_doubt.lost = samples(x, 5.0)),
            (Fault::ForceJump, WORKING, |s, x| s.reading.force_doubt.doubted = samples(x, 5.0)),
            (Fault::InvalidInput, WORKING, |s, x| s.reading.invalid = samples(x, 5.0)),
            (Fault::Stroke, MOVING, |s, x| s.reading.position.y = -x * 0.5 * P.stroke.y),
            (Fault::TareRejected, State::ALL, |s, x| s.zero = Some(x * P.limits.tare_force * Vector3::z())),
            (Fault::NotAtStart, State::ALL, |s, x| {
                (s.zero, s.now.offset) = (Some(Vector3::zeros()), x * P.limits.start_offset * Vector3::y());
            }),
            (Fault::NotAtStart, State::ALL, |s, x| {
                s.zero = Some(Vector3::zeros());
                s.now.error.normal = x * P.limits.start_offset;
                s.now.offset = s.now.error.normal * s.now.frame.normal;
            }),
            (Fault::ForceLimit, &[Approach, Settle, Follow, Unload], |s, x| s.now.force.norm = x * P.limits.force),
            (Fault::ApproachTimeout, &[Approach], |s, x| s.travelled = x * P.approach.travel_max),
            (Fault::ApproachTimeout, &[Approach], |s, x| s.now.error.normal = x * P.limits.approach_depth),
            (Fault::SettleTimeout, &[Settle], |s, x| s.ticks = if s.state == Settle { samples(x, 2e3) } else { 0 }),
            (Fault::UnloadTimeout, &[Unload], |s, x| s.ticks = if s.state == Unload { samples(x, 2e3) } else { 0 }),
            // 0.1 s of the retract besides
            (Fault::UnloadTimeout, &[Retract], |s, x| s.ticks = if s.state == Retract { samples(x, 2.1e3) } else { 0 }),
            (Fault::PositionError, &[Follow], |s, x| s.now.error.tangential = -x * P.limits.position_error),
            (Fault::PositionError, &[Follow], |s, x| s.now.error.lateral = x * P.limits.position_error),
            (Fault::SurfaceError, &[Settle, Follow], |s, x| s.now.surface = -x * P.limits.surface_error),
            (Fault::WrongStiffness, &[Follow], |s, x| s.stiffness_ratio = x * P.limits.stiffness_ratio),
            (Fault::UnstableLoop, &[Settle, Follow, Unload], |s, x| s.stable = x <= 1.0),
            (Fault::NoSliding, &[Follow], |s, x| s.slides = x <= 1.0),
            (Fault::NoProgress, WORKING, |s, x| s.overdue = x > 1.0),
            (Fault::CommissionRejected, State::ALL, |s, x| s.rejected = x > 1.0),
        ];
        for (i, (fault, counts, take_to)) in limits.iter().enumerate() {
            for state in State::ALL.iter().copied() {
                for (times, taring) in [(1.0, false), (1.0, true), (1.001, false), (1.001, true)] {
                    let mut sample = Sample { taring, ..Sample::good(state) };
                    take_to(&mut sample, times);
                    // the tare is part of the cycle
                    let counts = counts.contains(&state) || (taring && counts.starts_with(WORKING));
                    let expected = (times > 1.0 && counts).then_some(*fault);
                    assert_eq!(sample.fault(), expected, "row {i} in {state:?}, taring: {taring}, {times}");
                }
            }
        }
    }

    #[test]
    fn a_request_without_a_valid_sample_is_a_fault_before_the_motion() {
        type Measured = fn(&mut Reading) -> &mut Doubt;
        let position: Measured = |reading| &mut reading.position_doubt;
        let force: Measured = |reading| &mut reading.force_doubt;
        for (fault, doubt) in [(Fault::PositionLost, position), (Fault::ForceLost, force)] {
            for state in State::ALL.iter().copied() {
                for (pending, lost) in [(false, 6), (true, 5), (true, 6)] {
                    let mut sample = Sample { halted: true, ..Sample::good(state) };
                    sample.reading.pending = pending;
                    doubt(&mut sample.reading).lost = lost;
                    let waits = pending && matches!(state, State::Idle | State::Done);
                    let expected = (lost > 5 && (waits || state.moving())).then_some(fault);
                    assert_eq!(sample.fault(), expected, "{state:?}, pending: {pending}, {lost}");
                }
            }
        }
    }

    #[test]
    fn a_tool_at_rest_after_a_fault_loses_nothing_more() {
        let mut sample = Sample { halted: true, ..Sample::good(State::Fault) };
        sample.reading.position_doubt = Doubt { lost: 9, doubted: 9 };
        sample.reading.position.x = 10.0;
        assert_eq!(sample.fault(), None);
        assert_eq!(Sample { halted: false, ..sample }.fault(), Some(Fault::PositionLost));
    }
}
