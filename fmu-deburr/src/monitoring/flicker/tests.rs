use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::*;

const P: Parameters = Parameters::START;
/// Samples of `expert.transfer.settle_time` that are left where an axis has come to rest, 4/Kp after its model.
const RESTED: u32 = 49;

/// A position of an axis whose model is at rest.
fn measured_at(position: f64) -> AxisPosition {
    AxisPosition { position, model: 0.7 }
}

/// Measurements of axis 3 at a position between two steps with a noise, both in counts, in steps of `step` counts.
fn readings(offset: f64, noise: f64, step: f64, seed: u64) -> impl FnMut() -> f64 {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    move || {
        let normal: f64 = StandardNormal.sample(&mut random);
        ((1e5 + offset + noise * normal) / step).round() * step * P.axis[2].pulse
    }
}

/// Takes `samples` of them at rest, undisturbed.
fn lived(samples: u32, mut reading: impl FnMut() -> f64) -> Flicker {
    let mut flicker = Flicker::default();
    (0..samples).for_each(|_| assert!(!flicker.update(&P, 2, measured_at(reading()), true, true).is_fault()));
    flicker
}

/// Samples after which a constant position is a fault.
fn detected(flicker: &Flicker) -> Option<(u32, Finding)> {
    let (mut flicker, position) = (*flicker, flicker.before.unwrap_or(0.7));
    (1..4000)
        .map(|k| (k, flicker.update(&P, 2, measured_at(position), true, false)))
        .find(|(_, found)| found.is_fault())
}

#[test]
fn one_that_flickered_and_freezes_is_reported_with_its_axis_and_times() {
    for seed in 0..20 {
        let flicker = lived(230, readings(0.05 * seed as f64, 0.5, 1.0, seed));
        let (after, found) = detected(&flicker).unwrap();
        assert_eq!((found.fault, found.numbers.axis, found.numbers.ratio), (Fault::PositionFrozen, 3, None));
        assert!(found.numbers.value > found.numbers.limit && found.numbers.value < found.numbers.limit + 0.011);
        // half a count stands for 55 samples with 1e-9, if one were sure of it
        assert!((55..110).contains(&after), "{after}");
    }
    // a coarser one is reported by its own steps, a wide one after half a second
    assert!(detected(&lived(230, readings(3.0, 5.0, 10.0, 1))).is_some_and(|(after, _)| after < 110));
    let wide = detected(&lived(230, readings(0.0, 3.0, 1.0, 1))).unwrap().1;
    assert!((wide.numbers.value - 0.51).abs() < 1e-9 && wide.numbers.limit == 0.5);
}

#[test]
fn the_end_of_a_run_is_one_test_and_asks_for_less() {
    for seed in 0..10 {
        let mut flicker = lived(90, readings(0.1 * seed as f64, 0.5, 1.0, seed));
        let (always, _) = detected(&flicker).unwrap_or((4000, Finding::NONE));
        let position = flicker.before.unwrap();
        let once = (1..4000).find(|_| {
            flicker.update(&P, 2, measured_at(position), true, false);
            flicker.after_run(&P, 2).is_fault()
        });
        assert!(once.is_some_and(|once| 3 * once <= 2 * always + 3 && once >= 50), "{once:?} {always}");
    }
}

#[test]
fn few_samples_leave_the_noise_uncertain() {
    let after = [60, 120, 1000].map(|samples| detected(&lived(samples, readings(0.0, 0.5, 1.0, 7))).unwrap().0);
    assert!(after.windows(2).all(|pair| pair[0] > pair[1]), "{after:?}");
}

#[test]
fn a_live_reading_is_no_fault_wherever_in_a_step_it_freezes() {
    for (seed, noise) in (0..).zip([0.05, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.7, 2.0]) {
        for offset in [0.0, 0.25, 0.5] {
            let mut flicker = lived(300, readings(offset, noise, 1.0, seed));
            // from then on in the middle of a step
            let mut reading = readings(0.0, noise, 1.0, seed + 100);
            for k in 0..20_000 {
                let found = flicker.update(&P, 2, measured_at(reading()), true, false);
                assert!(!found.is_fault(), "{noise} {offset} {k} {found:?}");
            }
        }
    }
}

#[test]
fn one_between_neighbours_that_only_moves_or_whose_oscillation_dies_away_shows_nothing() {
    let oscillation = |k: u32| 20.0 * (-0.02 * f64::from(k)).exp() * (0.8 * f64::from(k)).sin();
    let cases: [fn(u32) -> f64; 3] = [|k| f64::from(k % 2), |k| f64::from(k), |_| 0.0];
    for reading in cases.into_iter().chain([oscillation as fn(u32) -> f64]) {
        let mut k = 0;
        let flicker = lived(900, || {
            k += 1;
            reading(k).round() * P.axis[2].pulse
        });
        assert_eq!(detected(&flicker), None);
    }
}

#[test]
fn the_motion_during_a_hold_is_no_noise() {
    for seed in 0..10 {
        let (mut flicker, mut reading) =
            (lived(300, readings(0.0, 0.25, 1.0, seed)), readings(2e3, 0.25, 1.0, seed + 50));
        flicker.pause();
        assert!((0..20_000).all(|_| !flicker.update(&P, 2, measured_at(reading()), true, true).is_fault()), "{seed}");
        // and what has frozen afterwards is reported
        let (mut flicker, mut reading) =
            (lived(300, readings(0.0, 0.5, 1.0, seed)), readings(2e3, 0.5, 1.0, seed + 50));
        flicker.pause();
        (0..100).for_each(|_| assert!(!flicker.update(&P, 2, measured_at(reading()), true, true).is_fault()));
        assert!(detected(&flicker).is_some());
    }
}

#[test]
fn what_has_shaken_an_axis_before_it_came_to_rest_is_no_noise() {
    let left = P.transfer.settle_time - 4.0 / P.servo_gain[2];
    assert_eq!((left / P.sample_period).round(), f64::from(RESTED));
    let more = [(0.4, 0.1), (0.5, 0.2), (0.5, 0.25), (0.7, 0.25), (0.7, 0.3)];
    // what a short rest may take for as large
    let hardly = [(0.5, 0.35), (0.5, 0.4), (0.7, 0.5), (0.7, 0.6), (1.0, 0.7), (1.0, 0.8)];
    for (seed, (shaken, noise)) in (0..).zip(more.into_iter().chain(hardly).cycle().take(330)) {
        let offset = 0.1 + 0.2 * (seed % 3) as f64;
        let mut flicker = lived(250, readings(offset, shaken, 1.0, seed));
        flicker.settle();
        let mut reading = readings(offset, noise, 1.0, seed + 1000);
        (0..RESTED).for_each(|_| assert!(!flicker.update(&P, 2, measured_at(reading()), true, true).is_fault()));
        let mut reading = readings(0.0, noise, 1.0, seed + 2000);
        for _ in 0..2000 {
            let found = flicker.update(&P, 2, measured_at(reading()), true, false);
            assert!(!found.is_fault() && !flicker.after_run(&P, 2).is_fault(), "{shaken} {noise} {found:?}");
        }
    }
    // noise that continues is soon known again: a measurement that stands for the rest of a run is reported
    let detections = (0..20).filter(|seed| {
        let (mut flicker, mut reading) =
            (lived(230, readings(0.0, 0.5, 1.0, *seed)), readings(0.0, 0.5, 1.0, seed + 50));
        flicker.settle();
        (0..130).for_each(|_| assert!(!flicker.update(&P, 2, measured_at(reading()), true, true).is_fault()));
        detected(&flicker).is_some_and(|(after, _)| after < 190)
    });
    assert!(detections.count() >= 18);
}

#[test]
fn pushes_and_a_slow_oscillation_of_an_axis_are_no_noise() {
    let push = |k: u32| 30.0 * (-0.13 * f64::from(k % 20)).exp();
    let oscillation = |k: u32| 3.0 * (0.6 * f64::from(k)).sin();
    for reading in [push as fn(u32) -> f64, oscillation] {
        let mut k = 0;
        let flicker = lived(200, || {
            k += 1;
            reading(k).round() * P.axis[2].pulse
        });
        assert!(f64::from(flicker.reversals) >= REVERSALS_MIN);
        assert_eq!(detected(&flicker), None);
    }
}

#[test]
fn what_patterns_move_by_a_count_is_no_reversal() {
    // at the edge of a step a tiny noise flickers, and the patterns of the axis go back and forth
    let flicker = |count: f64| {
        let mut flicker = Flicker::default();
        for k in 0..200u32 {
            let model = count * f64::from(k / 8 % 2);
            let position = (model + f64::from(k % 2)).round() * P.axis[2].pulse;
            flicker.update(&P, 2, AxisPosition { position, model: 0.7 + model * P.axis[2].pulse }, true, true);
        }
        flicker
    };
    assert_eq!((flicker(1.0).reversals, detected(&flicker(1.0))), (0, None));
    // and the noise in addition is still known
    let (mut live, mut reading) = (Flicker::default(), readings(0.0, 0.5, 1.0, 3));
    for k in 0..200u32 {
        let moved = f64::from(k / 8 % 2) * P.axis[2].pulse;
        live.update(&P, 2, AxisPosition { position: reading() + moved, model: 0.7 + moved }, true, true);
    }
    assert!(detected(&live).is_some_and(|(after, _)| after < 110));
}

#[test]
fn three_reversals_by_two_steps_after_the_first_are_noise() {
    // at the edge of a step, and sometimes two steps away
    let after = |excursions: u32| {
        let mut k = 0;
        let flicker = lived(200, || {
            k += 1;
            f64::from(if k % 60 == 50 && k / 60 < excursions { 2 } else { k % 2 }) * P.axis[2].pulse
        });
        detected(&flicker)
    };
    assert_eq!(after(2), None);
    assert!(after(3).is_some());
}

#[test]
fn noise_that_dies_away_in_a_rest_shows_nothing() {
    for seed in 0..10 {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut noise = 20.0;
        let flicker = lived(400, || {
            let normal: f64 = StandardNormal.sample(&mut random);
            noise *= 0.98;
            (noise * normal).round() * P.axis[2].pulse
        });
        assert_eq!(detected(&flicker), None);
    }
}

#[test]
fn noise_before_the_rest_counts_where_it_was_no_larger() {
    let rest = |before: Option<f64>, seed: u64| {
        let mut flicker = before.map_or_else(Flicker::default, |noise| lived(300, readings(0.2, noise, 1.0, seed)));
        flicker.settle();
        let mut reading = readings(0.2, 0.5, 1.0, seed + 50);
        (0..RESTED).for_each(|_| assert!(!flicker.update(&P, 2, measured_at(reading()), true, true).is_fault()));
        detected(&flicker).map_or(4000, |(after, _)| after)
    };
    let each = |before: Option<f64>| (0..10).map(|seed| rest(before, seed)).collect::<Vec<_>>();
    let (alone, same, louder) = (each(None), each(Some(0.5)), each(Some(2.0)));
    assert!(same.iter().sum::<u32>() + 20 < alone.iter().sum::<u32>(), "{same:?} {alone:?}");
    assert!(louder.iter().zip(&alone).all(|(louder, alone)| *louder + 3 > *alone), "{louder:?} {alone:?}");
}

#[test]
fn a_last_bit_of_the_number_is_no_step() {
    let mut k = 0;
    let flicker = lived(900, || {
        k += 1;
        0.7 + P.axis[2].pulse * f64::from(k / 2 % 2) + 1e-12 * f64::from(k % 3)
    });
    assert_eq!(detected(&flicker), None);
}

#[test]
fn what_is_read_in_motion_or_while_the_tool_cuts_is_no_measure() {
    for (rests, undisturbed) in [(false, true), (true, false)] {
        let (mut flicker, mut reading) = (Flicker::default(), readings(0.0, 0.5, 1.0, 3));
        for _ in 0..900 {
            flicker.update(&P, 2, measured_at(reading()), rests, undisturbed);
        }
        assert_eq!(detected(&flicker), None, "{rests} {undisturbed}");
    }
    // what is held begins the stand again, and a motion does not
    for (held, expected) in [(true, false), (false, true)] {
        let mut flicker = lived(1000, readings(0.0, 0.5, 1.0, 3));
        let found = (0..400).any(|k| {
            if held && k % 45 == 0 {
                flicker.pause();
            }
            flicker.update(&P, 2, measured_at(0.7), k % 45 > 0, true).is_fault()
        });
        assert_eq!(found, expected);
    }
}

#[test]
fn reversals_that_are_rare_at_the_edge_of_a_step_show_nothing_of_its_middle() {
    for seed in 0..60 {
        let mut edge = readings(0.5, 0.22, 1.0, seed);
        let mut flicker = Flicker::default();
        (0..100_000).for_each(|_| _ = flicker.watch(&P, 2, measured_at(edge()), true, true));
        let mut middle = readings(0.0, 0.22, 1.0, seed + 1000);
        for k in 0..20_000 {
            let found = flicker.watch(&P, 2, measured_at(middle()), true, true);
            assert!(!found.is_fault(), "{seed}, {k}: {found:?}");
        }
    }
}

#[test]
fn noise_that_falls_in_minutes_has_not_gone_and_one_that_has_is_reported_after_hours() {
    for (seed, falls) in (0..).zip([0.3, 0.25, 0.2, 0.1]) {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut flicker = Flicker::default();
        // half an hour, ten minutes in which it falls, and a quarter of an hour in the middle of a step
        for k in 0..330_000u32 {
            let fraction = (f64::from(k.saturating_sub(180_000)) / 60_000.0).min(1.0);
            let normal: f64 = StandardNormal.sample(&mut random);
            let position = (1e5 + (0.5 + (falls - 0.5) * fraction) * normal).round() * P.axis[2].pulse;
            let found = flicker.watch(&P, 2, measured_at(position), true, true);
            assert!(!found.is_fault(), "{falls}, {k}: {found:?}");
        }
    }
    let frozen = lived(400_000, readings(0.0, 0.5, 1.0, 1));
    assert!(detected(&frozen).is_some_and(|(after, _)| after < 110));
}
