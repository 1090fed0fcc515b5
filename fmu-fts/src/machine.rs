//! State machine: requested mode, states, and the transitions between them.

use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Input, Mode, State};

/// Requested mode, and whether it may still start a task; by default `Idle`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Request {
    /// Request of the last sample: `mode` while `enable` is true, otherwise `Idle`.
    requested: Mode,
    /// It is used up by a fault or a commissioning run, and has the effect of `Idle` until it changes.
    spent: bool,
    /// It has changed in this sample.
    renewed: bool,
}

impl Default for Request {
    fn default() -> Self {
        Self { requested: Mode::Idle, spent: false, renewed: false }
    }
}

impl Request {
    /// Reads the inputs of this sample. Returns `mode` while `enable` is true and the request is not used up, otherwise
    /// `Idle`.
    pub fn read(&mut self, input: &Input) -> Mode {
        let requested = if input.enable { input.mode } else { Mode::Idle };
        self.renewed = requested != self.requested;
        self.spent &= !self.renewed;
        self.requested = requested;
        if self.spent { Mode::Idle } else { requested }
    }

    /// Whether the request has changed in this sample.
    pub fn renewed(&self) -> bool {
        self.renewed
    }

    /// Marks the present request as used up: until it changes, [`Self::read`] returns `Idle`.
    pub fn spend(&mut self) {
        self.spent = true;
    }
}

impl State {
    /// Whether a commissioning run may start.
    pub fn waits(self) -> bool {
        matches!(self, Self::Idle | Self::Done)
    }
}

/// Inputs of the state machine in one sample, except the mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Fault of this sample, if any.
    pub fault: Option<Fault>,
    /// `reset_fault` rises.
    pub reset: bool,
    /// The arm is at rest off the path, or its loop is open and no braking pulse acts.
    pub at_rest: bool,
    /// The request has changed in this sample.
    pub renewed: bool,
    /// A commissioning run is requested.
    pub commission: bool,
    /// The commissioning run is to be aborted.
    pub abort: bool,
    /// The commissioning run is complete.
    pub commissioned: bool,
    /// Angle and speed of the arm are known.
    pub arm_known: bool,
    /// Angle and speed of the spindle are known, and where the slide is.
    pub spindle_known: bool,
    /// The slide has left the table at the end of the cut.
    pub cut_over: bool,
    /// The motion onto the path is complete.
    pub arrived: bool,
}

/// The state after `state` when `mode` is asked for; a fault comes first and stays until it is reset, at rest.
pub fn next(state: State, mode: Mode, events: &Events) -> State {
    match (state, mode) {
        (State::Fault, _) if events.reset && events.at_rest => State::Idle,
        (State::Fault, _) => State::Fault,
        (State::Idle, Mode::Idle) if !events.commission => State::Idle,
        _ if events.fault.is_some() => State::Fault,
        (State::Commission, _) if !events.abort && !events.commissioned => State::Commission,
        // a mode has priority over a commissioning run
        (State::Idle, Mode::Idle) if events.arm_known && events.at_rest => State::Commission,
        (State::Idle, Mode::Idle) => State::Idle,
        (State::Done, _) if events.commission && !events.renewed && events.at_rest => State::Commission,
        (_, Mode::Idle) if events.at_rest => State::Idle,
        (_, Mode::Idle) => State::Retract,
        (State::Done, _) if !events.renewed => State::Done,
        (State::Ready | State::Track, Mode::Approach | Mode::Track) if events.cut_over => State::Done,
        // nothing starts from an unknown position
        (State::Idle, _) if !events.arm_known => State::Idle,
        (_, Mode::Hold) => State::Hold,
        (_, Mode::Identify) => State::Identify,
        (_, Mode::CalibrateFlats | Mode::CalibrateToroid | Mode::CalibrateForm) => State::Calibrate,
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

    /// All but the fault, the end and the way to it.
    const WORKING: &[State] = State::ALL.split_at(7).0;
    const NOTHING: Events = Events {
        fault: None,
        reset: false,
        at_rest: true,
        renewed: false,
        commission: false,
        abort: false,
        commissioned: false,
        arm_known: true,
        spindle_known: true,
        cut_over: false,
        arrived: false,
    };

    #[test]
    fn without_a_task_the_arm_is_released_only_at_rest() {
        let moving = Events { at_rest: false, ..NOTHING };
        for state in WORKING.iter().chain(&[State::Done, State::Retract]) {
            assert_eq!(next(*state, Mode::Idle, &NOTHING), State::Idle);
            let ended = if *state == State::Idle { State::Idle } else { State::Retract };
            assert_eq!(next(*state, Mode::Idle, &moving), ended);
        }
    }

    #[test]
    fn during_the_retract_faults_act_and_another_task_may_start() {
        let moving = Events { at_rest: false, ..NOTHING };
        let broken = Events { fault: Some(Fault::PositionLost), ..moving };
        assert_eq!(next(State::Retract, Mode::Idle, &broken), State::Fault);
        assert_eq!(next(State::Idle, Mode::Idle, &broken), State::Idle);
        assert_eq!(next(State::Retract, Mode::Hold, &moving), State::Hold);
        assert_eq!(next(State::Retract, Mode::Track, &moving), State::Approach);
        let unknown = Events { spindle_known: false, ..moving };
        assert_eq!(next(State::Retract, Mode::Track, &unknown), State::Retract);
    }

    #[test]
    fn a_fault_wins_in_every_other_mode_and_stays_until_it_is_reset() {
        let broken = Events { fault: Some(Fault::FollowingError), arrived: true, ..NOTHING };
        for mode in &Mode::ALL[1..] {
            for state in State::ALL {
                assert_eq!(next(*state, *mode, &broken), State::Fault);
            }
        }
        for mode in Mode::ALL {
            assert_eq!(next(State::Fault, *mode, &NOTHING), State::Fault);
            assert_eq!(next(State::Fault, *mode, &Events { reset: true, ..broken }), State::Idle);
        }
    }

    #[test]
    fn a_reset_waits_until_the_arm_is_out_of_the_part() {
        let moving = Events { reset: true, at_rest: false, ..NOTHING };
        for mode in Mode::ALL {
            assert_eq!(next(State::Fault, *mode, &moving), State::Fault);
        }
    }

    #[test]
    fn a_reset_without_a_fault_does_nothing() {
        let reset = Events { reset: true, ..NOTHING };
        for state in WORKING {
            for mode in Mode::ALL {
                assert_eq!(next(*state, *mode, &reset), next(*state, *mode, &NOTHING));
            }
        }
    }

    #[test]
    fn the_mode_requests_a_task_while_enabled() {
        let mut request = Request::default();
        let mut read = |enable: bool, mode: Mode| request.read(&Input { enable, mode, ..Input::START });
        assert_eq!(read(false, Mode::Track), Mode::Idle);
        assert_eq!(read(true, Mode::Track), Mode::Track);
        assert_eq!(read(true, Mode::Hold), Mode::Hold);
        assert_eq!(read(false, Mode::Hold), Mode::Idle);
    }

    #[test]
    fn a_spent_request_starts_again_with_another_mode_or_enable() {
        for again in [(true, Mode::Hold), (false, Mode::Track)] {
            let mut request = Request::default();
            let mut read = |(enable, mode): (bool, Mode)| request.read(&Input { enable, mode, ..Input::START });
            read((true, Mode::Track));
            request.spend();
            let mut read = |(enable, mode): (bool, Mode)| request.read(&Input { enable, mode, ..Input::START });
            assert_eq!([read((true, Mode::Track)), read((true, Mode::Track))], [Mode::Idle; 2]);
            assert_eq!(read(again), if again.0 { again.1 } else { Mode::Idle });
            assert_eq!(read((true, Mode::Track)), Mode::Track);
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
    fn a_commission_begins_at_rest_and_ends_in_idle() {
        let requested = Events { commission: true, ..NOTHING };
        for state in State::ALL {
            let (begins, state) = (matches!(state, State::Idle | State::Done), *state);
            assert_eq!(next(state, Mode::Idle, &requested) == State::Commission, begins || state == State::Commission);
            assert_eq!(
                next(state, Mode::Hold, &requested) == State::Commission,
                state == State::Done || state == State::Commission
            );
            assert_eq!(state.waits(), begins, "{state:?}");
        }
        // not before the arm is known, not in a fault, and a mode has priority
        assert_eq!(next(State::Idle, Mode::Idle, &Events { arm_known: false, ..requested }), State::Idle);
        assert_eq!(next(State::Done, Mode::Track, &Events { at_rest: false, ..requested }), State::Done);
        assert_eq!(next(State::Idle, Mode::Idle, &Events { fault: Some(Fault::LongStep), ..requested }), State::Fault);
        assert_eq!(next(State::Idle, Mode::Hold, &Events { renewed: true, ..requested }), State::Hold);
        assert_eq!(next(State::Done, Mode::Hold, &Events { renewed: true, ..requested }), State::Hold);
        for end in [Events { abort: true, ..NOTHING }, Events { commissioned: true, ..NOTHING }] {
            assert_eq!(next(State::Commission, Mode::Idle, &end), State::Idle);
            assert_eq!(next(State::Commission, Mode::Idle, &Events { at_rest: false, ..end }), State::Retract);
        }
    }

    #[test]
    fn nothing_moves_before_the_arm_is_known() {
        let unknown = Events { arm_known: false, ..NOTHING };
        for mode in Mode::ALL {
            assert_eq!(next(State::Idle, *mode, &unknown), State::Idle);
        }
        assert_eq!(next(State::Hold, Mode::Identify, &unknown), State::Identify);
    }

    #[test]
    fn the_end_of_the_table_is_the_end_of_the_cut_until_another_request() {
        let over = Events { cut_over: true, ..NOTHING };
        for mode in [Mode::Approach, Mode::Track] {
            for state in [State::Ready, State::Track] {
                assert_eq!(next(state, mode, &over), State::Done);
            }
            assert_eq!(next(State::Done, mode, &NOTHING), State::Done);
            assert_eq!(next(State::Done, mode, &Events { renewed: true, ..NOTHING }), State::Approach);
        }
        assert_eq!(next(State::Hold, Mode::Hold, &over), State::Hold);
        assert_eq!(next(State::Done, Mode::Idle, &NOTHING), State::Idle);
        assert_eq!(next(State::Done, Mode::Hold, &Events { renewed: true, ..NOTHING }), State::Hold);
        assert_eq!(next(State::Done, Mode::Track, &Events { fault: Some(Fault::DriveSign), ..over }), State::Fault);
    }

    #[test]
    fn holding_modes_act_immediately() {
        for state in WORKING {
            assert_eq!(next(*state, Mode::Hold, &NOTHING), State::Hold);
            assert_eq!(next(*state, Mode::Identify, &NOTHING), State::Identify);
            assert_eq!(next(*state, Mode::CalibrateFlats, &NOTHING), State::Calibrate);
            assert_eq!(next(*state, Mode::CalibrateToroid, &NOTHING), State::Calibrate);
            assert_eq!(next(*state, Mode::CalibrateForm, &NOTHING), State::Calibrate);
        }
    }
}
