//! State machine of one approach: states, faults and the transitions between them.

use serde::{Deserialize, Serialize};

/// What the controller is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Holds its position and waits for `start`.
    Idle = 1,
    /// Accelerates and settles at constant speed.
    Approach = 2,
    /// Learns the noise at constant speed.
    Learn = 3,
    /// Watches for contact.
    Detect = 4,
    /// Has detected contact and decelerates.
    Contact = 5,
    /// Moves back.
    Retract = 6,
    /// Holds its position after the retract; a new `start` begins again.
    Done = 7,
    /// Has decelerated and moved back for a reason given by the fault; a new `start` begins again.
    Fault = 8,
}

impl State {
    /// Whether the stage moves towards the workpiece.
    pub fn approaching(self) -> bool {
        matches!(self, Self::Approach | Self::Learn | Self::Detect)
    }
}

/// Why the controller is in the fault state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// No fault.
    None = 1,
    /// `approach.travel_max` would be passed without contact.
    TravelLimit = 2,
    /// The position was invalid for more than three samples.
    LostSync = 3,
    /// The current was at its limit for more than 50 samples.
    Saturation = 4,
    /// The learned noise is no noise: too large, not around zero, or none at all.
    LearnRejected = 5,
    /// A position or spindle speed was not a number, infinite or absurd.
    InvalidInput = 6,
}

/// What detected the contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactSource {
    /// No contact.
    None = 1,
    /// Raw force.
    Raw = 2,
    /// Deviation from the moving average.
    Deviation = 3,
    /// Slope over one window.
    Slope = 4,
    /// Slope over four windows.
    MultiSlope = 5,
    /// Cumulative sum.
    Cusum = 6,
    /// Generalised likelihood ratio.
    Glr = 7,
    /// Hard force guard.
    ForceGuard = 8,
}

/// What happened in one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Rising edge of `start` without `abort`.
    pub start: bool,
    /// `abort` is set.
    pub abort: bool,
    /// The position is valid and the reference is at rest.
    pub restful: bool,
    /// Something is wrong.
    pub fault: Option<Fault>,
    /// Contact, from its source.
    pub contact: Option<ContactSource>,
    /// The time of the present state at constant speed is over.
    pub elapsed: bool,
    /// The reference no longer moves towards the workpiece.
    pub turned: bool,
    /// The retreat is complete.
    pub retreated: bool,
}

/// The state after `state` and `events`; a fault comes first, then contact, then `abort`.
pub fn next(state: State, events: &Events) -> State {
    use State::{Approach, Contact, Detect, Done, Fault, Idle, Learn, Retract};
    let touched = events.contact.is_some();
    match state {
        Fault if events.start && events.restful && events.retreated => Approach,
        Fault => Fault,
        _ if events.fault.is_some() => Fault,
        Idle | Done if events.start && events.restful => Approach,
        Approach | Learn | Detect if touched => Contact,
        Approach | Learn | Detect if events.abort => Retract,
        Approach if events.elapsed => Learn,
        Learn if events.elapsed => Detect,
        Contact if events.turned => Retract,
        Retract if events.retreated => Done,
        unchanged => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [State; 8] = [
        State::Idle,
        State::Approach,
        State::Learn,
        State::Detect,
        State::Contact,
        State::Retract,
        State::Done,
        State::Fault,
    ];

    #[test]
    fn nothing_happens_without_events() {
        for state in ALL {
            assert_eq!(next(state, &Events::default()), state);
        }
    }

    #[test]
    fn the_whole_way_of_one_approach() {
        let none = Events::default();
        let rest = Events { start: true, restful: true, ..none };
        let elapsed = Events { elapsed: true, ..none };
        let contact = Events { contact: Some(ContactSource::Slope), ..none };
        let turned = Events { turned: true, ..none };
        let retreated = Events { retreated: true, ..none };
        let mut state = State::Idle;
        let way = [rest, elapsed, elapsed, contact, turned, retreated, rest];
        let expected = [
            State::Approach,
            State::Learn,
            State::Detect,
            State::Contact,
            State::Retract,
            State::Done,
            State::Approach,
        ];
        for (events, expected) in way.iter().zip(expected) {
            state = next(state, events);
            assert_eq!(state, expected);
        }
    }

    #[test]
    fn a_fault_wins_everywhere() {
        let events = Events {
            start: true,
            abort: true,
            fault: Some(Fault::LostSync),
            contact: Some(ContactSource::Slope),
            elapsed: true,
            ..Events::default()
        };
        for state in ALL {
            assert_eq!(next(state, &events), State::Fault);
        }
    }

    #[test]
    fn abort_acts_only_while_approaching() {
        let abort = Events { abort: true, ..Events::default() };
        for state in ALL {
            let expected = if state.approaching() { State::Retract } else { state };
            assert_eq!(next(state, &abort), expected);
        }
    }

    #[test]
    fn a_fault_ends_only_at_rest_after_the_retreat() {
        let start = Events { start: true, restful: true, ..Events::default() };
        assert_eq!(next(State::Fault, &start), State::Fault);
        let ready = Events { retreated: true, ..start };
        assert_eq!(next(State::Fault, &ready), State::Approach);
    }
}
