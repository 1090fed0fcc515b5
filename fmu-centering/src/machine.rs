//! State machine of one centring: states, faults and the transitions between them.

use serde::{Deserialize, Serialize};

/// What the controller is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Moves back to where it started, holds, and waits for `enable`.
    Idle = 1,
    /// Moves towards the ring until the probe touches it.
    Approach = 2,
    /// Brings the pusher to its gap before the ring.
    Follow = 3,
    /// Follows and collects the surface.
    Collect = 4,
    /// Makes the model of the ring.
    Model = 5,
    /// Follows until the ring is where the push must begin.
    Wait = 6,
    /// Pushes.
    Push = 7,
    /// Retracts after a push and follows again.
    Settle = 8,
    /// The ring is centred; follows it.
    Centred = 9,
    /// Has moved back for a reason given by the fault; waits for `reset_fault`.
    Fault = 10,
}

impl State {
    /// Whether a centring is under way or finished, but not faulted.
    pub fn active(self) -> bool {
        !matches!(self, Self::Idle | Self::Fault)
    }

    /// Whether the slide follows the surface of the ring, without contact of the pusher.
    pub fn follows(self) -> bool {
        matches!(self, Self::Follow | Self::Collect | Self::Model | Self::Wait | Self::Centred)
    }

    /// Whether the state can only end by the turning of the spindle.
    pub fn needs_rotation(self) -> bool {
        matches!(self, Self::Collect | Self::Wait)
    }
}

/// Why the controller is in the fault state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// No fault.
    None = 1,
    /// No ring within the travel of the slide, or the probe has lost it.
    NoPart = 2,
    /// The spindle axis is not inside the ring, eq. 32.
    RingTooSmall = 3,
    /// The probe is beyond its stroke, or the pusher touches where it must not.
    ProbeRange = 4,
    /// The centrifugal force exceeds the friction assumed, eq. 2.
    Centrifugal = 5,
    /// Not centred within the allowed number of pushes.
    PushBudget = 6,
    /// An input was not a number, infinite, absurd, jumped or frozen.
    InvalidInput = 7,
    /// The spindle stands still, keeps reversing or is too fast for the collection.
    Spindle = 8,
    /// The pushes have moved the ring away from the axis.
    Diverged = 9,
    /// After a full revolution the eccentricity is too little known to be compared with the tolerance.
    Unresolved = 10,
}

/// What the model says about the next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The ring is centred.
    Centred,
    /// It needs a push.
    Push,
    /// More data are needed.
    Measure,
    /// More data would not help.
    Unresolved,
}

/// What happened in one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// Something is wrong.
    pub fault: Option<Fault>,
    /// The probe touches the ring.
    pub touched: bool,
    /// The probe has been where it should be for long enough.
    pub settled: bool,
    /// The data suffice for a model.
    pub collected: bool,
    /// What the new model says.
    pub verdict: Option<Verdict>,
    /// The push begins now.
    pub launched: bool,
    /// The stroke of the push is over.
    pub stroke_over: bool,
}

/// The state after `state` and `events`; a fault comes first, then the end of `enable`.
pub fn next(state: State, events: &Events) -> State {
    use State::{Approach, Centred, Collect, Fault, Follow, Idle, Model, Push, Settle, Wait};
    match state {
        Fault if events.reset && events.fault.is_none() => Idle,
        Fault => Fault,
        _ if events.fault.is_some() => Fault,
        Idle if events.start => Approach,
        Idle => Idle,
        _ if !events.enabled => Idle,
        Approach if events.touched => Follow,
        Follow | Settle if events.settled => Collect,
        Wait if events.launched => Push,
        Collect | Model | Wait if events.verdict.is_some() => match events.verdict {
            Some(Verdict::Centred) => Centred,
            Some(Verdict::Push) => Wait,
            _ => Collect,
        },
        Collect if events.collected => Model,
        Push if events.stroke_over => Settle,
        unchanged => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [State; 10] = [
        State::Idle,
        State::Approach,
        State::Follow,
        State::Collect,
        State::Model,
        State::Wait,
        State::Push,
        State::Settle,
        State::Centred,
        State::Fault,
    ];
    const ENABLED: Events = Events {
        enabled: true,
        start: false,
        reset: false,
        fault: None,
        touched: false,
        settled: false,
        collected: false,
        verdict: None,
        launched: false,
        stroke_over: false,
    };

    #[test]
    fn nothing_happens_without_events() {
        for state in ALL {
            assert_eq!(next(state, &ENABLED), state);
        }
    }

    #[test]
    fn the_whole_way_of_one_centring() {
        let settled = Events { settled: true, ..ENABLED };
        let collected = Events { collected: true, ..ENABLED };
        let way = [
            (Events { start: true, ..ENABLED }, State::Approach),
            (Events { touched: true, ..ENABLED }, State::Follow),
            (settled, State::Collect),
            (collected, State::Model),
            (Events { verdict: Some(Verdict::Push), ..ENABLED }, State::Wait),
            (Events { launched: true, ..ENABLED }, State::Push),
            (Events { stroke_over: true, ..ENABLED }, State::Settle),
            (settled, State::Collect),
            (collected, State::Model),
            (Events { verdict: Some(Verdict::Centred), ..ENABLED }, State::Centred),
        ];
        let mut state = State::Idle;
        for (events, expected) in way {
            state = next(state, &events);
            assert_eq!(state, expected);
        }
    }

    #[test]
    fn a_fault_wins_everywhere() {
        let events = Events {
            enabled: true,
            start: true,
            reset: true,
            fault: Some(Fault::NoPart),
            touched: true,
            settled: true,
            collected: true,
            verdict: Some(Verdict::Centred),
            launched: true,
            stroke_over: true,
        };
        for state in ALL {
            assert_eq!(next(state, &events), State::Fault);
        }
    }

    #[test]
    fn without_enable_everything_but_a_fault_is_idle() {
        for state in ALL {
            let expected = if state == State::Fault { State::Fault } else { State::Idle };
            assert_eq!(next(state, &Events::default()), expected);
        }
    }

    #[test]
    fn a_fault_ends_with_its_reset_only_and_then_waits_for_enable() {
        let start = Events { start: true, ..ENABLED };
        assert_eq!(next(State::Fault, &start), State::Fault);
        let reset = Events { reset: true, ..ENABLED };
        assert_eq!(next(State::Fault, &reset), State::Idle);
        assert_eq!(next(State::Idle, &ENABLED), State::Idle);
        assert_eq!(next(State::Idle, &start), State::Approach);
    }
}
