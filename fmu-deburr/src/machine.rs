//! State machine: the transitions between the states, as a pure function.

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

    /// Whether the pose is held after a job or before one.
    pub fn waits(self) -> bool {
        matches!(self, Self::Idle | Self::Done)
    }
}

/// How far the present state has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Progress {
    /// On its way.
    Busy,
    /// At its end.
    Over,
    /// At the end of a run after which another one follows.
    Again,
}

/// What happens in one sample.
#[derive(Clone, Copy, Debug)]
pub struct Events {
    /// The drives may move.
    pub enable: bool,
    /// The drives might not move at some moment of the present stop.
    pub disabled: bool,
    /// What is asked for.
    pub mode: Mode,
    /// What is done.
    pub job: Mode,
    /// Stand on the way.
    pub hold: bool,
    /// Rising edge of `reset_fault` while the axes are at rest.
    pub reset: bool,
    /// Something is wrong.
    pub fault: bool,
    /// How far the present state has come.
    pub progress: Progress,
}

/// The state after `state`.
pub fn next(state: State, events: &Events) -> State {
    let Events { enable, disabled, mode, job, hold, reset, fault, progress } = *events;
    let over = progress != Progress::Busy;
    match state {
        State::Fault if fault || !reset => State::Fault,
        State::Fault | State::Off if !enable => State::Off,
        _ if fault => State::Fault,
        State::Fault | State::Off => State::Idle,
        State::Idle | State::Settle | State::Done if !enable => State::Off,
        State::Approach | State::Run if !enable => State::Stop,
        State::Idle | State::Done if mode == job => state,
        State::Idle | State::Done => match mode {
            Mode::Idle => State::Idle,
            Mode::Export => State::Done,
            _ => State::Approach,
        },
        State::Stop if !over => State::Stop,
        State::Stop if disabled => State::Off,
        State::Stop if mode != job => State::Idle,
        State::Stop if hold => State::Stop,
        State::Stop => State::Approach,
        State::Approach | State::Run if mode != job => State::Stop,
        State::Settle if mode != job => State::Idle,
        // a repetition with a rest on its way cannot be learned from
        State::Run if hold && job == Mode::Learn => State::Stop,
        State::Approach if over => State::Settle,
        State::Settle if over && !hold => State::Run,
        State::Run if progress == Progress::Again => State::Approach,
        State::Run if over => State::Done,
        State::Approach | State::Settle | State::Run => state,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVENTS: Events = Events {
        enable: true,
        disabled: false,
        mode: Mode::Deburr,
        job: Mode::Deburr,
        hold: false,
        reset: false,
        fault: false,
        progress: Progress::Busy,
    };
    const LEARN: Events = Events { mode: Mode::Learn, job: Mode::Learn, ..EVENTS };

    #[test]
    fn without_enable_a_motion_stops_first_and_everything_else_is_off() {
        for state in State::ALL {
            let expected = match state {
                State::Fault => State::Fault,
                State::Approach | State::Run | State::Stop => State::Stop,
                _ => State::Off,
            };
            assert_eq!(next(*state, &Events { enable: false, disabled: true, ..EVENTS }), expected, "{state:?}");
        }
        let stands = Events { disabled: true, progress: Progress::Over, ..EVENTS };
        assert_eq!(next(State::Stop, &Events { enable: false, ..stands }), State::Off);
        // too late for this stop
        assert_eq!(next(State::Stop, &stands), State::Off);
    }

    #[test]
    fn a_fault_wins_and_stays_until_it_is_reset() {
        for state in State::ALL {
            assert_eq!(next(*state, &Events { fault: true, progress: Progress::Over, ..EVENTS }), State::Fault);
        }
        assert_eq!(next(State::Fault, &EVENTS), State::Fault);
        assert_eq!(next(State::Fault, &Events { enable: false, ..EVENTS }), State::Fault);
        let reset = Events { reset: true, ..EVENTS };
        assert_eq!(next(State::Fault, &reset), State::Idle);
        assert_eq!(next(State::Fault, &Events { enable: false, ..reset }), State::Off);
        assert_eq!(next(State::Fault, &Events { fault: true, ..reset }), State::Fault);
    }

    #[test]
    fn a_job_goes_from_idle_to_done_and_stays_there() {
        let mut state = State::Idle;
        let mut seen = vec![];
        for job in [Mode::Idle, Mode::Deburr, Mode::Deburr, Mode::Deburr, Mode::Deburr] {
            state = next(state, &Events { job, progress: Progress::Over, ..EVENTS });
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
}
