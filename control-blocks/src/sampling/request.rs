//! A request by the rising edge of a switch, which waits until it can be met.

use serde::{Deserialize, Serialize};

/// Whether something is asked for; nothing before the first edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WaitingRequest {
    waits: bool,
}

impl WaitingRequest {
    /// After a sample in which the switch rises (`edge`) or is on, and in which it counts (`here`) or does not: whether it is
    /// asked for. A request waits where it counts until the switch falls, and lapses where it does not count.
    pub fn update(&mut self, here: bool, edge: bool, on: bool) -> bool {
        self.waits = here && on && (self.waits || edge);
        self.waits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_waits_where_it_counts_until_the_switch_falls() {
        let mut request = WaitingRequest::default();
        // on without an edge
        assert!(!request.update(true, false, true));
        assert!(request.update(true, true, true) && request.update(true, false, true));
        assert!(!request.update(true, false, false) && !request.update(true, false, true));
        assert!(request.update(true, true, true));
        assert!(!request.update(false, false, true) && !request.update(true, false, true));
        // elsewhere an edge is none
        assert!(!request.update(false, true, true));
    }
}
