//! Commands in transit: a machine with a delay of whole samples executes an earlier command now.
//!
//! With the delay d the command u of sample k acts in the sample after k + d: y_k = u_(k-d) right after u_k is sent,
//! and u_(k-1-d) before.

use serde::{Deserialize, Serialize};

/// Longest delay, samples.
pub const DELAY_MAX: usize = 8;

/// The newest commands, the newest first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SentCommands([f64; DELAY_MAX + 1]);

impl SentCommands {
    /// As if `command` had been sent forever.
    pub fn resting(command: f64) -> Self {
        Self([command; DELAY_MAX + 1])
    }

    /// Sends a command.
    pub fn send(&mut self, command: f64) {
        self.0.copy_within(0..DELAY_MAX, 1);
        self.0[0] = command;
    }

    /// The command sent `delay` samples before the newest.
    ///
    /// # Panics
    /// When `delay` is more than [`DELAY_MAX`].
    pub fn before(&self, delay: usize) -> f64 {
        self.0[delay]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_sent_comes_late_by_the_delay() {
        for delay in 0..=DELAY_MAX {
            let mut sent = SentCommands::resting(-1.0);
            for k in 0..40usize {
                let late = |from: usize| k.checked_sub(from).map_or(-1.0, |i| i as f64);
                assert_eq!(sent.before(delay), late(delay + 1), "before sample {k}");
                sent.send(k as f64);
                assert_eq!(sent.before(delay), late(delay), "after sample {k}");
            }
        }
    }

    #[test]
    fn a_stored_ring_goes_on() {
        let mut sent = SentCommands::default();
        (0..5).for_each(|k| sent.send(f64::from(k)));
        let stored = postcard::to_allocvec(&sent).unwrap();
        assert_eq!(postcard::from_bytes::<SentCommands>(&stored).unwrap(), sent);
    }
}
