//! Coulomb friction behind a drive: where an axis turns round, and what its drive needs there.
//!
//! With friction F the drive of eq. 1 follows x = G (s - h sgn x'), s the integral of g v and h = F/(m wn^2): G is the same from s and from
//! the force over m wn^2. So x = r asks for s = r/G + h sgn r', which steps by 2 h where the reference turns round, and by h where it
//! begins to move, for nothing tells on which side the drive has come to rest: wrong by h at most. A step of s is a pulse of the
//! command in one sample of h/(g Kp T) for each h. The hold makes a ramp of it about the middle of the sample that begins d samples later; shared
//! by two samples the middle of the ramp is where the reference turns, a fraction of a sample included. What eq. 4 mixes of two
//! patterns keeps its area: at V the samples of a pattern of the speed V_j are passed V_j/V times as often, and the shares in V add up to V.

use crate::learning::rates::Rates;

/// Motions back by less are none, counts.
const LEAST: f64 = 1.0;

/// Tells where an axis (from 0) of the walk turns round, in samples, and by how much the sign of its velocity changes there: 2, or 1 where it
/// begins to move; negative to the other side.
pub fn for_each_turn(rates: &Rates, axis: usize, mut turn: impl FnMut(f64, f64)) {
    let rate = |k: isize| rates.at(k)[axis];
    // direction, place, and the last samples at the lowest and at the highest place since it turned round
    let (mut side, mut place, mut low, mut high) = (0.0, 0.0, (0.0, 0), (0.0, 0));
    for k in 0..rates.count() as isize {
        if place <= low.0 {
            low = (place, k);
        }
        if place >= high.0 {
            high = (place, k);
        }
        let (up, down) = (side <= 0.0 && place > low.0 + LEAST, side >= 0.0 && place < high.0 - LEAST);
        if up || down {
            let (now, at) = if up { (1.0, low.1) } else { (-1.0, high.1) };
            turn(vertex(at, rate(at - 1), rate(at)), now - side);
            (side, low, high) = (now, (place, k), (place, k));
        }
        place += rate(k);
    }
}

/// Place of the extreme between the samples about `at`, of a parabola through them with the rates before and after it.
fn vertex(at: isize, before: f64, after: f64) -> f64 {
    let bend = before - after;
    at as f64 + if bend == 0.0 { 0.0 } else { 0.5 * (before + after) / bend }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use crate::learning::pattern::Pattern;
    use crate::learning::pattern::tests::straight;

    /// Where an axis with these places turns round.
    fn turns(place: impl Fn(f64) -> f64, count: u32) -> Vec<(f64, f64)> {
        let rates: Vec<f64> = (0..count).map(|k| place(f64::from(k) + 1.0) - place(f64::from(k))).collect();
        let mut found = Vec::new();
        for_each_turn(&Rates::of(4, &rates, false), 4, |at, change| found.push((at, change)));
        for_each_turn(&Rates::of(4, &rates, false), 2, |_, _| panic!("an axis that stands"));
        found
    }

    #[test]
    fn a_parabola_turns_at_its_vertex_between_two_samples() {
        for vertex in [30.0, 30.2, 30.5, 30.9] {
            for side in [1.0, -1.0] {
                let found = turns(|k| side * 0.5 * ((k.max(5.0) - vertex).powi(2)), 60);
                assert_eq!(found.len(), 2, "{found:?}");
                // it begins to move at the sample 5
                assert!((found[0].0 - 4.5).abs() < 1e-9 && found[0].1 == -side, "{found:?}");
                assert!((found[1].0 - vertex).abs() < 1e-9 && found[1].1 == 2.0 * side, "{vertex}: {found:?}");
            }
        }
    }

    #[test]
    fn a_rest_on_the_way_is_no_turn_and_one_at_an_end_turns_where_it_ends() {
        // up from 5 on, a rest at 10, up from 20 on, a rest at 30, down from 40 on
        let found = turns(|k| k.clamp(5.0, 10.0) + (k - 20.0).clamp(0.0, 10.0) - (k - 40.0).max(0.0), 60);
        assert_eq!(found, [(4.5, 1.0), (39.5, -2.0)]);
    }

    #[test]
    fn what_is_less_than_a_count_is_no_motion() {
        assert_eq!(turns(|k| 0.49 * (0.3 * k).sin(), 200), []);
        let most = turns(|k| 0.51 * (0.3 * k).sin(), 200);
        assert!(most.len() > 15, "{most:?}");
        assert_eq!(turns(|k| 1e-12 * (7.0 * k).sin(), 200), []);
    }

    #[test]
    fn a_pulse_keeps_its_area_at_any_speed_between_the_patterns() {
        // as many counts in all, played back at any speed and from any place between two samples
        let (p, path) = (Parameters::START, straight(0.3));
        let patterns = [1.0, 0.6, 0.2].map(|factor| {
            let mut pattern = Pattern::plan(&p, &path, factor).unwrap();
            let run = &pattern.samples[pattern.lead_in..pattern.lead_in + pattern.run];
            let k = run.partition_point(|sample| sample.point.distance < 0.15);
            let step = factor * 1e-3;
            let share = (0.15 - run[k - 1].point.distance) / step;
            pattern.add(2, (pattern.lead_in + k) as f64 - 1.0 + share, 60.0);
            pattern
        });
        for speed in [0.1, 0.09, 0.07, 0.06, 0.05, 0.03, 0.02] {
            let (mut least, mut most, mut mean) = (f64::INFINITY, 0.0f64, 0.0);
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
                (least, most, mean) = (least.min(area), most.max(area), mean + area / 20.0);
            }
            println!("{speed}: {least:.1} to {most:.1}, mean {mean:.1}");
            assert!((mean - 60.0).abs() < 1.0 && least > 42.0 && most < 80.0, "{speed}: {least} {most} {mean}");
        }
    }
}
