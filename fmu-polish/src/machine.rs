//! State machine: what happened in a sample and the transitions.

use control_blocks::Reaction;

use crate::interface::{Fault, State};

impl State {
    /// Whether the force control works.
    pub fn pressing(self) -> bool {
        matches!(self, Self::Settle | Self::Follow | Self::Unload)
    }

    /// Whether the machine moves for the cycle, or to measure itself.
    pub fn moving(self) -> bool {
        self.pressing() || matches!(self, Self::Approach | Self::Retract | Self::Commission)
    }
}

/// Conditions of one sample that decide the next state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// A fault is present.
    pub fault: Option<Fault>,
    /// A commissioning run is requested.
    pub commission: bool,
    /// The commissioning run is complete, or aborted and the tool is retracted.
    pub commissioned: bool,
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// The zero of the sensor is known and the tool is at the start.
    pub ready: bool,
    /// The tool touches.
    pub contact: bool,
    /// The force is settled.
    pub settled: bool,
    /// The end of the path.
    pub arrived: bool,
    /// The force is gone.
    pub unloaded: bool,
    /// The retract is complete, and the force stays away.
    pub retracted: bool,
}

/// The fault to name when `found` is seen after `fault`: the more_severe one, never back.
pub fn more_severe(fault: Fault, found: Fault) -> Fault {
    let ends: (Reaction, Reaction) = (fault.reaction(), found.reaction());
    if fault == Fault::None || ends.1 > ends.0 { found } else { fault }
}

/// The state after `state`.
pub fn next(state: State, events: &Events) -> State {
    use State::{Approach, Commission, Done, Fault, Follow, Idle, Retract, Settle, Unload};
    match state {
        Fault if events.reset && events.retracted && events.fault.is_none() => Idle,
        Fault => Fault,
        _ if events.fault.is_some() => Fault,
        Idle if events.ready => Approach,
        Idle | Done if events.commission => Commission,
        Commission if events.commissioned => Idle,
        Approach if !events.enabled => Retract,
        Settle | Follow if !events.enabled => Unload,
        Approach if events.contact => Settle,
        Settle if events.settled => Follow,
        Follow if events.arrived => Unload,
        Unload if events.unloaded => Retract,
        Retract if events.retracted => Done,
        Done if !events.enabled => Idle,
        unchanged => unchanged,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON: Events = Events {
        fault: None,
        commission: false,
        commissioned: false,
        enabled: true,
        reset: false,
        ready: false,
        contact: false,
        settled: false,
        arrived: false,
        unloaded: false,
        retracted: false,
    };

    #[test]
    fn nothing_happens_without_events() {
        for state in State::ALL.iter().copied() {
            assert_eq!(next(state, &ON), state);
        }
    }

    #[test]
    fn the_whole_sequence_of_one_cycle() {
        let sequence = [
            (Events { ready: true, ..ON }, State::Approach),
            (Events { contact: true, ..ON }, State::Settle),
            (Events { settled: true, ..ON }, State::Follow),
            (Events { arrived: true, ..ON }, State::Unload),
            (Events { unloaded: true, ..ON }, State::Retract),
            (Events { retracted: true, ..ON }, State::Done),
            (Events { enabled: false, ..ON }, State::Idle),
        ];
        let mut state = State::Idle;
        for (events, expected) in sequence {
            state = next(state, &events);
            assert_eq!(state, expected);
        }
    }

    #[test]
    fn a_fault_wins_everywhere_and_needs_a_reset_at_rest() {
        let fault = Events { fault: Some(Fault::ForceLimit), ready: true, contact: true, retracted: true, ..ON };
        for state in State::ALL.iter().copied() {
            assert_eq!(next(state, &fault), State::Fault);
        }
        let reset = Events { reset: true, retracted: true, ..ON };
        assert_eq!(next(State::Fault, &reset), State::Idle);
        for rejected in [
            Events { retracted: false, ..reset },
            Events { reset: false, ..reset },
            Events { fault: Some(Fault::EmergencyStop), ..reset },
        ] {
            assert_eq!(next(State::Fault, &rejected), State::Fault);
        }
    }

    #[test]
    fn a_more_severe_fault_takes_the_name_and_a_less_severe_one_does_not() {
        for first in Fault::ALL.iter().copied() {
            for second in Fault::ALL.iter().copied() {
                let named = more_severe(first, second);
                assert!(named == first || named == second);
                assert_eq!(named.reaction(), first.reaction().max(second.reaction()), "{first:?} {second:?}");
            }
        }
        assert_eq!(more_severe(Fault::ForceLimit, Fault::ContactLost), Fault::ForceLimit);
    }

    #[test]
    fn a_commission_begins_at_rest_alone_and_a_cycle_comes_first() {
        let requested = Events { commission: true, ..ON };
        for state in State::ALL.iter().copied() {
            let begins = matches!(state, State::Idle | State::Done);
            assert_eq!(next(state, &requested), if begins { State::Commission } else { state });
        }
        assert_eq!(next(State::Idle, &Events { ready: true, ..requested }), State::Approach);
        let over = Events { commissioned: true, ..ON };
        assert_eq!(next(State::Commission, &over), State::Idle);
        assert_eq!(next(State::Commission, &Events { contact: true, retracted: true, ..ON }), State::Commission);
    }

    #[test]
    fn without_enable_the_tool_leaves() {
        let off = Events { enabled: false, contact: true, settled: true, ..ON };
        let expected =
            [(State::Approach, State::Retract), (State::Settle, State::Unload), (State::Follow, State::Unload)];
        for (state, after) in expected {
            assert_eq!(next(state, &off), after);
        }
    }
}
