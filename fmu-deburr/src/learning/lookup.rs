//! Eq. 2 to 4: the compensation for any speed, between the patterns of the speeds that were learned.

use crate::learning::pattern::{Pattern, mix};
use crate::path::feed::Point;
use crate::path::kinematics::{AXES, Joints};

/// Speeds that differ by less are one, m/s.
const SPEED_TOLERANCE: f64 = 5e-4;
/// Above the fastest pattern it is enlarged up to this factor.
const SCALE_MAX: f64 = 1.1;

/// Position on the path and speed for which a compensation is looked up, with the settings of the lookup.
#[derive(Clone, Copy, Debug)]
pub struct PatternLookup {
    /// Distance along the path (m) and speed of the run (m/s), which is compared with the speeds of the patterns there.
    pub point: Point,
    /// Samples before that position at which the compensation is read from a pattern.
    pub back: f64,
    /// Length of the path, m.
    pub length: f64,
    /// Compare with the nominal speed of the pattern, `factor * programmed` (m/s), instead of the recorded one.
    pub nominal: Option<f64>,
}

impl PatternLookup {
    /// Compensation in pulses, not rounded; `patterns` from the fastest to the slowest.
    pub fn compensation(&self, patterns: &[Pattern]) -> Joints {
        let speed = self.point.speed;
        let Some((fastest, slower)) = patterns.split_first() else { return [0.0; AXES] };
        let mut upper = self.of(fastest);
        if speed >= upper.1 {
            let scale = if upper.1 > SPEED_TOLERANCE { (speed / upper.1).min(SCALE_MAX) } else { 1.0 };
            return upper.0.map(|value| value * scale);
        }
        for pattern in slower {
            let lower = self.of(pattern);
            if speed >= lower.1 {
                return between(upper, lower, speed);
            }
            upper = lower;
        }
        // below the slowest: the compensation is nearly proportional to the speed
        between(upper, ([0.0; AXES], 0.0), speed)
    }

    fn of(&self, pattern: &Pattern) -> (Joints, f64) {
        let (compensation, recorded) = pattern.at(self.point.distance, self.back, self.length);
        (compensation, self.nominal.map_or(recorded, |programmed| programmed * pattern.factor))
    }
}

/// Eq. 4: C* = CU + (CL - CU) (V* - VU) / (VL - VU).
fn between(upper: (Joints, f64), lower: (Joints, f64), speed: f64) -> Joints {
    if upper.1 - lower.1 < SPEED_TOLERANCE {
        return upper.0;
    }
    mix(&upper.0, &lower.0, (speed - upper.1) / (lower.1 - upper.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use crate::learning::pattern::tests::straight;

    const LENGTH: f64 = 0.3;

    /// Patterns whose compensation is proportional to the speed.
    fn patterns() -> Vec<Pattern> {
        let (p, path) = (Parameters::START, straight(LENGTH));
        [1.0, 0.6, 0.2]
            .map(|factor| {
                let mut pattern = Pattern::plan(&p, &path, factor).unwrap();
                for sample in &mut pattern.samples {
                    sample.compensation = [1e4 * sample.point.speed; AXES];
                }
                pattern
            })
            .into()
    }

    fn at(distance: f64, speed: f64, nominal: Option<f64>) -> f64 {
        let lookup = PatternLookup { point: Point { distance, speed }, back: 0.0, length: LENGTH, nominal };
        lookup.compensation(&patterns())[0]
    }

    #[test]
    fn in_the_middle_every_speed_has_its_weight_also_below_the_slowest() {
        for speed in [0.1, 0.09, 0.06, 0.05, 0.02, 0.011, 0.003, 0.0] {
            assert!((at(0.15, speed, None) - 1e4 * speed).abs() < 1e-6, "{speed}");
        }
    }

    #[test]
    fn above_the_fastest_it_grows_by_a_tenth_at_most() {
        assert!((at(0.15, 0.105, None) - 1050.0).abs() < 1e-6);
        assert!((at(0.15, 0.2, None) - 1100.0).abs() < 1e-6);
    }

    #[test]
    fn near_the_ends_the_recorded_speed_is_right_and_the_nominal_one_is_not() {
        // all patterns have the same speed there
        let speed = patterns()[0].samples[12].point.speed;
        let distance = patterns()[0].samples[12].point.distance;
        assert!((at(distance, speed, None) - 1e4 * speed).abs() < 1e-6);
        assert!((at(distance, speed, Some(0.1)) - 1e4 * speed).abs() > 10.0);
    }

    #[test]
    fn without_patterns_there_is_no_compensation() {
        let lookup =
            PatternLookup { point: Point { distance: 0.1, speed: 0.1 }, back: 0.0, length: LENGTH, nominal: None };
        assert_eq!(lookup.compensation(&[]), [0.0; AXES]);
    }

    #[test]
    fn the_nominal_speed_of_a_pattern_is_its_multiple_of_the_programmed_one() {
        // in the middle both are the same
        for speed in [0.1, 0.08, 0.06, 0.04, 0.02, 0.01] {
            assert!((at(0.15, speed, Some(0.1)) - 1e4 * speed).abs() < 1e-6, "{speed}");
        }
    }

    #[test]
    fn speeds_within_half_a_millimetre_a_second_are_one() {
        let with = |upper: f64, lower: f64, speed: f64| between(([8.0; AXES], upper), ([2.0; AXES], lower), speed)[0];
        assert_eq!(with(0.1, 0.0996, 0.0997), 8.0);
        assert!((with(0.1, 0.0994, 0.0997) - 5.0).abs() < 1e-9);
        // a pattern at rest is not enlarged
        let lookup = |speed: f64| {
            let point = Point { distance: LENGTH, speed };
            let mut pattern = patterns().swap_remove(0);
            pattern.samples.iter_mut().for_each(|sample| sample.compensation = [100.0; AXES]);
            PatternLookup { point, back: 0.0, length: LENGTH, nominal: None }.compensation(&[pattern])[0]
        };
        assert_eq!((lookup(0.0), lookup(0.01)), (100.0, 100.0));
    }
}
