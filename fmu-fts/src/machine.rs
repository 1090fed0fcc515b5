//! State machine: what is asked for, what is done, faults and the transitions between them.

use serde::{Deserialize, Serialize};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// No torque; ends a fault.
    Off = 1,
    /// Hold `hold_angle`.
    Hold = 2,
    /// Get onto the path and follow it without learning.
    Approach = 3,
    /// Follow the path and cancel what repeats; gets onto the path first.
    Track = 4,
    /// Measure the frequency response of the position loop in place.
    Identify = 5,
    /// Hold `hold_angle` and collect probed flats.
    CalibrateFlats = 6,
    /// Hold `hold_angle` and collect the probed toroid.
    CalibrateToroid = 7,
}

/// What the controller is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// No torque.
    Idle = 1,
    /// Moves to `hold_angle` and holds it.
    Hold = 2,
    /// Moves onto the path.
    Approach = 3,
    /// Follows the path, learns nothing.
    Ready = 4,
    /// Follows the path and learns.
    Track = 5,
    /// Measures its frequency response.
    Identify = 6,
    /// Holds `hold_angle` for a calibration.
    Calibrate = 7,
    /// No torque, for a reason given by the fault.
    Fault = 8,
}

impl State {
    /// Whether the position loop is closed.
    pub fn closed(self) -> bool {
        !matches!(self, Self::Idle | Self::Fault)
    }

    /// Whether the arm moves on the path or towards it.
    pub fn on_path(self) -> bool {
        matches!(self, Self::Approach | Self::Ready | Self::Track)
    }
}

/// Why the controller is in the fault state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// No fault.
    None = 1,
    /// The arm is more than `limit.following_error` behind.
    FollowingError = 2,
    /// The path needs more torque than there is.
    Infeasible = 3,
    /// The slide is where the path has no table.
    OutsideTable = 4,
    /// An input is not a number, infinite or absurd.
    InvalidInput = 5,
}

/// What happened in one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Something is wrong.
    pub fault: Option<Fault>,
    /// Angle and speed of the spindle are known.
    pub spindle_known: bool,
    /// The motion onto the path is complete.
    pub arrived: bool,
}

/// The state after `state` when `mode` is asked for; a fault comes first and stays until `Off`.
pub fn next(state: State, mode: Mode, events: &Events) -> State {
    match (state, mode) {
        (_, Mode::Off) => State::Idle,
        (State::Fault, _) => State::Fault,
        _ if events.fault.is_some() => State::Fault,
        (_, Mode::Hold) => State::Hold,
        (_, Mode::Identify) => State::Identify,
        (_, Mode::CalibrateFlats | Mode::CalibrateToroid) => State::Calibrate,
        (State::Approach, _) if !events.arrived => State::Approach,
        (State::Approach | State::Ready | State::Track, Mode::Approach) => State::Ready,
        (State::Approach | State::Ready | State::Track, Mode::Track) => State::Track,
        (_, Mode::Approach | Mode::Track) if events.spindle_known => State::Approach,
        (unchanged, Mode::Approach | Mode::Track) => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATES: [State; 8] = [
        State::Idle,
        State::Hold,
        State::Approach,
        State::Ready,
        State::Track,
        State::Identify,
        State::Calibrate,
        State::Fault,
    ];
    const MODES: [Mode; 7] = [
        Mode::Off,
        Mode::Hold,
        Mode::Approach,
        Mode::Track,
        Mode::Identify,
        Mode::CalibrateFlats,
        Mode::CalibrateToroid,
    ];
    const NOTHING: Events = Events { fault: None, spindle_known: true, arrived: false };

    #[test]
    fn off_is_idle_from_everywhere_and_ends_a_fault() {
        let broken = Events { fault: Some(Fault::InvalidInput), ..NOTHING };
        for state in STATES {
            assert_eq!(next(state, Mode::Off, &NOTHING), State::Idle);
            assert_eq!(next(state, Mode::Off, &broken), State::Idle);
        }
    }

    #[test]
    fn a_fault_wins_in_every_other_mode_and_stays() {
        let broken = Events { fault: Some(Fault::FollowingError), arrived: true, ..NOTHING };
        for mode in &MODES[1..] {
            for state in STATES {
                assert_eq!(next(state, *mode, &broken), State::Fault);
            }
            assert_eq!(next(State::Fault, *mode, &NOTHING), State::Fault);
        }
    }

    #[test]
    fn tracking_begins_with_the_approach() {
        let arrived = Events { arrived: true, ..NOTHING };
        for from in [State::Idle, State::Hold, State::Identify, State::Calibrate] {
            assert_eq!(next(from, Mode::Track, &arrived), State::Approach);
            assert_eq!(next(from, Mode::Approach, &arrived), State::Approach);
        }
        assert_eq!(next(State::Approach, Mode::Track, &NOTHING), State::Approach);
        assert_eq!(next(State::Approach, Mode::Track, &arrived), State::Track);
        assert_eq!(next(State::Approach, Mode::Approach, &arrived), State::Ready);
        assert_eq!(next(State::Ready, Mode::Track, &NOTHING), State::Track);
        assert_eq!(next(State::Track, Mode::Approach, &NOTHING), State::Ready);
    }

    #[test]
    fn nothing_moves_onto_the_path_before_the_spindle_is_known() {
        let unknown = Events { spindle_known: false, ..NOTHING };
        for state in [State::Idle, State::Hold] {
            assert_eq!(next(state, Mode::Track, &unknown), state);
            assert_eq!(next(state, Mode::Hold, &unknown), State::Hold);
        }
    }

    #[test]
    fn holding_modes_act_at_once() {
        for state in &STATES[..7] {
            assert_eq!(next(*state, Mode::Hold, &NOTHING), State::Hold);
            assert_eq!(next(*state, Mode::Identify, &NOTHING), State::Identify);
            assert_eq!(next(*state, Mode::CalibrateFlats, &NOTHING), State::Calibrate);
            assert_eq!(next(*state, Mode::CalibrateToroid, &NOTHING), State::Calibrate);
        }
    }
}
