//! Two-stage touch: what looks like a contact but is not sure of it is touched again.
//!
//! Work that yields at some mN tells no more than its step of the force, however deep the tool goes: soon the disturbance has wandered
//! as far. A second touch of the same place tells it once more, with noise of its own, so both log-likelihood ratios add up.
//! A lower level for the first touch costs time alone, as noise hardly looks like a contact twice at one place.

use control_blocks::ticks;
use serde::{Deserialize, Serialize};

use crate::interface::{Approach, Parameters};

/// What the first touch has shown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Suspicion {
    /// where it began, m
    position: f64,
    /// samples since
    age: u32,
    /// largest log-likelihood ratio so far
    ratio: f64,
}

/// What is known of a contact so far; by default nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwoStageTouch {
    suspicion: Option<Suspicion>,
    /// largest log-likelihood ratio of the second touch
    second: f64,
}

impl TwoStageTouch {
    /// Takes a log-likelihood ratio of the first touch at a position (m); whether the place is to be touched again.
    pub fn suspect(&mut self, p: &Parameters, position: f64, ratio: f64) -> bool {
        match &mut self.suspicion {
            None if ratio > p.touch.suspicion => self.suspicion = Some(Suspicion { position, age: 0, ratio }),
            None => {}
            Some(suspicion) => {
                suspicion.age += 1;
                suspicion.ratio = suspicion.ratio.max(ratio);
            }
        }
        self.suspicion.is_some_and(|suspicion| suspicion.age >= ticks(p.touch.dwell, p.sample_period))
    }

    /// Takes a log-likelihood ratio of the second touch at a position (m); whether both together are a contact.
    pub fn confirm(&mut self, p: &Parameters, velocity: f64, position: f64, ratio: f64) -> bool {
        self.suspicion.is_some_and(|first| {
            let near = (position - first.position).abs() <= reach(p, velocity);
            if near {
                self.second = self.second.max(ratio);
            }
            near && self.second > p.touch.suspicion && first.ratio + self.second > p.touch.evidence
        })
    }

    /// Whether the position (m) is beyond where the second touch must show a contact.
    pub fn passed(&self, p: &Parameters, velocity: f64, position: f64) -> bool {
        self.suspicion.is_some_and(|first| position - first.position > reach(p, velocity))
    }

    /// Way back from here (m) before the second touch: to speed, until the filter has forgotten that, and up to the place.
    pub fn way_back(&self, p: &Parameters, approach: &Approach, position: f64) -> f64 {
        let Approach { velocity, acceleration, .. } = *approach;
        let deeper = self.suspicion.map_or(0.0, |first| position - first.position);
        let arming = 0.5 * velocity * velocity / acceleration + velocity * p.touch.settle_time;
        deeper + arming + reach(p, velocity)
    }
}

/// How far apart (m) both touches of one contact may be: the first goes on for a while and leaves a mark, the second takes as long to be seen.
fn reach(p: &Parameters, velocity: f64) -> f64 {
    p.touch.scatter + 2.0 * velocity * p.touch.dwell
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

    /// Begins a suspicion at 5 um with the ratios that are told; whether it is to be touched again, sample by sample.
    fn suspected(p: &Parameters, ratios: &[f64]) -> (TwoStageTouch, Vec<bool>) {
        let mut touch = TwoStageTouch::default();
        let told =
            ratios.iter().zip(0..).map(|(ratio, k)| touch.suspect(p, 5e-6 + 1e-8 * f64::from(k), *ratio)).collect();
        (touch, told)
    }

    #[test]
    fn a_suspicion_waits_for_its_dwell_and_keeps_the_largest_ratio() {
        let p = confirming();
        let (touch, told) = suspected(&p, &[&[6.9, 7.1, 12.0], &[3.0; 110][..]].concat());
        assert_eq!(told.iter().position(|again| *again), Some(101));
        let first = touch.suspicion.unwrap();
        assert!(first.ratio == 12.0 && (first.position - 5.01e-6).abs() < 1e-15, "{first:?}");
        assert!(suspected(&p, &[6.9; 300]).1.iter().all(|again| !again));
    }

    #[test]
    fn both_touches_together_are_a_contact_near_one_place() {
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
    fn the_place_is_passed_where_no_contact_can_be_any_more() {
        let p = confirming();
        let (first, _) = suspected(&p, &[12.0]);
        assert!(first.passed(&p, V, 7.51e-6) && !first.passed(&p, V, 7.49e-6));
        // 10 times as fast, 20 um more
        assert!(!first.passed(&p, 10.0 * V, 25e-6) && first.passed(&p, 10.0 * V, 26e-6));
    }

    #[test]
    fn the_way_back_leaves_room_to_arm_before_the_place() {
        let p = confirming();
        let (first, _) = suspected(&p, &[12.0]);
        // 1 um deeper by now; 0.1 um to speed, 50 ms, 2.5 um
        let way = first.way_back(&p, &p.approach, 6e-6);
        assert!((way - (1.0 + 0.1 + 5.0 + 2.5) * 1e-6).abs() < 1e-12, "{way}");
    }
}
