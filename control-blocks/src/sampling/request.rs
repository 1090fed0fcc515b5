//! A request by the rising edge of a Boolean input, which stays pending until it can be met.

use serde::{Deserialize, Serialize};

/// Whether a request is pending; none before the first edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WaitingRequest {
    waits: bool,
}

impl WaitingRequest {
    /// Updates the request with the input (`edge`, on) and whether requests are accepted (`here`); returns whether it is
    /// pending. A request stays pending while it is accepted and the input is true, and lapses otherwise.
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
        // elsewhere an edge is ignored
        assert!(!request.update(false, true, true));
    }
}
