//! Every fault is found here, the gravest first; and the numbers that are told with it.

use control_blocks::{DELAY_MAX, SafeEnd, ticks};
use nalgebra::Vector3;

use crate::check::check;
use crate::commission::response::GUIDES;
use crate::commission::values::{Values, acceptable};
use crate::force::contact::{ContactMonitor, Measurement};
use crate::interface::{Fault, Measured, Parameters, State, Vars};
use crate::monitoring::axis::AxisMonitor;
use crate::monitoring::force::{ForceMonitor, ForceSample};
use crate::monitoring::numbers::Numbers;
use crate::reading::{Doubt, Reading};

/// From what a fault is found.
pub struct Evidence<'a> {
    /// State of the last sample; of a commission that of a job which is watched alike.
    pub state: State,
    /// The zero of the sensor is being taken.
    pub taring: bool,
    /// Samples since the state began.
    pub ticks: u32,
    /// Way of approach or retract so far, m.
    pub travelled: f64,
    /// In the state `Fault`: stands still.
    pub halted: bool,
    /// The inputs.
    pub reading: &'a Reading,
    /// What they say.
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
    /// What a commission has measured cannot be used.
    pub rejected: bool,
    /// The job has used up its time.
    pub overdue: bool,
    /// The samples of this communication step have the same inputs.
    pub long_step: bool,
}

impl Evidence<'_> {
    /// A job is on, the tare included.
    fn working(&self) -> bool {
        self.taring || self.state.moving()
    }

    /// Pulses are sent, after a fault too.
    fn moves(&self) -> bool {
        self.working() || (self.state == State::Fault && !self.halted)
    }

    fn longer_than(&self, p: &Parameters, state: State, time: f64) -> bool {
        self.state == state && self.ticks > ticks(time, p.sample_period)
    }
}

/// The gravest fault of one sample: first what can be read, then the axes, then the force, and at last what comes of them.
pub fn find(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    readings(p, seen)
        .or_else(|| start(p, seen))
        .or_else(|| axes(p, seen))
        .or_else(|| job(p, seen))
        .or_else(|| rejected(seen))
}

fn rejected(seen: &Evidence) -> Option<Fault> {
    seen.rejected.then_some(Fault::CommissionRejected)
}

fn first<const N: usize>(faults: [(Fault, bool); N]) -> Option<Fault> {
    faults.into_iter().find_map(|(fault, holds)| holds.then_some(fault))
}

fn readings(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    let (reading, most) = (seen.reading, p.limits.lost_samples.unsigned_abs());
    let beyond = reading.position.abs() - 0.5 * p.stroke.vector();
    first([
        (Fault::EmergencyStop, reading.stopped),
        (Fault::LongStep, seen.moves() && seen.long_step),
        (Fault::LostReading, seen.moves() && reading.position_doubt.lost > most),
        (Fault::ReadingJump, seen.moves() && reading.position_doubt.doubted > most),
        (Fault::Stroke, seen.moves() && beyond.max() > 0.0),
        // on the way out no force is needed
        (Fault::LostForce, seen.working() && reading.force_doubt.lost > most),
        (Fault::ForceJump, seen.working() && reading.force_doubt.doubted > most),
        (Fault::InvalidInput, seen.working() && reading.invalid > most),
    ])
}

fn start(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    first([
        (Fault::TareRejected, seen.zero.is_some_and(|zero| zero.norm() > p.limits.tare_force)),
        (Fault::NotAtStart, seen.zero.is_some() && away_from_start(p, seen.now)),
    ])
}

fn axes(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    // the model moves on while the last good reading stands in for a bad one
    if seen.moves() && seen.reading.position_doubt == Doubt::default() { seen.axes.fault(p) } else { None }
}

fn job(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    if !seen.working() {
        return None;
    }
    seen.force.reading_fault(p, seen.sample).or_else(|| contact(p, seen)).or_else(|| control(p, seen))
}

fn contact(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    let Evidence { state, now, contact, .. } = *seen;
    let on_path = matches!(state, State::Settle | State::Follow);
    let too_deep = now.error.normal > p.limits.approach_depth;
    let most = p.settle.time_max;
    let out = p.retract.distance / p.retract.velocity + most;
    first([
        (Fault::ForceLimit, now.force.norm > p.limits.force && (state.pressing() || state == State::Approach)),
        (Fault::InvalidPath, on_path && contact.misdirected(p, &now.frame.normal)),
        (Fault::ApproachTimeout, state == State::Approach && (seen.travelled > p.approach.travel_max || too_deep)),
        (Fault::SettleTimeout, seen.longer_than(p, State::Settle, most)),
        (Fault::UnloadTimeout, seen.longer_than(p, State::Unload, most) || seen.longer_than(p, State::Retract, out)),
        (Fault::LostContact, contact.lost(p)),
    ])
}

fn control(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    let Evidence { state, now, .. } = *seen;
    let on_path = matches!(state, State::Settle | State::Follow);
    let beside_path = now.error.tangential.abs().max(now.error.lateral.abs());
    first([
        (Fault::PositionError, state == State::Follow && beside_path > p.limits.position_error),
        (Fault::SurfaceError, on_path && now.surface.abs() > p.limits.surface_error),
        (Fault::WrongStiffness, state == State::Follow && seen.stiffness_ratio > p.limits.stiffness_ratio),
        (Fault::UnstableLoop, state.pressing() && !seen.stable),
        (Fault::NoSliding, state == State::Follow && !seen.slides),
    ])
    .or_else(|| seen.force.loop_fault(p))
    .or_else(|| seen.overdue.then_some(Fault::NoProgress))
}

/// The tool is beside the begin of the path, or below it.
fn away_from_start(p: &Parameters, now: &Measurement) -> bool {
    let height = -now.error.normal;
    let beside = (now.offset - now.frame.normal * now.error.normal).norm();
    beside > p.limits.start_offset || height < -p.limits.start_offset
}

impl Fault {
    /// How the job ends: out along the normal while pulses move the axes as they should, which needs no force; else off.
    pub fn safe_end(self) -> SafeEnd {
        use Fault::*;
        match self {
            None | ForceLimit | SettleTimeout | LostContact | InvalidInput | InvalidPath | ApproachTimeout => {
                SafeEnd::Retract
            }
            LostForce | ForceJump | FrozenForce | PositionError | SurfaceError | Saturation | NoisyForce
            | Oscillation => SafeEnd::Retract,
            ForceError | WrongStiffness | UnstableLoop | UnloadTimeout | NoProgress | NoSliding
            | CommissionRejected => SafeEnd::Retract,
            Stroke | EmergencyStop | TareRejected | NotAtStart => SafeEnd::Stop,
            LostReading | ReadingJump | FrozenReading | FollowingError | DriveSign | WeakDrive | LongStep => {
                SafeEnd::DriveOff
            }
        }
    }
}

/// The numbers behind the fault, to be told after its meaning.
pub fn numbers(vars: &Vars) -> String {
    let (output, p) = (&vars.output, &vars.in_force);
    let (x, f, force, error) = (vars.input.position, vars.input.force, output.force, output.error);
    let n: Numbers = output.numbers;
    let place = format!("at `{:.3}` of the path", output.progress);
    let (position, raw) = (format!("`{} {} {} m`", x.x, x.y, x.z), format!("`{} {} {} N`", f.x, f.y, f.z));
    let row = p.limits.lost_samples;
    match output.fault {
        Fault::None | Fault::EmergencyStop => String::new(),
        Fault::ForceLimit => format!(" = `{} N` {place}: `{:.2} N`", p.limits.force, n.norm),
        Fault::SettleTimeout => {
            format!(" = `{} s`: `{:.2} N` of `{} N`", p.settle.time_max, force.measured, p.force.target)
        }
        Fault::LostContact => format!(" {place}: `{:.2} N` of `{} N`", force.measured, p.limits.lost_force),
        Fault::InvalidInput => {
            let (feed, force) = (vars.input.feed_override, vars.input.force_override);
            format!(" = `{row}`: `feed_override` = `{feed}`, `force_override` = `{force}`")
        }
        Fault::LostReading | Fault::ReadingJump => format!(" = `{row}`: position {position}"),
        Fault::LostForce | Fault::ForceJump => format!(" = `{row}` {place}: raw force {raw}"),
        Fault::InvalidPath => format!(
            " {place}: mean angle `{:.3} rad`, `limits.force_angle` = `{} rad`, with `{:.2} N` and a raw force of {raw}",
            n.angle, p.limits.force_angle, force.measured
        ),
        Fault::ApproachTimeout => format!(
            ": `{} m` down, or more than `{} m` below it, is `{:.6} m` below it, with `{:.2} N`",
            p.approach.travel_max, p.limits.approach_depth, error.normal, force.measured
        ),
        Fault::PositionError => format!(
            " = `{} m`: `{:.6} m` along, `{:.6} m` beside",
            p.limits.position_error, error.tangential, error.lateral
        ),
        Fault::Stroke => format!(": position {position}, `stroke` = `{} {} {} m`", p.stroke.x, p.stroke.y, p.stroke.z),
        Fault::TareRejected => format!(" = `{} N`: `{:.2} N`", p.limits.tare_force, n.zero),
        Fault::NotAtStart => format!(
            ": `{:.6} m` above it, `{:.6} m` beside, `limits.start_offset` = `{} m`",
            -error.normal,
            error.beside(),
            p.limits.start_offset
        ),
        Fault::SurfaceError => format!(" = `{} m` {place}: `{:.6} m`", p.limits.surface_error, n.surface),
        Fault::FrozenReading | Fault::FollowingError | Fault::DriveSign | Fault::WeakDrive => {
            let (e, limit) = (output.following, p.limits.following_error);
            let share = n.share.map_or(String::new(), |share| format!("; it does `{share:.2}` of what it is told"));
            format!(
                " {place}: `{:.6} {:.6} {:.6} m` from where the pulses bring it, limit `{limit} m`{share}",
                e.x, e.y, e.z
            )
        }
        Fault::FrozenForce => {
            format!(" {place}: raw force {raw}, `limits.still_time` = `{} s`", p.limits.still_time)
        }
        Fault::Saturation => format!(" = `{} N`: raw force {raw}", p.sensor_range),
        Fault::NoisyForce => format!(" = `{} N` {place}: `{:.3} N`", p.limits.force_noise, n.noise),
        Fault::Oscillation | Fault::ForceError => {
            let [mean, limit] = n.force_error;
            let (measured, target) = (force.measured, p.force.target);
            format!(" {place}: `{mean:.2} N`, limit `{limit:.2} N`, with `{measured:.2} N` of `{target} N`")
        }
        Fault::WrongStiffness => {
            format!(
                " = `{}`: `{:.0} N/m` for `{} N/m`",
                p.limits.stiffness_ratio, output.stiffness_estimate, p.stiffness_nominal
            )
        }
        Fault::UnstableLoop => format!(
            ": `impedance.gain` = `{}`, `impedance.damping` = `{} N.s/m`, `force.integral_time` = `{} s`",
            p.impedance.gain, p.impedance.damping, p.force.integral_time
        ),
        Fault::UnloadTimeout => format!(" = `{} s`: `{:.2} N`", p.settle.time_max, force.measured),
        Fault::NoSliding => format!(
            " {place}: `{:.4} m/s` of `{:.4} m/s` at K_v = `{:.4} m/s`, with a friction of `{:.2} N`",
            output.sliding.speed,
            p.stick_slip.sliding,
            p.stick_slip.velocity + output.sliding.added,
            output.sliding.friction
        ),
        Fault::NoProgress => format!(" = `{:.1} s`: `{:.1} s` {place}", n.time_limit, n.time),
        Fault::CommissionRejected => commission_rejected(p, &output.measured),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
    }
}

/// What was measured, and what it must be; what was told is in force again.
fn commission_rejected(p: &Parameters, m: &Measured) -> String {
    let told = Values::of(p);
    if acceptable(p, &told, m) {
        let mut found = p.clone();
        told.derived(p, m).put(&mut found, [told, told]);
        if let Err(error) = check(&found) {
            return format!(": {}", error.of_derived());
        }
    }
    let most = p.commission.deviation_max;
    format!(
        ": stiffness `{:.0} +- {:.0} N/m`, across `{:.0} +- {:.0} N/m`, friction `{:.3} +- {:.3}`, drives `{:.3} +- {:.3}` times as \
         fast as told and `{:.3} +- {:.3}` fed forward, delay `{:.2} +- {:.2}` samples, sensor turned by `{:.3} +- {:.3} rad`; limits \
         half and twice `stiffness.nominal` = `{:.0} N/m` as told, half and twice as fast, `0` to `{DELAY_MAX}` samples, \
         `commission.deviation_max` = `{most}` of it, for drives beside `{}` and `{}` of their guides, and \
         `commission.delay_deviation_max` = `{}`",
        m.stiffness,
        m.stiffness_deviation,
        m.lateral_stiffness,
        m.lateral_stiffness_deviation,
        m.friction,
        m.friction_deviation,
        m.drive_gain,
        m.drive_gain_deviation,
        m.feedforward,
        m.feedforward_deviation,
        m.io_delay,
        m.io_delay_deviation,
        m.sensor_rotation,
        m.sensor_rotation_deviation,
        told.stiffness,
        GUIDES[0],
        GUIDES[1],
        p.commission.delay_deviation_max
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::sensor::MeasuredForce;
    use crate::interface::{ErrorOutput, Input};
    use crate::monitoring::numbers::Numbers;
    use crate::path::centre_path::Frame;
    use crate::reading::Reader;

    const P: Parameters = Parameters::START;
    use State::{Approach, Follow, Retract, Settle, Unload};

    /// What a sample says; at first nothing is wrong.
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
                reading: Reader::new().read(&P, &Input::START, P.stiffness_nominal),
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
                &ForceSample { state, raw, now: &self.now, normal: &self.now.frame.normal, stiffness, way: 0.0 };
            let (reading, now, contact, axes, force) = (&self.reading, &self.now, &contact, &axes, &force);
            let told = Evidence {
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
            find(&P, &told)
        }
    }

    /// A fault, the states in which it counts, and what takes its value to so many times its limit.
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
            (Fault::LostReading, MOVING, |s, x| s.reading.position_doubt.lost = samples(x, 5.0)),
            (Fault::ReadingJump, MOVING, |s, x| s.reading.position_doubt.doubted = samples(x, 5.0)),
            (Fault::LostForce, WORKING, |s, x| s.reading.force_doubt.lost = samples(x, 5.0)),
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
            // 0.1 s of the way out besides
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
                    // the tare is part of the job
                    let counts = counts.contains(&state) || (taring && counts.starts_with(WORKING));
                    let expected = (times > 1.0 && counts).then_some(*fault);
                    assert_eq!(sample.fault(), expected, "row {i} in {state:?}, taring: {taring}, {times}");
                }
            }
        }
    }

    #[test]
    fn a_tool_that_stands_after_a_fault_loses_nothing_more() {
        let mut sample = Sample { halted: true, ..Sample::good(State::Fault) };
        sample.reading.position_doubt = Doubt { lost: 9, doubted: 9 };
        sample.reading.position.x = 10.0;
        assert_eq!(sample.fault(), None);
        assert_eq!(Sample { halted: false, ..sample }.fault(), Some(Fault::LostReading));
    }

    #[test]
    fn a_fault_tells_what_was_judged_and_its_limit() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.numbers = Numbers {
            share: Some(0.3),
            time: 28.4,
            time_limit: 28.3,
            norm: 24.68,
            zero: 2.345,
            angle: 0.7125,
            surface: 6.2e-4,
            noise: 0.4567,
            force_error: [1.234, 1.0],
        };
        (vars.output.measured.stiffness, vars.output.measured.stiffness_deviation) = (123_456.7, 1234.5);
        vars.output.error = ErrorOutput { tangential: 3e-3, lateral: -4e-3, normal: 2e-3 };
        for (fault, told) in [
            (Fault::WeakDrive, "; it does `0.30` of what it is told"),
            (Fault::DriveSign, "; it does `0.30` of what it is told"),
            (Fault::NoProgress, " = `28.3 s`: `28.4 s` at `0.000` of the path"),
            (Fault::ForceLimit, " = `25 N` at `0.000` of the path: `24.68 N`"),
            (Fault::TareRejected, " = `2 N`: `2.35 N`"),
            (Fault::InvalidPath, "mean angle `0.713 rad`, `limits.force_angle` = `0.6 rad`"),
            (Fault::SurfaceError, " = `0.0005 m` at `0.000` of the path: `0.000620 m`"),
            (Fault::NoisyForce, " = `0.35 N` at `0.000` of the path: `0.457 N`"),
            (Fault::ForceError, "`1.23 N`, limit `1.00 N`"),
            (Fault::LostForce, " = `5` at `0.000` of the path: raw force `0 0 0 N`"),
            (Fault::ReadingJump, " = `5`: position `0 0 0 m`"),
            (Fault::CommissionRejected, ": stiffness `123457 +- 1234 N/m`, across `0 +- 0 N/m`"),
            (Fault::LongStep, ": limit `0.001 s`"),
            (Fault::NotAtStart, ": `-0.002000 m` above it, `0.005000 m` beside"),
        ] {
            vars.output.fault = fault;
            assert!(numbers(&vars).contains(told), "{}", numbers(&vars));
        }
    }

    #[test]
    fn a_rejected_commission_tells_what_was_told_and_what_the_parameters_do_not_bear() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        let told = numbers(&vars);
        assert!(told.contains("half and twice `stiffness.nominal` = `178000 N/m` as told"), "{told}");
        let m = &mut vars.output.measured;
        (m.stiffness, m.lateral_stiffness, m.friction, m.drive_gain, m.io_delay) = (178e3, 200e3, 0.2, 0.6, 1.0);
        (m.sensor_direction_y, m.sensor_direction_z) = (1, 1);
        vars.in_force.position.gain.y = 50.0;
        let told = numbers(&vars);
        let limit = "parameter `position.gain.y` would be `50 1/s`, must be at most `drive.position_gain` = `48 1/s`";
        assert!(told.contains(limit), "{told}");
    }
}
