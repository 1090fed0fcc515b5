//! State machine: what is asked for, what is done, faults and the transitions between them.

use serde::{Deserialize, Serialize};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Hold the pose; a motion stops on its way.
    Idle = 1,
    /// Run the path once without compensation.
    DryRun = 2,
    /// Learn the patterns of all speeds.
    Learn = 3,
    /// Run the path with the patterns at the overridden speed.
    Playback = 4,
    /// Run the path with the patterns at the speed that the cutting load allows.
    Deburr = 5,
    /// Write the bank.
    Export = 6,
}

impl Mode {
    /// Whether the robot moves for it.
    pub fn moves(self) -> bool {
        !matches!(self, Self::Idle | Self::Export)
    }
}

/// What the controller is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Not enabled: velocity commands are zero.
    Off = 1,
    /// Holds the pose.
    Idle = 2,
    /// Moves to the start of the path.
    Approach = 3,
    /// Rests before a run.
    Settle = 4,
    /// Runs the path.
    Run = 5,
    /// Stops on its way.
    Stop = 6,
    /// The job is done, holds the pose.
    Done = 7,
    /// Velocity commands are zero, for a reason given by the fault.
    Fault = 8,
}

impl State {
    /// Whether the position loop is closed.
    pub fn closed(self) -> bool {
        !matches!(self, Self::Off | Self::Fault)
    }
}

/// Why the controller is in the fault state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// No fault.
    None = 1,
    /// An input is not a number, infinite or absurd.
    InvalidInput = 2,
    /// An axis is farther from its reference than `axisN.error_max`.
    ControlError = 3,
    /// A pattern became larger than `learn.pulses_max`.
    PatternTooLarge = 4,
    /// There is no pattern to compensate with.
    BankEmpty = 5,
    /// The tool turned slower than `spindle.speed_min` while deburring.
    SpindleSlow = 6,
}

/// What is asked for in one sample.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// The drives may move.
    pub enable: bool,
    /// What is asked for.
    pub mode: Mode,
    /// Stand on the way.
    pub hold: bool,
    /// End a fault.
    pub reset: bool,
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

/// The state after `state` in which `job` is done; a fault comes first and stays until it is reset or disabled.
pub fn next(state: State, job: Mode, asked: &Asked, progress: Progress, fault: bool) -> State {
    let Asked { enable, mode, hold, reset } = *asked;
    let over = progress != Progress::Busy;
    match state {
        _ if !enable => State::Off,
        State::Fault if !reset => State::Fault,
        _ if fault => State::Fault,
        State::Fault | State::Off => State::Idle,
        State::Idle | State::Done if mode == job => state,
        State::Idle | State::Done => match mode {
            Mode::Idle => State::Idle,
            Mode::Export => State::Done,
            _ => State::Approach,
        },
        State::Stop if !over => State::Stop,
        State::Stop if mode != job => State::Idle,
        State::Stop => {
            if hold {
                State::Stop
            } else {
                State::Approach
            }
        }
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

    const STATES: [State; 8] =
        [State::Off, State::Idle, State::Approach, State::Settle, State::Run, State::Stop, State::Done, State::Fault];
    const ASKED: Asked = Asked { enable: true, mode: Mode::Deburr, hold: false, reset: false };

    #[test]
    fn without_enable_everything_is_off() {
        for state in STATES {
            assert_eq!(next(state, Mode::Deburr, &Asked { enable: false, ..ASKED }, Progress::Busy, true), State::Off);
        }
    }

    #[test]
    fn a_fault_wins_and_stays_until_it_is_reset() {
        for state in STATES {
            assert_eq!(next(state, Mode::Deburr, &ASKED, Progress::Over, true), State::Fault);
        }
        assert_eq!(next(State::Fault, Mode::Deburr, &ASKED, Progress::Busy, false), State::Fault);
        let reset = Asked { reset: true, ..ASKED };
        assert_eq!(next(State::Fault, Mode::Deburr, &reset, Progress::Busy, false), State::Idle);
        assert_eq!(next(State::Fault, Mode::Deburr, &reset, Progress::Busy, true), State::Fault);
    }

    #[test]
    fn a_job_goes_from_idle_to_done_and_stays_there() {
        let mut state = State::Idle;
        let mut seen = vec![];
        for job in [Mode::Idle, Mode::Deburr, Mode::Deburr, Mode::Deburr, Mode::Deburr] {
            state = next(state, job, &ASKED, Progress::Over, false);
            seen.push(state);
        }
        assert_eq!(seen, [State::Approach, State::Settle, State::Run, State::Done, State::Done]);
    }

    #[test]
    fn another_mode_stops_first() {
        for state in [State::Approach, State::Run] {
            assert_eq!(next(state, Mode::Learn, &ASKED, Progress::Busy, false), State::Stop);
        }
        assert_eq!(next(State::Stop, Mode::Learn, &ASKED, Progress::Busy, false), State::Stop);
        assert_eq!(next(State::Stop, Mode::Learn, &ASKED, Progress::Over, false), State::Idle);
        assert_eq!(next(State::Done, Mode::Learn, &ASKED, Progress::Busy, false), State::Approach);
    }

    #[test]
    fn a_held_repetition_is_repeated_a_held_run_goes_on() {
        let hold = Asked { hold: true, ..ASKED };
        assert_eq!(next(State::Run, Mode::Deburr, &hold, Progress::Busy, false), State::Run);
        let (hold, learn) = (Asked { mode: Mode::Learn, ..hold }, Asked { mode: Mode::Learn, ..ASKED });
        assert_eq!(next(State::Run, Mode::Learn, &hold, Progress::Busy, false), State::Stop);
        assert_eq!(next(State::Stop, Mode::Learn, &hold, Progress::Over, false), State::Stop);
        assert_eq!(next(State::Stop, Mode::Learn, &learn, Progress::Over, false), State::Approach);
        assert_eq!(next(State::Settle, Mode::Learn, &hold, Progress::Over, false), State::Settle);
    }

    #[test]
    fn repetitions_follow_each_other() {
        let learn = Asked { mode: Mode::Learn, ..ASKED };
        assert_eq!(next(State::Run, Mode::Learn, &learn, Progress::Again, false), State::Approach);
        assert_eq!(next(State::Run, Mode::Learn, &learn, Progress::Over, false), State::Done);
    }
}
