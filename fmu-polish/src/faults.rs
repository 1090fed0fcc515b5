//! Every fault is found here, the gravest first; and the numbers that are told with it.

use control_blocks::ticks;
use nalgebra::Vector3;

use crate::force::contact::{ContactMonitor, Measurement};
use crate::interface::{Fault, Parameters, State, Vars};
use crate::reading::Reading;

/// From what a fault is found.
pub struct Evidence<'a> {
    /// State of the last sample.
    pub state: State,
    /// Samples since it began.
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
}

/// The gravest fault of one sample.
pub fn find(p: &Parameters, seen: &Evidence) -> Option<Fault> {
    let Evidence { state, reading, now, zero, contact, .. } = *seen;
    let (pressing, on_path) = (state.pressing(), matches!(state, State::Settle | State::Follow));
    let beyond = reading.position.abs() - 0.5 * p.stroke.vector();
    let at_rest = matches!(state, State::Idle | State::Done) || (state == State::Fault && seen.halted);
    let beside_path = now.error.tangential.abs().max(now.error.lateral.abs());
    let faults = [
        (Fault::EmergencyStop, reading.stopped),
        (Fault::InvalidInput, !reading.valid),
        (Fault::Stroke, !at_rest && beyond.max() > 0.0),
        (Fault::TareRejected, zero.is_some_and(|zero| zero.norm() > p.limits.tare_force)),
        (Fault::NotAtStart, zero.is_some() && away_from_start(p, now)),
        (Fault::ForceLimit, now.force.norm > p.limits.force && (pressing || state == State::Approach)),
        (Fault::InvalidPath, on_path && contact.misdirected(p, &now.frame.normal)),
        (Fault::ApproachTimeout, state == State::Approach && seen.travelled > p.approach.travel_max),
        (Fault::SettleTimeout, state == State::Settle && seen.ticks > ticks(p.settle.time_max, p.sample_period)),
        (Fault::LostContact, contact.lost(p)),
        (Fault::PositionError, state == State::Follow && beside_path > p.limits.position_error),
        (Fault::SurfaceError, on_path && now.surface.abs() > p.limits.surface_error),
    ];
    faults.into_iter().find_map(|(fault, holds)| holds.then_some(fault))
}

/// The tool is beside the begin of the path, or below it.
fn away_from_start(p: &Parameters, now: &Measurement) -> bool {
    let height = -now.error.normal;
    let beside = (now.offset - now.frame.normal * now.error.normal).norm();
    beside > p.limits.start_offset || height < -p.limits.start_offset
}

impl Fault {
    /// Whether the tool moves out; if not, it stops where it is.
    pub fn retracts(self) -> bool {
        use Fault::{
            ApproachTimeout, ForceLimit, InvalidPath, LostContact, PositionError, SettleTimeout, SurfaceError,
        };
        matches!(
            self,
            ForceLimit | SettleTimeout | LostContact | InvalidPath | ApproachTimeout | PositionError | SurfaceError
        )
    }
}

/// The numbers behind the fault, to be told after its meaning.
pub fn numbers(vars: &Vars) -> String {
    let (output, p) = (&vars.output, &vars.in_force);
    let (x, f, force, error) = (vars.input.position, vars.input.force, output.force, output.error);
    let place = format!("at `{:.3}` of the path", output.progress);
    match output.fault {
        Fault::None | Fault::EmergencyStop => String::new(),
        Fault::ForceLimit => format!(" = `{} N` {place}", p.limits.force),
        Fault::SettleTimeout => format!(" = `{} s`: `{:.2} N`", p.settle.time_max, force.measured),
        Fault::LostContact => format!(" {place}: `{:.2} N`", force.measured),
        Fault::InvalidInput => format!(": position `{} {} {} m`, force `{} {} {} N`", x.x, x.y, x.z, f.x, f.y, f.z),
        Fault::InvalidPath => format!(" {place}, by more than `limits.force_angle` = `{} rad`", p.limits.force_angle),
        Fault::ApproachTimeout => format!(" = `{} m`", p.approach.travel_max),
        Fault::PositionError => format!(": `{:.6} m` along, `{:.6} m` beside", error.tangential, error.lateral),
        Fault::Stroke => format!(": position `{} {} {} m`", x.x, x.y, x.z),
        Fault::TareRejected => format!(" = `{} N`: raw force `{} {} {} N`", p.limits.tare_force, f.x, f.y, f.z),
        Fault::NotAtStart => format!(": `{:.6} m` above it, `{:.6} m` beside", -error.normal, error.beside()),
        Fault::SurfaceError => format!(" = `{} m` {place}", p.limits.surface_error),
    }
}
