//! State machine: the transitions between the states, as a pure function.

use control_blocks::Reaction;
use serde::{Deserialize, Serialize};

use crate::interface::{Mode, State};

impl Mode {
    /// Whether the robot moves for it.
    pub fn moves(self) -> bool {
        !matches!(self, Self::Idle | Self::Export)
    }
}

impl State {
    /// Whether the position loop is closed.
    pub fn closed(self) -> bool {
        !matches!(self, Self::Off | Self::Fault)
    }

    /// Whether the pose is held after a task or before one.
    pub fn waits(self) -> bool {
        matches!(self, Self::Idle | Self::Done)
    }
}

/// How far the present state has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Progress {
    /// On its path.
    Busy,
    /// At its end.
    Over,
    /// At the end of a run after which another one follows.
    Again,
}

/// Inputs of the state machine in one sample.
#[derive(Clone, Copy, Debug)]
pub struct Events {
    /// `enable` is true, and the positions of all axes are known.
    pub enable: bool,
    /// `enable` is false, or was false at some time in the present stop.
    pub disabled: bool,
    /// Requested mode, the input `mode`.
    pub mode: Mode,
    /// Present task, or the last one at rest; a `mode` that is equal to it starts nothing.
    pub task: Mode,
    /// The motion pauses.
    pub hold: bool,
    /// Rising edge of `reset_fault` while the axes are at rest.
    pub reset: bool,
    /// Reaction to the active fault; none without one.
    pub end: Option<Reaction>,
    /// A commissioning run is requested, the axes are at rest, and `hold` is false.
    pub commission: bool,
    /// A registration is requested, the axes are at rest, and `hold` is false.
    pub register: bool,
    /// The commissioning run or registration is to be aborted.
    pub abort: bool,
    /// A commissioning run or a registration is in progress or stops.
    pub measuring: bool,
    /// A fault is detected in this sample.
    pub fault: bool,
    /// The tool may be in the part.
    pub inside: bool,
    /// The control error with a pattern that is being learned exceeded its limit.
    pub grown: bool,
    /// The task is `Learn`, and all speeds are learned.
    pub learned: bool,
    /// How far the present state has come.
    pub progress: Progress,
}

/// The state after `state`.
pub fn next(state: State, events: &Events) -> State {
    let Events { enable, reset, fault, .. } = *events;
    match (state, events.end) {
        (State::Fault, _) if fault || !reset => State::Fault,
        (State::Fault | State::Off, _) if !enable => State::Off,
        (State::Fault, _) => State::Idle,
        (_, Some(end)) => ending(state, end, events),
        _ => going_on(state, events),
    }
}

/// The state after `state` during the motion to the reaction of a fault.
fn ending(state: State, end: Reaction, events: &Events) -> State {
    let over = events.progress != Progress::Busy;
    let retracts = end == Reaction::Retract && events.inside;
    match state {
        _ if end == Reaction::DriveOff => State::Fault,
        State::Approach | State::Run | State::Commission | State::Register => State::Stop,
        State::Stop | State::Retract if !over => state,
        State::Idle | State::Settle | State::Done | State::Stop if retracts => State::Retract,
        _ => State::Fault,
    }
}

/// The state after `state` without a fault.
fn going_on(state: State, events: &Events) -> State {
    let Events { enable, disabled, mode, task, hold, progress, .. } = *events;
    let over = progress != Progress::Busy;
    match state {
        State::Off | State::Fault | State::Retract => State::Idle,
        State::Idle | State::Settle | State::Done if !enable => State::Off,
        State::Approach | State::Run | State::Commission | State::Register if !enable => State::Stop,
        State::Idle | State::Done if mode == task && events.commission => State::Commission,
        State::Idle | State::Done if mode == task && events.register => State::Register,
        State::Idle | State::Done if mode == task => state,
        State::Idle | State::Done => match mode {
            Mode::Idle => State::Idle,
            Mode::Export => State::Done,
            _ => State::Approach,
        },
        State::Stop if !over => State::Stop,
        State::Stop if disabled => State::Off,
        State::Stop if events.measuring => State::Idle,
        State::Stop if mode != task => State::Idle,
        State::Stop if hold => State::Stop,
        State::Stop if events.learned => State::Done,
        State::Stop => State::Approach,
        State::Approach | State::Run if mode != task => State::Stop,
        State::Settle if mode != task => State::Idle,
        // a repetition with a rest during its motion cannot be learned from
        State::Run if hold && task == Mode::Learn => State::Stop,
        State::Run if events.grown => State::Stop,
        State::Approach if over => State::Settle,
        State::Settle if over && !hold => State::Run,
        State::Run if progress == Progress::Again => State::Approach,
        State::Run if over => State::Done,
        // what has come to its end is not aborted any more
        State::Commission | State::Register if over => State::Idle,
        State::Commission | State::Register if events.abort || mode != task => State::Stop,
        State::Approach | State::Settle | State::Run | State::Commission | State::Register => state,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVENTS: Events = Events {
        enable: true,
        disabled: false,
        mode: Mode::Deburr,
        task: Mode::Deburr,
        hold: false,
        reset: false,
        end: None,
        commission: false,
        register: false,
        abort: false,
        measuring: false,
        fault: false,
        inside: true,
        grown: false,
        learned: false,
        progress: Progress::Busy,
    };
    const LEARN: Events = Events { mode: Mode::Learn, task: Mode::Learn, ..EVENTS };

    #[test]
    fn without_enable_a_motion_stops_first_and_everything_else_is_off() {
        for state in State::ALL.iter().filter(|state| **state != State::Retract) {
            let expected = match state {
                State::Fault => State::Fault,
                State::Approach | State::Run | State::Stop | State::Commission | State::Register => State::Stop,
                _ => State::Off,
            };
            assert_eq!(next(*state, &Events { enable: false, disabled: true, ..EVENTS }), expected, "{state:?}");
        }
        let stopped = Events { disabled: true, progress: Progress::Over, ..EVENTS };
        assert_eq!(next(State::Stop, &Events { enable: false, ..stopped }), State::Off);
        // too late for this stop
        assert_eq!(next(State::Stop, &stopped), State::Off);
    }

    #[test]
    fn a_fault_that_no_command_helps_wins_immediately_and_stays_until_it_is_reset() {
        let wrong = Events { end: Some(Reaction::DriveOff), fault: true, progress: Progress::Over, ..EVENTS };
        for state in State::ALL {
            assert_eq!(next(*state, &wrong), State::Fault);
        }
        let reported = Events { fault: false, ..wrong };
        assert_eq!(next(State::Fault, &reported), State::Fault);
        assert_eq!(next(State::Fault, &Events { enable: false, ..reported }), State::Fault);
        let reset = Events { reset: true, ..reported };
        assert_eq!(next(State::Fault, &reset), State::Idle);
        assert_eq!(next(State::Fault, &Events { enable: false, ..reset }), State::Off);
        assert_eq!(next(State::Fault, &Events { fault: true, ..reset }), State::Fault);
    }

    #[test]
    fn a_gentle_reaction_stops_then_retracts_then_holds() {
        let (busy, over) = (Progress::Busy, Progress::Over);
        for (end, inside, states) in [
            (Reaction::Retract, true, [State::Stop, State::Stop, State::Retract, State::Retract, State::Fault]),
            (Reaction::Retract, false, [State::Stop, State::Stop, State::Fault, State::Fault, State::Fault]),
            (Reaction::Stop, true, [State::Stop, State::Stop, State::Fault, State::Fault, State::Fault]),
        ] {
            // without enable, too
            for enable in [true, false] {
                let mut state = State::Run;
                let visited = [over, busy, over, busy, over].map(|progress| {
                    let wrong = Events { end: Some(end), inside, enable, disabled: !enable, progress, ..EVENTS };
                    state = next(state, &wrong);
                    state
                });
                assert_eq!(visited, states, "{end:?} {inside}");
            }
        }
        let wrong = Events { end: Some(Reaction::Retract), ..EVENTS };
        for (state, then) in
            [(State::Settle, State::Retract), (State::Done, State::Retract), (State::Off, State::Fault)]
        {
            assert_eq!(next(state, &wrong), then);
        }
        let escalated = Events { end: Some(Reaction::DriveOff), ..EVENTS };
        assert_eq!(next(State::Retract, &escalated), State::Fault);
    }

    #[test]
    fn a_repetition_that_grows_stops_and_the_next_speed_follows() {
        assert_eq!(next(State::Run, &Events { grown: true, ..LEARN }), State::Stop);
        let stopped = Events { progress: Progress::Over, ..LEARN };
        assert_eq!(next(State::Stop, &stopped), State::Approach);
        assert_eq!(next(State::Stop, &Events { learned: true, ..stopped }), State::Done);
    }

    #[test]
    fn a_cycle_goes_from_idle_to_done_and_stays_there() {
        let mut state = State::Idle;
        let mut seen = vec![];
        for task in [Mode::Idle, Mode::Deburr, Mode::Deburr, Mode::Deburr, Mode::Deburr] {
            state = next(state, &Events { task, progress: Progress::Over, ..EVENTS });
            seen.push(state);
        }
        assert_eq!(seen, [State::Approach, State::Settle, State::Run, State::Done, State::Done]);
    }

    #[test]
    fn another_mode_stops_first() {
        let other = Events { mode: Mode::Learn, ..EVENTS };
        for state in [State::Approach, State::Run] {
            assert_eq!(next(state, &other), State::Stop);
        }
        assert_eq!(next(State::Stop, &other), State::Stop);
        assert_eq!(next(State::Stop, &Events { progress: Progress::Over, ..other }), State::Idle);
        assert_eq!(next(State::Done, &other), State::Approach);
    }

    #[test]
    fn a_held_repetition_is_repeated_a_held_run_goes_on() {
        assert_eq!(next(State::Run, &Events { hold: true, ..EVENTS }), State::Run);
        let (hold, over) = (Events { hold: true, ..LEARN }, Progress::Over);
        assert_eq!(next(State::Run, &hold), State::Stop);
        assert_eq!(next(State::Stop, &Events { progress: over, ..hold }), State::Stop);
        assert_eq!(next(State::Stop, &Events { progress: over, ..LEARN }), State::Approach);
        assert_eq!(next(State::Settle, &Events { progress: over, ..hold }), State::Settle);
    }

    #[test]
    fn repetitions_follow_each_other() {
        assert_eq!(next(State::Run, &Events { progress: Progress::Again, ..LEARN }), State::Approach);
        assert_eq!(next(State::Run, &Events { progress: Progress::Over, ..LEARN }), State::Done);
    }

    #[test]
    fn the_bank_is_exported_without_a_motion() {
        let requested = Events { mode: Mode::Export, task: Mode::Idle, ..EVENTS };
        for state in [State::Idle, State::Done] {
            assert_eq!(next(state, &requested), State::Done);
            assert_eq!(next(state, &Events { mode: Mode::Idle, task: Mode::Export, ..EVENTS }), State::Idle);
        }
    }

    #[test]
    fn another_mode_while_it_settles_ends_the_cycle() {
        assert_eq!(next(State::Settle, &Events { mode: Mode::Learn, ..EVENTS }), State::Idle);
        assert_eq!(next(State::Settle, &EVENTS), State::Settle);
    }

    #[test]
    fn a_commission_begins_where_the_pose_is_held_and_ends_in_idle() {
        let requested = Events { commission: true, ..EVENTS };
        for state in State::ALL {
            let begins = state.waits();
            assert_eq!(
                next(*state, &requested) == State::Commission,
                begins || *state == State::Commission,
                "{state:?}"
            );
        }
        // a task that is asked for as well comes first
        assert_eq!(next(State::Done, &Events { mode: Mode::Learn, ..requested }), State::Approach);
        assert_eq!(next(State::Done, &Events { enable: false, ..requested }), State::Off);
        // and a registration afterwards
        assert_eq!(next(State::Done, &Events { register: true, ..requested }), State::Commission);
        assert_eq!(next(State::Done, &Events { register: true, ..EVENTS }), State::Register);
        assert_eq!(next(State::Settle, &Events { register: true, ..EVENTS }), State::Settle);
        let over = Events { progress: Progress::Over, ..EVENTS };
        for measures in [State::Commission, State::Register] {
            assert_eq!(next(measures, &EVENTS), measures);
            assert_eq!(next(measures, &over), State::Idle);
            for ends in [
                Events { abort: true, ..EVENTS },
                Events { mode: Mode::Learn, ..EVENTS },
                Events { enable: false, ..EVENTS },
                Events { end: Some(Reaction::Stop), ..EVENTS },
            ] {
                assert_eq!(next(measures, &ends), State::Stop);
                // what has come to its good end is taken, not aborted
                let late = ends.abort || ends.mode != ends.task;
                let over = Events { progress: Progress::Over, ..ends };
                assert_eq!(next(measures, &over), if late { State::Idle } else { State::Stop });
            }
        }
        let stops = Events { measuring: true, ..EVENTS };
        assert_eq!(next(State::Stop, &stops), State::Stop);
        assert_eq!(next(State::Stop, &Events { progress: Progress::Over, ..stops }), State::Idle);
        // without continuing with a mode that came meanwhile
        assert_eq!(next(State::Stop, &Events { progress: Progress::Over, mode: Mode::Learn, ..stops }), State::Idle);
        assert_eq!(next(State::Stop, &Events { progress: Progress::Over, disabled: true, ..stops }), State::Off);
    }
}
