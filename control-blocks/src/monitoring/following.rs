//! Following error with the right alignment in time.
//!
//! A machine that responds after d samples is at r(k - d) when it follows perfectly, not at r(k): an error against r(k)
//! has the bias v d T, which at speed is larger than the errors to be detected.

use serde::{Deserialize, Serialize};

use crate::sampling::sent_commands::{DELAY_MAX, SentCommands};

/// The references in transit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Following(SentCommands);

impl Following {
    /// As if `reference` had been constant forever.
    pub fn resting(reference: f64) -> Self {
        Self(SentCommands::resting(reference))
    }

    /// Reference minus measurement, where the present measurement responds to the reference of `delay` samples ago.
    ///
    /// Adds the reference of this sample. A larger delay is limited to [`DELAY_MAX`].
    pub fn update(&mut self, reference: f64, reading: f64, delay: usize) -> f64 {
        self.0.send(reference);
        self.0.before(delay.min(DELAY_MAX)) - reading
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_perfect_machine_has_no_error_at_any_speed() {
        for delay in 0..=DELAY_MAX {
            for speed in [0.0, 1.0, 1e3] {
                let mut following = Following::resting(0.0);
                for k in 0..50u32 {
                    let late = speed * f64::from(k.saturating_sub(delay as u32));
                    assert_eq!(following.update(speed * f64::from(k), late, delay), 0.0);
                }
            }
        }
    }

    #[test]
    fn a_wrong_alignment_is_the_speed_times_the_delay() {
        let mut following = Following::resting(0.0);
        let error = (0..20).map(|k| following.update(f64::from(k), f64::from(k - 2), 0)).last();
        assert_eq!(error, Some(2.0));
    }
}
