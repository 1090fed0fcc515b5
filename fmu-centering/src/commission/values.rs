//! Parameters that a commissioning run derives, and whether its result can be used.

use control_blocks::{DELAY_MAX, RATIO_MAX, is_certain, whole_delay, within_factor};
use serde::{Deserialize, Serialize};

use crate::commission::response::braked_late;
use crate::interface::{Measured, Parameters};
use crate::limits::{servo_damping, slowest_servo};

/// Largest relative standard deviation of the bandwidth: the feed-forward has twice that error.
pub const STD_MAX: f64 = 0.02;
/// Largest standard deviation of the delay, samples: two of them reach the next half sample.
pub const DELAY_STD_MAX: f64 = 0.25;

/// All parameters that a commissioning run derives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    bandwidth: f64,
    io_delay: i32,
}

impl Values {
    /// Those of the parameters.
    pub fn of(p: &Parameters) -> Self {
        Self { bandwidth: p.slide.bandwidth, io_delay: p.io_delay }
    }

    /// Puts them into the parameters.
    pub fn put(&self, p: &mut Parameters) {
        (p.slide.bandwidth, p.io_delay) = (self.bandwidth, self.io_delay);
    }

    /// Their names and values.
    pub fn entries(&self) -> [(&'static str, f64); 2] {
        [("slide.bandwidth", self.bandwidth), ("io_delay", f64::from(self.io_delay))]
    }

    /// Values with the measured results; a configured bandwidth of 0, for no feed-forward, stays 0.
    pub fn derived(self, measured: &Measured) -> Self {
        let bandwidth = if self.bandwidth > 0.0 { measured.slide_bandwidth } else { 0.0 };
        Self { bandwidth, io_delay: whole_delay(measured.io_delay) }
    }

    /// Whether a measurement is certain, and of a servo that this controller can work with. The slowest servo is the only
    /// condition that the checks of the parameters impose on derived values. `shift` (samples) is the change of the
    /// delay in the last round. The effect of servo steps rejects nothing: the servo acts as identified.
    pub fn accept(&self, p: &Parameters, m: &Measured, shift: f64) -> bool {
        is_certain(m.slide_bandwidth, m.slide_bandwidth_std, STD_MAX.hypot(braked_late(p, m)))
            && m.io_delay_std.max(shift.abs()) <= DELAY_STD_MAX
            && m.slide_bandwidth >= slowest_servo(p)
            && servo_damping(p, m.slide_bandwidth).contains(&m.slide_damping)
            && (self.bandwidth == 0.0 || within_factor(m.slide_bandwidth, self.bandwidth, RATIO_MAX))
            && (0..=DELAY_MAX as i32).contains(&whole_delay(m.io_delay))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::check;
    use std::f64::consts::TAU;

    const P: Parameters = Parameters::START;
    /// A good measurement of a servo of 30 Hz that acts two samples late.
    const GOOD: Measured = Measured {
        slide_bandwidth: TAU * 30.0,
        slide_bandwidth_std: 0.1,
        slide_damping: 0.7,
        io_delay: 1.9,
        io_delay_std: 0.01,
        ..Measured::START
    };

    #[test]
    fn what_is_put_is_what_was_taken() {
        let mut p = P;
        Values::of(&P).put(&mut p);
        assert_eq!(p, P);
        let values = Values::of(&P).derived(&GOOD);
        values.put(&mut p);
        assert_eq!((Values::of(&p), p.slide.bandwidth, p.io_delay), (values, TAU * 30.0, 2));
        assert_eq!(values.entries(), [("slide.bandwidth", TAU * 30.0), ("io_delay", 2.0)]);
        // no feed-forward stays none
        p.slide.bandwidth = 0.0;
        assert_eq!(Values::of(&p).derived(&GOOD).bandwidth, 0.0);
        assert!(Values::of(&p).accept(&p, &GOOD, 0.0));
    }

    #[test]
    fn each_limit_is_the_last_value_that_is_accepted() {
        type Set = fn(&mut Measured, f64);
        let limits: [(Set, f64, f64); 8] = [
            (|m, x| m.slide_bandwidth_std = x * TAU * 30.0, 0.021_05, 0.021_07),
            (|m, x| m.io_delay_std = x, 0.25, 0.251),
            (|m, x| m.slide_bandwidth = TAU * x, 79.9, 80.1),
            (|m, x| m.slide_bandwidth = TAU * x, 20.1, 19.9),
            // 60 /s over 30 Hz, and where that takes 45 degrees
            (|m, x| m.slide_damping = x, 0.32, 0.316),
            (|m, x| m.slide_damping = x, 1.411, 1.412),
            (|m, x| m.io_delay = x, 8.49, 8.5),
            (|m, x| m.io_delay = x, -0.49, -0.5),
        ];
        for (set, last, first) in limits {
            let with = |x: f64| {
                let mut m = GOOD;
                set(&mut m, x);
                Values::of(&P).accept(&P, &m, 0.0)
            };
            assert_eq!((with(last), with(first)), (true, false), "{last} {first}");
        }
        let shifted = |shift: f64| Values::of(&P).accept(&P, &GOOD, shift);
        assert!(shifted(-0.25) && !shifted(-0.26) && !shifted(0.26));
        assert!(!Values::of(&P).accept(&P, &Measured::START, 0.0));
        // slower than 13.9 Hz the slide does not keep to 1 mm; the feedback of a push asks for more
        let mut slow = P;
        (slow.slide.bandwidth, slow.stroke.feedback) = (TAU * 20.0, 0.0);
        let at = |hertz: f64| {
            let m = Measured { slide_bandwidth: TAU * hertz, ..GOOD };
            Values::of(&slow).accept(&slow, &m, 0.0)
        };
        assert!(at(14.0) && !at(13.9));
        // and the checks of the parameters say the same
        for (hertz, fits) in [(14.0, true), (13.9, false)] {
            let mut p = slow.clone();
            Values::of(&slow).derived(&Measured { slide_bandwidth: TAU * hertz, ..GOOD }).put(&mut p);
            assert_eq!(check(&p).is_ok(), fits, "{hertz}: {:?}", check(&p));
        }
    }
}
