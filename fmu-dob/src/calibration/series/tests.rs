use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const ACTUAL: Bias = Bias { constant: 1.6e-7, fast: 1.3e-7, slow: 3.5e-13 };

/// A whole series whose touches scatter by `sigma` m, and what the three parts leave out at the speeds by `left` m.
fn series(p: &Parameters, seed: u64, sigma: f64, left: f64) -> TouchSeries {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut noise = |deviation: f64| -> f64 { deviation * Distribution::<f64>::sample(&StandardNormal, &mut random) };
    let mut series = TouchSeries::new(p);
    let left: [f64; SPEEDS] = std::array::from_fn(|_| noise(left));
    while !series.over(p) {
        series.take(p, ACTUAL.at(series.velocity()) + left[series.next()] + noise(sigma), 0.0);
    }
    series
}

/// A complete series whose touches at speed `i` are later than the bias by `late(i)` and alternate about that by a
/// spread, m.
fn back_and_forth(p: &Parameters, late: impl Fn(usize) -> [f64; 2]) -> TouchSeries {
    let mut series = TouchSeries::new(p);
    while !series.over(p) {
        let ([late, oscillation], round) = (late(series.next()), series.touches() / SPEEDS as u32);
        series.take(
            p,
            ACTUAL.at(series.velocity()) + late + if round.is_multiple_of(2) { oscillation } else { -oscillation },
            0.0,
        );
    }
    series
}

/// Variance (m2) of four touches that alternate by `oscillation` m, with a step of the encoder.
fn variance(oscillation: f64) -> f64 {
    oscillation * oscillation * 4.0 / 3.0 + 1e-18 / 12.0
}

#[test]
fn it_goes_through_all_speeds_again_and_again() {
    let p = Parameters::START;
    let mut series = TouchSeries::new(&p);
    let mut seen = Vec::new();
    while !series.over(&p) {
        seen.push((1e7 * series.velocity()).round());
        series.take(&p, 0.0, 0.0);
    }
    // 10 to 300 um/s
    assert_eq!((seen.len(), series.touches()), (20, 20));
    assert_eq!(seen[..6], [100.0, 234.0, 548.0, 1282.0, 3000.0, 100.0]);
}

#[test]
fn the_parts_are_found_and_as_certain_as_configured() {
    let p = Parameters::START;
    let exact = series(&p, 1, 0.0, 0.0).conclude(&p, 0).unwrap().0;
    for velocity in [1e-5, 5e-5, 3e-4] {
        assert!((exact.parts().at(velocity) - ACTUAL.at(velocity)).abs() < 1e-12, "{exact:?}");
    }
    let many: Vec<Calibrated> =
        (0..400).map(|seed| series(&p, seed, 2e-8, LEFT_OUT).conclude(&p, 0).unwrap().0).collect();
    let rms = |of: &dyn Fn(&Calibrated) -> f64| (many.iter().map(|t| of(t).powi(2)).sum::<f64>() / 400.0).sqrt();
    for ratio in [
        rms(&|t| (t.bias - ACTUAL.constant) / t.bias_std),
        rms(&|t| (t.bias_fast - ACTUAL.fast) / t.bias_fast_std),
        rms(&|t| (t.bias_slow - ACTUAL.slow) / t.bias_slow_std),
        rms(&|t| (t.scatter - 2e-8) / t.scatter_std),
    ] {
        assert!((0.8..1.2).contains(&ratio), "{ratio}");
    }
    // the uncertainty is largest at the ends of the range, and contains the model error
    let worst = [1e-5, 3e-4].map(|v| rms(&|t| (t.parts().at(v) - ACTUAL.at(v)).hypot(LEFT_OUT) / t.std));
    assert!(worst.iter().all(|ratio| *ratio < 1.2) && worst[0].max(worst[1]) > 0.8, "{worst:?}");
}

#[test]
fn a_speed_whose_touches_scatter_more_is_detected_with_more_and_is_used_for_less() {
    let p = Parameters::START;
    let series = back_and_forth(&p, |i| [0.0, if i == 0 { 5e-8 } else { 5e-9 }]);
    let (calibrated, spread) = series.conclude(&p, 0).unwrap();
    let pooled = (variance(5e-8) + 4.0 * variance(5e-9)) / 5.0;
    assert!((calibrated.scatter / pooled.sqrt() - 1.0).abs() < 1e-9, "{calibrated:?}");
    // three degrees of freedom of its own, and two, less the two of Student's variance
    for (touch, x) in [(spread.touch[0], 5e-8), (spread.touch[4], 5e-9)] {
        assert!((touch / ((2.0 * pooled + 3.0 * variance(x)) / 3.0).sqrt() - 1.0).abs() < 1e-9, "{spread:?}");
    }
    assert_eq!((spread.bias, spread.speeds[0]), ([calibrated.std; SPEEDS], 1e-5));
    // that of the mean at the slowest speed: 44 nm / 2 and the model error, reduced by the other speeds
    let likely = (0.4 * pooled + 0.6 * variance(5e-8)).sqrt();
    assert!((0.7..1.0).contains(&(calibrated.std / (0.5 * likely).hypot(LEFT_OUT))), "{calibrated:?}");
}

#[test]
fn the_slowest_may_be_left_out_and_is_as_uncertain_as_its_touches_are_off() {
    let p = Parameters::START;
    let series = back_and_forth(&p, |i| if i == 0 { [4e-7, 2e-7] } else { [0.0, 5e-9] });
    let (whole, (calibrated, spread)) = (series.conclude(&p, 0).unwrap().0, series.conclude(&p, 1).unwrap());
    assert_eq!((whole.velocity_min, calibrated.velocity_min), (series.speeds[0], series.speeds[1]));
    assert!((calibrated.scatter / variance(5e-9).sqrt() - 1.0).abs() < 1e-9, "{calibrated:?}");
    assert!((calibrated.scatter_std / calibrated.scatter / 24f64.sqrt().recip() - 1.0).abs() < 1e-9, "{calibrated:?}");
    assert!((calibrated.parts().at(1e-4) - ACTUAL.at(1e-4)).abs() < 1e-12, "{calibrated:?}");
    assert!(calibrated.std < 1e-8 && whole.std > 1e-7, "{calibrated:?}");
    // its own scatter alone, by Student; what the others say of it, and that it was 400 nm off
    assert!((spread.touch[0] / (variance(2e-7) * 5.0 / 3.0).sqrt() - 1.0).abs() < 1e-9, "{spread:?}");
    assert!((4e-7..4.1e-7).contains(&spread.bias[0]), "{spread:?}");
    assert!(spread.bias[1..].iter().all(|bias| *bias == calibrated.std), "{spread:?}");
    assert!(series.extremes(0)[1] > 5.5e-7 && series.extremes(1)[1] < 4.5e-7);
}

#[test]
fn a_position_that_is_hardly_known_makes_the_constant_part_less_certain_and_no_other() {
    let mut p = Parameters::START;
    let certain = series(&p, 3, 2e-8, 0.0).conclude(&p, 0).unwrap().0;
    p.calibration.position_std = 1e-7;
    let uncertain = series(&p, 3, 2e-8, 0.0).conclude(&p, 0).unwrap().0;
    assert!((uncertain.bias_std.powi(2) - certain.bias_std.powi(2) - 1e-14).abs() < 1e-20);
    assert!((uncertain.std.powi(2) - certain.std.powi(2) - 1e-14).abs() < 1e-20);
    assert_eq!(uncertain.bias_fast_std, certain.bias_fast_std);
}

#[test]
fn no_bias_is_more_certain_than_what_the_three_parts_leave_out() {
    let p = Parameters::START;
    let calibrated = series(&p, 4, 0.0, 0.0).conclude(&p, 0).unwrap().0;
    assert!((1.0..1.5).contains(&(calibrated.std / LEFT_OUT)), "{calibrated:?}");
    assert!(calibrated.bias_std > 0.3 * LEFT_OUT, "{calibrated:?}");
}

#[test]
fn what_the_three_parts_do_not_explain_makes_them_less_certain() {
    let p = Parameters::START;
    let bent = |by: f64| {
        let series = back_and_forth(&p, |i| [if i == 2 { by } else { 0.0 }, 1e-8]);
        series.conclude(&p, 0).unwrap().0.std
    };
    assert!(bent(1e-7) > 3.0 * bent(0.0), "{} {}", bent(1e-7), bent(0.0));
}

#[test]
fn the_rounds_spread_over_half_a_revolution_of_the_spindle_after_any_number_of_touches() {
    for between in 1..SPEEDS {
        let mut series = TouchSeries::new(&Parameters::START);
        let mut fractions: Vec<f64> = (0..5)
            .map(|_| {
                // 10 ms per revolution, in both directions
                let pause = series.pause(TAU / 0.01);
                assert_eq!((pause, 0.0, 0.0), (series.pause(-TAU / 0.01), series.pause(0.0), series.pause(TAU / 0.1)));
                (0..SPEEDS).for_each(|_| series.take(&Parameters::START, 0.0, 0.0));
                (between as f64 * pause / 0.01 * 2.0 + 0.05).fract()
            })
            .collect();
        fractions.sort_by(f64::total_cmp);
        assert!(
            fractions.iter().zip(0..).all(|(fraction, k)| (fraction - 0.05 - 0.2 * f64::from(k)).abs() < 1e-9),
            "{fractions:?}"
        );
    }
}

#[test]
fn the_extremes_are_means_of_a_speed() {
    let p = Parameters::START;
    let mut series = TouchSeries::new(&p);
    while !series.over(&p) {
        let late = [3e-7, -1e-7, 2e-7, 2e-7, 2e-7][series.next()];
        series.take(&p, late + if series.touches() < 5 { 1e-8 } else { 0.0 }, 0.0);
    }
    let [minimum, maximum] = series.extremes(0);
    assert!((minimum + 9.75e-8).abs() < 1e-15 && (maximum - 3.025e-7).abs() < 1e-15, "{minimum} {maximum}");
}

/// A series whose touches press as `force` says (N) of their speed (m/s), after the first round; or the error that ends
/// it.
fn pressed(p: &Parameters, force: impl Fn(f64) -> f64) -> Result<TouchSeries, f64> {
    let mut series = TouchSeries::new(p);
    while series.touches < SPEEDS as u32 {
        series.take(p, 1e-7, force(series.velocity()));
        series.lower(p)?;
    }
    Ok(series)
}

fn speeds(series: &TouchSeries) -> [f64; SPEEDS] {
    series.speeds.map(|speed| (1e7 * speed).round() / 10.0)
}

#[test]
fn hard_workpiece_lowers_the_speeds_that_are_still_to_come() {
    let mut p = Parameters::START;
    let hard = |slope: f64| move |velocity: f64| slope * velocity;
    // no limit, however hard
    assert_eq!(speeds(&pressed(&p, hard(1e6)).unwrap()), [10.0, 23.4, 54.8, 128.2, 300.0]);
    p.calibration.force_max = 0.8;
    // allowed: 0.8 N minus 30 % of mass, 20 % of scatter and 60 % of extrapolation
    let at = |speed: f64| 0.8 / (1.3 * 1.2 * 1.6 * 1e-6 * speed);
    for (slope, expected) in [
        (at(300.1), [10.0, 23.4, 54.8, 128.2, 300.0]),
        (at(200.0), [10.0, 23.4, 54.8, 128.2, 200.0]),
        (at(50.0), [10.0, 23.4, 30.1, 38.8, 50.0]),
    ] {
        let series = pressed(&p, hard(slope)).unwrap();
        assert_eq!((speeds(&series), series.touches()), (expected, 5), "{slope}");
    }
    // three times the slowest, and a little less
    let fastest = |slope: f64| pressed(&p, hard(slope)).map(|series| speeds(&series)[SPEEDS - 1]);
    assert_eq!(fastest(at(30.001)), Ok(30.0));
    assert!(fastest(at(29.9)).is_err_and(|speed| (speed - 29.9e-6).abs() < 1e-12));
}

#[test]
fn the_fastest_touch_of_the_first_round_is_discarded_where_others_may_press_too_hard() {
    let mut p = Parameters::START;
    p.calibration.force_max = 0.8;
    // all five allow 300 um/s up to 0.8 N minus 30 % of mass and 20 % of scatter
    let after = |force: f64| {
        let hard = |velocity: f64| if velocity > 2.99e-4 { force } else { 1000.0 * velocity };
        let series = pressed(&p, hard).unwrap();
        (speeds(&series), series.touches())
    };
    assert_eq!(after(0.55), ([10.0, 23.4, 54.8, 128.2, 300.0], 5));
    assert_eq!(after(0.57), ([10.0, 23.4, 54.8, 128.2, 295.4], 6));
    assert_eq!(after(2.0), ([10.0, 23.4, 54.8, 70.6, 91.0], 7));
}

#[test]
fn a_touch_that_has_pressed_too_hard_is_discarded_and_is_used_for_how_often_more_may_follow() {
    let mut p = Parameters::START;
    (p.calibration.force_max, p.calibration.touches, p.calibration.touches_max) = (0.8, 2, 4);
    let mut given_up = false;
    let mut series = TouchSeries::new(&p);
    while !series.over(&p) {
        let jump = !given_up && series.next() == 2;
        given_up |= jump;
        // 0.5 N at 54.8 um/s: all three touches allow 37 um/s
        series.take(&p, ACTUAL.at(series.velocity()), if jump { 0.5 } else { 1000.0 * series.velocity() });
        series.lower(&p).unwrap();
    }
    let speeds = speeds(&series);
    assert!(given_up && speeds[1] == 23.4 && speeds[4] > 35.0 && speeds[4] < 53.0, "{speeds:?}");
    assert!((speeds[3] / speeds[2] - speeds[4] / speeds[3]).abs() < 0.01, "{speeds:?}");
    assert_eq!((series.touches(), series.touches), (11, 10));
    let (calibrated, spread) = series.conclude(&p, 0).unwrap();
    assert_eq!((calibrated.touches, calibrated.velocity_max, spread.speeds), (11, series.speeds[4], series.speeds));
    // the bias is that of the speeds that were touched
    assert!((calibrated.parts().at(4e-5) - ACTUAL.at(4e-5)).abs() < 1e-12, "{calibrated:?}");
    // 16 of at most 20, and 21 are too many
    assert!(series.once_more(&p));
    (0..SPEEDS).for_each(|_| series.take(&p, 0.0, 9.0));
    assert_eq!(series.lower(&p), Ok(()));
    assert!(series.over(&p) && !series.once_more(&p));
}

#[test]
fn workpiece_that_fast_touches_find_harder_discards_a_few_touches_at_most() {
    let mut p = Parameters::START;
    p.calibration.force_max = 0.8;
    for harder in [1.87, 1.9, 2.0, 2.5, 4.0] {
        let mut series = TouchSeries::new(&p);
        while series.touches < SPEEDS as u32 && series.touches() < 1000 {
            let slope = if series.velocity() > 1.3e-4 { harder * 1000.0 } else { 1000.0 };
            series.take(&p, 1e-7, slope * series.velocity());
            series.lower(&p).unwrap();
        }
        assert!(series.touches() <= 8, "{harder}: {} touches", series.touches());
        assert!(harder * 1000.0 * series.speeds[SPEEDS - 1] < 0.8 / (HEAVIER * SCATTER) * 1.05, "{harder}");
    }
}

#[test]
fn slow_touches_show_the_force_only_before_there_is_a_fast_one_and_then_the_hardest_of_these_does() {
    let mut p = Parameters::START;
    p.calibration.force_max = 0.8;
    let hard = |velocities: std::ops::Range<f64>, slope: f64| {
        let force = |v: f64| v * if velocities.contains(&v) { slope } else { 1000.0 };
        speeds(&pressed(&p, force).unwrap())
    };
    // below 30 um/s; they would allow 80 um/s
    assert_eq!(hard(0.0..3e-5, 4000.0), [10.0, 23.4, 54.8, 128.2, 300.0]);
    assert_eq!(hard(5e-5..6e-5, 2400.0), [10.0, 23.4, 54.8, 128.2, 133.5]);
}

#[test]
fn touches_that_are_discarded_again_leave_three_to_one_where_that_is_allowed() {
    let mut p = Parameters::START;
    p.calibration.force_max = 0.8;
    let mut series = TouchSeries::new(&p);
    for force in [0.01, 0.023, 0.055, 0.128, 0.57] {
        series.take(&p, 1e-7, force);
        assert_eq!(series.lower(&p), Ok(()));
    }
    assert_eq!((speeds(&series)[SPEEDS - 1].round(), series.given_up), (296.0, 1));
    // all six allow 31.5 um/s
    series.take(&p, 1e-7, 10.23);
    assert_eq!((series.lower(&p), speeds(&series)[SPEEDS - 1], series.given_up), (Ok(()), 30.0, 4));
}
