//! Coulomb friction after a drive: where an axis reverses, and the command that its drive needs there.
//!
//! With friction F the drive of eq. 1 follows x = G (s - h sgn x'), s the integral of g v and h = F/(m wn^2): G is the
//! same from s and from the force over m wn^2. So x = r requires s = r/G + h sgn r', which steps by 2 h where the
//! reference reverses, and by h where it starts to move. The side on which the drive came to rest is unknown; the error
//! is at most h. A step of s is a pulse of the command in one sample of h/(g Kp T) for each h. The hold makes a ramp of
//! it around the middle of the sample that starts d samples later. Distributed over two samples, the middle of the ramp
//! is where the reference reverses, including a fraction of a sample. The mixture of two patterns by eq. 4 keeps its
//! area: at V the samples of a pattern of the speed V_j are passed V_j/V times as often, and the ratios in V sum to V.
//!
//! Between two laps the rest is short: a lap starts on the side on which the previous one ended. Its reversals are
//! therefore those of a walk that continues forever. The seam has one only where an axis reverses there, and the
//! changes sum to 0, so that nothing grows from lap to lap. Only the first lap starts on an unknown side, with an error
//! of at most 2 h.

use crate::learning::rates::Rates;

/// Motions back by less are none, counts.
const TRAVEL_MIN: f64 = 1.0;

/// Reports where an axis (from 0) of the walk reverses, in samples, and the change of the sign of its velocity: 2, or 1
/// where it starts to move; negative in the other direction. Of laps it reports one that follows another; a reversal at
/// the end of the previous one has a position below 0.
pub fn for_each_reversal(rates: &Rates, axis: usize, mut reversal: impl FnMut(f64, f64)) {
    let rate = |k: isize| rates.at(k)[axis];
    // direction, place, and the last samples at the lowest and at the highest place since it turned round
    let (mut side, mut position, mut low, mut high) = (0.0, 0.0, (0.0, 0), (0.0, 0));
    // past its lowest and highest position a walk no longer depends on its start: a lap is walked once for that
    let count = rates.count() as isize;
    let warm_up = if rates.cyclic() { count } else { 0 };
    for k in 0..warm_up + count {
        if position <= low.0 {
            low = (position, k);
        }
        if position >= high.0 {
            high = (position, k);
        }
        let (up, down) = (side <= 0.0 && position > low.0 + TRAVEL_MIN, side >= 0.0 && position < high.0 - TRAVEL_MIN);
        if up || down {
            let (now, at) = if up { (1.0, low.1) } else { (-1.0, high.1) };
            if k >= warm_up {
                reversal((at - warm_up) as f64 + vertex(rate(at - 1), rate(at)), now - side);
            }
            (side, low, high) = (now, (position, k), (position, k));
        }
        position += rate(k);
    }
}

/// Position of the extreme of a parabola through three adjacent samples with the rates before and after it: half a
/// sample away at most.
fn vertex(before: f64, after: f64) -> f64 {
    let bend = before - after;
    if bend == 0.0 { 0.0 } else { (0.5 * (before + after) / bend).clamp(-0.5, 0.5) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use crate::learning::pattern::Pattern;
    use crate::learning::pattern::tests::straight;

    /// Where an axis with these positions reverses.
    fn reversals(position: impl Fn(f64) -> f64, count: u32) -> Vec<(f64, f64)> {
        let rates: Vec<f64> = (0..count).map(|k| position(f64::from(k) + 1.0) - position(f64::from(k))).collect();
        let mut found = Vec::new();
        for_each_reversal(&Rates::of(4, &rates, false), 4, |at, change| found.push((at, change)));
        for_each_reversal(&Rates::of(4, &rates, false), 2, |_, _| panic!("an axis at rest"));
        found
    }

    #[test]
    fn a_parabola_reverses_at_its_vertex_between_two_samples() {
        for vertex in [30.0, 30.2, 30.5, 30.9] {
            for side in [1.0, -1.0] {
                let found = reversals(|k| side * 0.5 * ((k.max(5.0) - vertex).powi(2)), 60);
                assert_eq!(found.len(), 2, "{found:?}");
                // it begins to move at the sample 5
                assert!((found[0].0 - 4.5).abs() < 1e-9 && found[0].1 == -side, "{found:?}");
                assert!((found[1].0 - vertex).abs() < 1e-9 && found[1].1 == 2.0 * side, "{vertex}: {found:?}");
            }
        }
    }

    #[test]
    fn a_rest_in_a_motion_is_no_reversal_and_one_at_an_extreme_reverses_where_it_ends() {
        // up from 5 on, a rest at 10, up from 20 on, a rest at 30, down from 40 on
        let found = reversals(|k| k.clamp(5.0, 10.0) + (k - 20.0).clamp(0.0, 10.0) - (k - 40.0).max(0.0), 60);
        assert_eq!(found, [(4.5, 1.0), (39.5, -2.0)]);
    }

    #[test]
    fn what_is_less_than_a_count_is_no_motion() {
        assert_eq!(reversals(|k| 0.49 * (0.3 * k).sin(), 200), []);
        let maximum = reversals(|k| 0.51 * (0.3 * k).sin(), 200);
        assert!(maximum.len() > 15, "{maximum:?}");
        assert_eq!(reversals(|k| 1e-12 * (7.0 * k).sin(), 200), []);
    }

    /// Where an axis reverses in a lap of these rates.
    fn lap(rates: &[f64]) -> Vec<(f64, f64)> {
        let mut found = Vec::new();
        for_each_reversal(&Rates::of(4, rates, true), 4, |at, change| found.push((at, change)));
        found
    }

    /// Places of a lap of `count` samples, from the sample `from` of another one on.
    fn lap_of(position: impl Fn(f64) -> f64, count: u32, from: u32) -> Vec<f64> {
        (from..from + count).map(|k| position(f64::from((k + 1) % count)) - position(f64::from(k % count))).collect()
    }

    #[test]
    fn an_axis_that_goes_on_across_the_seam_does_not_reverse_there() {
        for side in [1.0, -1.0] {
            let mut rates = [side * 10.0; 60];
            (rates[0], rates[59]) = (side * 2.9, side * 3.0);
            // once round in a lap, as an axis that is unwound elsewhere
            assert_eq!(lap(&rates), []);
            rates.reverse();
            assert_eq!(lap(&rates), []);
            // and back during the motion
            rates[20..40].fill(side * -19.295);
            assert_eq!(lap(&rates).iter().map(|reversal| reversal.1).collect::<Vec<_>>(), [-2.0 * side, 2.0 * side]);
        }
    }

    #[test]
    fn an_axis_that_reverses_at_the_seam_reverses_once_there() {
        // up from rest to rest and back from rest to rest: at the seam and in the middle
        let position = |k: f64| 50.0 * (1.0 - (std::f64::consts::TAU * k / 60.0).cos());
        for side in [1.0, -1.0] {
            let found = lap(&lap_of(|k| side * position(k), 60, 0));
            assert_eq!(found.len(), 2, "{found:?}");
            assert!(found[0].0.abs() < 1e-9 && found[0].1 == 2.0 * side, "{found:?}");
            assert!((found[1].0 - 30.0).abs() < 1e-9 && found[1].1 == -2.0 * side, "{found:?}");
        }
    }

    #[test]
    fn a_lap_has_the_same_reversals_wherever_it_starts_and_they_add_up_to_zero() {
        let position = |k: f64| {
            let angle = std::f64::consts::TAU * (k + 0.3) / 60.0;
            20.0 * angle.sin() + 15.0 * (2.0 * angle).cos() + 0.4 * (11.0 * angle).sin()
        };
        let turns_of = |from: u32| {
            let mut found: Vec<_> = lap(&lap_of(position, 60, from))
                .iter()
                .map(|(at, change)| ((at + f64::from(from)).rem_euclid(60.0), *change))
                .collect();
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            found
        };
        let expected = turns_of(0);
        assert!(expected.len() >= 4 && expected.iter().all(|reversal| reversal.1.abs() == 2.0), "{expected:?}");
        for from in 0..60 {
            let found = turns_of(from);
            assert_eq!(found.iter().map(|reversal| reversal.1).sum::<f64>(), 0.0, "{from}: {found:?}");
            assert_eq!(found.len(), expected.len(), "{from}: {found:?}");
            for (one, other) in found.iter().zip(&expected) {
                assert!((one.0 - other.0).abs() < 1e-6 && one.1 == other.1, "{from}: {found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn a_vertex_is_half_a_sample_away_at_most() {
        assert_eq!([vertex(0.0, 2.0), vertex(-2.0, 0.0), vertex(-1.0, 1.0), vertex(3.0, 3.0)], [-0.5, 0.5, 0.0, 0.0]);
        for (before, after) in [(3.0, 2.9), (2.9, 3.0), (1e-16, 2e-16), (-3.0, -2.9)] {
            assert_eq!(vertex(before, after).abs(), 0.5, "{before} {after}");
        }
    }

    #[test]
    fn a_pulse_keeps_its_area_at_any_speed_between_the_patterns() {
        // as many counts in all, played back at any speed and from any position between two samples
        let (p, path) = (Parameters::START, straight(0.3));
        let patterns = [1.0, 0.6, 0.2].map(|factor| {
            let mut pattern = Pattern::plan(&p, &path, factor).unwrap();
            let run = &pattern.samples[pattern.lead_in..pattern.lead_in + pattern.run];
            let k = run.partition_point(|sample| sample.point.distance < 0.15);
            let step = factor * 1e-3;
            let fraction = (0.15 - run[k - 1].point.distance) / step;
            pattern.add(2, (pattern.lead_in + k) as f64 - 1.0 + fraction, 60.0);
            pattern
        });
        for speed in [0.1, 0.09, 0.07, 0.06, 0.05, 0.03, 0.02] {
            let (mut minimum, mut maximum, mut mean) = (f64::INFINITY, 0.0f64, 0.0);
            for from in 0..20 {
                let mut area = 0.0;
                for k in 0..1000 {
                    let distance = 0.14 + speed * 0.01 * (f64::from(k) + f64::from(from) / 20.0);
                    if distance < 0.16 {
                        let point = crate::path::feed::Point { distance, speed };
                        let look =
                            crate::learning::lookup::PatternLookup { point, back: 0.0, length: 0.3, nominal: None };
                        area += look.compensation(&patterns)[2];
                    }
                }
                (minimum, maximum, mean) = (minimum.min(area), maximum.max(area), mean + area / 20.0);
            }
            println!("{speed}: {minimum:.1} to {maximum:.1}, mean {mean:.1}");
            assert!(
                (mean - 60.0).abs() < 1.0 && minimum > 42.0 && maximum < 80.0,
                "{speed}: {minimum} {maximum} {mean}"
            );
        }
    }
}
