//! Two-stage touch: an uncertain contact is touched a second time.
//!
//! A workpiece that yields at a few mN shows no more than that step of the force, however deep the tool cuts: the
//! disturbance soon drifts as far. A second touch at the same position shows the step once more, with independent
//! noise, so both log-likelihood ratios add up. A lower level for the first touch only costs time, because noise rarely
//! looks like a contact twice at one position.

use control_blocks::ticks;
use serde::{Deserialize, Serialize};

use crate::interface::{Approach, Parameters};

/// Log-likelihood ratio of both touches together that is a contact: a false alarm in hours.
pub const EVIDENCE: f64 = 24.0;
/// Time for which the first touch continues to become certain, s: the memory of the filter.
pub const DWELL: f64 = 0.01;
/// Time at constant speed before the second touch is evaluated, s: five times that memory.
pub const SETTLE_TIME: f64 = 0.05;
/// Distance between both touches of one contact in addition to the travel of their times, m: run-out and mark.
const SCATTER: f64 = 5e-7;

/// First touch so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Suspicion {
    /// where it began, m
    position: f64,
    /// samples since
    age: u32,
    /// largest log-likelihood ratio so far
    ratio: f64,
}

/// Both touches so far; by default none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwoStageTouch {
    suspicion: Option<Suspicion>,
    /// largest log-likelihood ratio of the second touch
    second: f64,
}

impl TwoStageTouch {
    /// Takes a log-likelihood ratio of the first touch at a position (m); returns whether to touch a second time.
    pub fn suspect(&mut self, p: &Parameters, position: f64, ratio: f64) -> bool {
        match &mut self.suspicion {
            None if ratio > p.touch.suspicion => self.suspicion = Some(Suspicion { position, age: 0, ratio }),
            None => {}
            Some(suspicion) => {
                suspicion.age += 1;
                suspicion.ratio = suspicion.ratio.max(ratio);
            }
        }
        self.suspicion.is_some_and(|suspicion| suspicion.age >= ticks(DWELL, p.sample_period))
    }

    /// Takes a log-likelihood ratio of the second touch at a position (m); returns whether both together are a contact.
    pub fn confirm(&mut self, p: &Parameters, velocity: f64, position: f64, ratio: f64) -> bool {
        self.suspicion.is_some_and(|first| {
            let near = (position - first.position).abs() <= reach(velocity);
            if near {
                self.second = self.second.max(ratio);
            }
            near && self.second > p.touch.suspicion && first.ratio + self.second > EVIDENCE
        })
    }

    /// Whether the position (m) is beyond where the second touch must show a contact.
    pub fn passed(&self, velocity: f64, position: f64) -> bool {
        self.suspicion.is_some_and(|first| position - first.position > reach(velocity))
    }

    /// Distance to retract from here (m) before the second touch: acceleration, settling of the filter, travel to the
    /// contact.
    pub fn retract_distance(&self, approach: &Approach, position: f64) -> f64 {
        let Approach { velocity, acceleration, .. } = *approach;
        let deeper = self.suspicion.map_or(0.0, |first| position - first.position);
        let arming = 0.5 * velocity * velocity / acceleration + velocity * SETTLE_TIME;
        deeper + arming + reach(velocity)
    }
}

/// Maximum distance (m) between both touches of one contact: the first continues for a while and leaves a mark, and the
/// second takes as long to be detected.
fn reach(velocity: f64) -> f64 {
    SCATTER + 2.0 * velocity * DWELL
}

#[cfg(test)]
mod tests {
    use super::*;

    const V: f64 = 1e-4;

    /// 7 for each touch, 24 together, 10 ms at 10 kHz; 2.5 um apart at 100 um/s.
    fn confirming() -> Parameters {
        let mut p = Parameters::START;
        p.touch.confirm = true;
        p
    }

    /// Starts a suspicion at 5 um with the given ratios; returns whether to touch a second time, sample by sample.
    fn suspected(p: &Parameters, ratios: &[f64]) -> (TwoStageTouch, Vec<bool>) {
        let mut touch = TwoStageTouch::default();
        let again =
            ratios.iter().zip(0..).map(|(ratio, k)| touch.suspect(p, 5e-6 + 1e-8 * f64::from(k), *ratio)).collect();
        (touch, again)
    }

    #[test]
    fn a_suspicion_waits_for_its_dwell_and_keeps_the_largest_ratio() {
        let p = confirming();
        let (touch, again) = suspected(&p, &[&[6.9, 7.1, 12.0], &[3.0; 110][..]].concat());
        assert_eq!(again.iter().position(|again| *again), Some(101));
        let first = touch.suspicion.unwrap();
        assert!(first.ratio == 12.0 && (first.position - 5.01e-6).abs() < 1e-15, "{first:?}");
        assert!(suspected(&p, &[6.9; 300]).1.iter().all(|again| !again));
    }

    #[test]
    fn both_touches_together_are_a_contact_near_one_position() {
        let p = confirming();
        let (first, _) = suspected(&p, &[12.0]);
        let second = |position: f64, ratio: f64| first.clone().confirm(&p, V, position, ratio);
        assert!(second(5e-6, 12.1) && !second(5e-6, 11.9));
        assert!(second(7.4e-6, 12.1) && !second(7.6e-6, 12.1) && second(2.6e-6, 12.1) && !second(2.4e-6, 12.1));
        // each alone must be one, too
        let (large, _) = suspected(&p, &[30.0]);
        assert!(large.clone().confirm(&p, V, 5e-6, 7.1) && !large.clone().confirm(&p, V, 5e-6, 6.9));
        assert!(!TwoStageTouch::default().confirm(&p, V, 5e-6, 99.0));
    }

    #[test]
    fn the_position_is_passed_where_no_contact_is_possible_any_more() {
        let p = confirming();
        let (first, _) = suspected(&p, &[12.0]);
        assert!(first.passed(V, 7.51e-6) && !first.passed(V, 7.49e-6));
        // 10 times as fast, 20 um more
        assert!(!first.passed(10.0 * V, 25e-6) && first.passed(10.0 * V, 26e-6));
    }

    #[test]
    fn the_retract_leaves_room_to_arm_before_the_position() {
        let p = confirming();
        let (first, _) = suspected(&p, &[12.0]);
        // 1 um deeper by now; 0.1 um to speed, 50 ms, 2.5 um
        let distance = first.retract_distance(&p.approach, 6e-6);
        assert!((distance - (1.0 + 0.1 + 5.0 + 2.5) * 1e-6).abs() < 1e-12, "{distance}");
    }
}
