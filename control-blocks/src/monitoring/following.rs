//! Following error with the right alignment in time.
//!
//! A machine that answers after d samples is at r(k - d) when it follows perfectly, not at r(k): an error against r(k)
//! has the bias v d T, which at speed is larger than what is to be found.

use serde::{Deserialize, Serialize};

use crate::sampling::sent_commands::{DELAY_MAX, SentCommands};

/// The references on their way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Following(SentCommands);

impl Following {
    /// As if `reference` had stood forever.
    pub fn resting(reference: f64) -> Self {
        Self(SentCommands::resting(reference))
    }

    /// Reference minus reading, where the reading of now answers the reference of `delay` samples ago.
    ///
    /// Takes the reference of this sample. A delay beyond [`DELAY_MAX`] counts as that.
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
