use std::f64::consts::TAU;

use super::*;

const ASSUMED: Assumptions =
    Assumptions { radius: 0.05, noise: 1e-7, center: 5e-3, form: 2e-6, gate: 6.0, rejections_max: 5 };

/// y = s - q of an ideal ring with two and three lobes, exact.
fn ring(center: Vector2<f64>, angle: f64) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    let (x, y) = (cosine * center.x - sine * center.y, sine * center.x + cosine * center.y);
    let lobes = |phi: f64| 0.05 + 2e-6 * (2.0 * phi + 0.3).cos() + 1e-6 * (3.0 * phi - 1.0).cos();
    let mut phi = 0.0;
    for _ in 0..20 {
        phi = -(y / lobes(phi - angle)).asin();
    }
    0.123 - x - (lobes(phi - angle).powi(2) - y * y).sqrt()
}

/// Model after `count` samples over `revolutions` revolutions.
fn seen(center: Vector2<f64>, revolutions: f64, count: u32) -> RingModel {
    let mut model = RingModel::new(ASSUMED);
    for k in 0..count {
        let angle = TAU * revolutions * f64::from(k) / f64::from(count);
        model.observe(angle, ring(center, angle));
        model.refine();
    }
    model
}

#[test]
fn one_revolution_gives_center_line_and_form() {
    for center in [Vector2::new(3e-4, -2e-4), Vector2::new(0.0, 3e-3), Vector2::new(-0.014, 0.014)] {
        let model = seen(center, 1.0, 200);
        assert!((model.center() - center).norm() < 1e-7, "{}", model.center() - center);
        assert!((model.mean_line() - 0.073).abs() < 1e-7);
        let angle = 0.7;
        let centered = ring(Vector2::zeros(), angle);
        assert!((model.centered_line(angle) - centered).abs() < 5e-8);
    }
}

#[test]
fn the_standard_deviation_is_honest_on_a_part_of_a_revolution() {
    let center = Vector2::new(2e-4, 3e-4);
    for revolutions in [0.2, 0.3, 0.5, 0.8] {
        let model = seen(center, revolutions, 100);
        let error = model.eccentricity() - center.norm();
        assert!(error.abs() < 3.0 * model.center_sigma() + 1e-8, "{revolutions}: {error}");
    }
    let sigmas = [0.2, 0.4, 0.8].map(|revolutions| seen(center, revolutions, 100).center_sigma());
    assert!(sigmas[0] > sigmas[1] && sigmas[1] > sigmas[2] && sigmas[2] < 2e-7, "{sigmas:?}");
}

#[test]
fn after_a_push_a_tenth_of_a_revolution_is_enough() {
    let mut model = seen(Vector2::new(4e-4, 0.0), 1.0, 200);
    model.displaced(Vector2::zeros(), 1e-4);
    let center = Vector2::new(-2e-5, 3e-5);
    for k in 0..20 {
        let angle = TAU * (1.0 + 0.1 * f64::from(k) / 20.0);
        model.observe(angle, ring(center, angle));
    }
    assert!((model.center() - center).norm() < 1e-6, "{}", model.center() - center);
}

#[test]
fn dirt_is_rejected_and_a_moved_ring_is_lost() {
    let center = Vector2::new(4e-4, 1e-4);
    let mut model = seen(center, 1.0, 200);
    assert!(!model.observe(0.5, ring(center, 0.5) + 2e-5) && !model.lost());
    assert!((model.center() - center).norm() < 2e-8);
    // five more
    for k in 0..5 {
        assert!(!model.lost(), "{k}");
        let angle = TAU * f64::from(k) / 200.0;
        model.observe(angle, ring(Vector2::new(1e-4, 3e-4), angle));
    }
    assert!(model.lost());
}

/// Adds a measurement and makes all passes of the fit that it starts; false if the ring must have been moved.
fn take(model: &mut RingModel, angle: f64, y: f64) -> bool {
    model.observe(angle, y);
    settle(model)
}

/// Makes all passes of the active fit; false if the ring must have been moved.
fn settle(model: &mut RingModel) -> bool {
    (0..20).all(|_| model.advance())
}

/// Rough at random, m: a golden section of a sine of the amplitude 0.15 um.
fn rough(k: u32) -> f64 {
    1.5e-7 * (2.399_963 * f64::from(k * k)).sin()
}

/// Model of a ring with one more lobe of this number of waves after a revolution, and its center.
fn lobed(waves: f64, lobe: f64, noise_std: f64) -> (RingModel, Vector2<f64>) {
    let center = Vector2::new(2e-4, 1e-4);
    let mut model = RingModel::new(Assumptions { noise: noise_std, ..ASSUMED });
    for k in 0..200 {
        let angle = TAU * f64::from(k) / 200.0;
        if !take(&mut model, angle, ring(center, angle) + lobe * (waves * angle + 0.4).cos() + rough(k)) {
            // so few were measured that another ring is as likely
            assert!(model.history.len() <= 2 * GROUND, "{k}");
            model = RingModel::new(model.assumed);
        }
        if k % 7 == 6 {
            model.refine();
            settle(&mut model);
        }
    }
    (model, center)
}

#[test]
fn a_lobe_of_any_order_to_twenty_is_form_and_no_noise() {
    for waves in [7.0, 9.0, 12.0, 16.0, 20.0] {
        for noise in [2e-7, 6e-7] {
            let (model, center) = lobed(waves, 5e-6, noise);
            let (error, sigma) = ((model.center() - center).norm(), model.center_sigma());
            assert!(model.any.is_some(), "{waves}, {noise}");
            assert!(error < 4.0 * sigma && sigma < 1.2e-7, "{waves}, {noise}: {error} of {sigma} m");
            assert!(model.misfit() < 3.0, "{waves}, {noise}: {}", model.misfit());
        }
    }
}

#[test]
fn a_ring_is_widened_where_it_leaves_the_ground_one_by_three_times_the_noise() {
    let revolution = |form: f64, deviation: f64| {
        let mut model = RingModel::new(Assumptions { form, noise: 2e-7, ..ASSUMED });
        for k in 0..200 {
            let angle = TAU * f64::from(k) / 200.0;
            // a sine over the root of two is its deviation
            model.observe(
                angle,
                ring(Vector2::zeros(), angle) + deviation * std::f64::consts::SQRT_2 * (7.0 * angle).cos(),
            );
        }
        model.rejections = 0;
        model.refine();
        model
    };
    for (deviation, widened) in [(5e-7, false), (9e-7, true)] {
        let model = revolution(2e-6, deviation);
        assert_eq!(model.any.is_some(), widened, "{}", model.misfit());
        assert_eq!(model.misfit() > 3.0, widened, "{}", model.misfit());
    }
    // a round ring has no form to be found
    let round = revolution(0.0, 1e-6);
    assert!(round.misfit() > 3.0 && round.any.is_none());
}

#[test]
fn few_measurements_widen_nothing_and_one_more_does() {
    for (count, widened) in [(2 * ANY as u32, false), (2 * ANY as u32 + 1, true)] {
        let mut model = RingModel::new(Assumptions { noise: 2e-7, ..ASSUMED });
        for k in 0..count {
            let angle = TAU * f64::from(k) / f64::from(count);
            model.observe(angle, ring(Vector2::zeros(), angle) + 5e-6 * (9.0 * angle).cos());
        }
        model.rejections = 0;
        model.refine();
        assert!(model.misfit() > 3.0 && model.any.is_some() == widened, "{count}");
    }
}

#[test]
fn a_ring_that_waits_for_measurements_is_fitted_with_no_sample_and_tried_as_soon_as_there_are_enough() {
    // what comes when there are enough fits one of the others by chance, too
    for (waves, lobe, phase) in [(16.0, 2e-5, 0.0), (9.0, 1e-5, 8.0), (12.0, 5e-6, 8.0), (17.0, 2e-5, 4.0)] {
        let mut model = RingModel::new(ASSUMED);
        let mut waited = 0;
        for k in 0..=2 * GROUND as u32 {
            let angle = TAU * f64::from(k) / 88.0;
            let rough = lobe * (waves * angle + TAU / 12.0 * phase).cos();
            model.observe(angle, ring(Vector2::new(5e-4, 0.0), angle) + rough);
            let before = (model.center(), model.misfit());
            assert!(model.advance() && model.advance(), "{k}");
            if k < 2 * GROUND as u32 && model.lost() {
                waited += 1;
                assert!(model.undecided() && !model.tried(), "{k}");
                assert_eq!((model.center(), model.misfit()), before, "{k}");
            }
        }
        assert!(waited > 1 && model.tried(), "{waves} {lobe} {phase}: {waited}");
    }
}

#[test]
fn what_is_known_changes_with_the_last_pass_and_waits_for_it() {
    let (mut model, _) = lobed(9.0, 0.0, 2e-7);
    let angle = |k: u32| TAU * f64::from(k) / 200.0;
    let wide = |k: u32| ring(Vector2::new(2e-4, 1e-4), angle(k)) + 5e-6 * (9.0 * angle(k) + 0.4).cos();
    model.displaced(Vector2::new(2e-4, 1e-4), 1e-4);
    (0..100).for_each(|k| _ = model.observe(angle(k), wide(k)));
    model.rejections = 0;
    model.refine();
    let (before, mut passes) = (model.center(), 0);
    while model.undecided() {
        assert_eq!(model.center(), before);
        assert!(model.advance());
        passes += 1;
    }
    assert!(passes == 4 && model.center() != before, "{passes}");
    // a later fit changes it with its last pass as well, and nothing waits
    (100..120).for_each(|k| _ = model.observe(angle(k), wide(k)));
    model.refine();
    let before = model.center();
    for _ in 0..2 {
        assert!(model.advance() && model.center() == before && !model.undecided());
        // begins no other
        model.refine();
    }
    assert!(model.advance() && model.center() != before);
    assert!(model.any.as_ref().unwrap().fitting().is_none());
}

#[test]
fn a_push_keeps_the_form_of_any_order_and_ends_a_fit() {
    let (mut model, center) = lobed(11.0, 5e-6, 2e-7);
    let line = model.centered_line(0.3);
    model.refine();
    model.displaced(center, 1e-4);
    assert!(model.any.as_ref().is_some_and(|any| any.fitting().is_none()));
    assert!(model.center() == center && model.centered_line(0.3) == line);
    assert!((model.center_sigma() - 1e-4).abs() < 1e-16);
    // a tenth of a revolution is enough then
    let moved = Vector2::new(-2e-5, 3e-5);
    for k in 0..20 {
        let angle = TAU * (1.0 + 0.1 * f64::from(k) / 20.0);
        model.observe(angle, ring(moved, angle) + 5e-6 * (11.0 * angle + 0.4).cos());
    }
    model.refine();
    assert!(settle(&mut model) && (model.center() - moved).norm() < 2e-6, "{}", model.center() - moved);
    // and a push ends what has only begun to be tried
    let mut tried = seen(center, 1.0, 200);
    tried.widen();
    tried.displaced(center, 1e-4);
    assert!(tried.any.is_none() && !tried.undecided());
}

#[test]
fn a_fit_that_would_not_have_all_measurements_is_given_up() {
    for tried in [false, true] {
        let (mut model, center) = lobed(11.0, if tried { 0.0 } else { 5e-6 }, 2e-7);
        if tried {
            model.widen()
        } else {
            model.refine()
        }
        for k in 200..=HISTORY as u32 {
            let angle = TAU * f64::from(k) / 200.0;
            let lobe = if tried { 0.0 } else { 5e-6 * (11.0 * angle + 0.4).cos() };
            assert!(model.observe(angle, ring(center, angle) + lobe), "{k}");
        }
        assert!(model.advance() && !model.undecided());
        assert_eq!(model.any.is_none(), tried);
        assert!(model.any.is_none_or(|any| any.fitting().is_none()));
    }
}

#[test]
fn a_ring_of_any_form_that_was_moved_is_lost() {
    let (mut model, _) = lobed(9.0, 5e-6, 2e-7);
    let moved = (0..20).find(|&k| {
        let angle = TAU * f64::from(k) / 200.0;
        !take(&mut model, angle, ring(Vector2::new(1e-4, 3e-4), angle))
    });
    assert_eq!(moved, Some(ASSUMED.rejections_max));
}

#[test]
fn early_dirt_is_unmasked_later() {
    let center = Vector2::new(4e-4, 1e-4);
    let mut model = RingModel::new(ASSUMED);
    for k in 0..100 {
        let angle = 0.5 * TAU * f64::from(k) / 100.0;
        let dirt = if k % 25 < 2 { 2e-5 } else { 0.0 };
        model.observe(angle, ring(center, angle) + dirt);
        if k % 7 == 6 {
            model.refine();
        }
    }
    assert!((model.center() - center).norm() < 3e-6, "{}", model.center() - center);
}

#[test]
fn the_covariance_stays_positive_for_an_hour() {
    let center = Vector2::new(1e-6, 1e-6);
    let mut model = RingModel::new(ASSUMED);
    for k in 0..240_000 {
        let angle = 2.094_395 * f64::from(k) / 66.0;
        model.observe(angle, ring(center, angle));
    }
    assert!(model.ground.estimate.now.root.iter().all(|x| x.is_finite()));
    assert!((model.center() - center).norm() < 1e-9);
}

#[test]
fn a_line_seen_elsewhere_is_less_certain_with_the_distance() {
    let sigma = |distance: f64| {
        let mut model = seen(Vector2::new(distance, 0.0), 1.0, 200);
        let before = model.ground.estimate.now.root.row(0).norm();
        model.displaced(Vector2::zeros(), 1e-5);
        (model.ground.estimate.now.root.row(0).norm().powi(2) - before.powi(2) * model.misfit().powi(2)).sqrt()
    };
    // a ten thousandth of the way, and a hundredth of the height of its arc twice
    for distance in [1e-3, 1e-2] {
        let uncertainty = 1e-4 * distance + 0.02 * distance * distance / 0.2;
        assert!((sigma(distance) - uncertainty).abs() < 1e-3 * uncertainty, "{distance}: {}", sigma(distance));
    }
}

#[test]
fn a_displacement_discards_the_center_and_keeps_the_form() {
    let mut model = seen(Vector2::new(4e-4, 1e-4), 1.0, 200);
    let line = model.centered_line(0.3);
    model.displaced(Vector2::zeros(), 1e-5);
    assert_eq!(model.center(), Vector2::zeros());
    assert!((model.center_sigma() - 1e-5).abs() < 1e-18);
    assert_eq!(model.centered_line(0.3), line);
}

#[test]
fn the_line_is_what_was_measured_and_a_first_estimate_is_not_settled() {
    let center = Vector2::new(3e-3, -2e-3);
    let mut model = RingModel::new(ASSUMED);
    for k in 0..100 {
        let angle = TAU * f64::from(k) / 100.0;
        model.observe(angle, ring(center, angle));
    }
    // 3.6 mm from the point of linearization: 130 um from the tangent
    assert!(!model.settled());
    assert!((model.ground.estimate.bend(&Vector2::new(3e-3, -4e-3)) - 2.5e-4).abs() < 1e-18);
    model.refine();
    assert!(model.settled() && model.ground.estimate.step().norm() < 1e-6);
    for angle in [0.1, 1.7, 3.0, 5.2] {
        assert!((model.line(angle) - ring(center, angle)).abs() < 2e-7);
    }
    assert!((model.misfit() - 1.0).abs() < 1e-12 && (model.eccentricity() - center.norm()).abs() < 1e-7);
}

#[test]
fn the_gate_opens_with_misfit_doubt_and_curvature() {
    let center = Vector2::new(4e-4, 1e-4);
    let model = seen(center, 1.0, 200);
    let gate = |model: &RingModel, angle: f64| {
        let model = &model.ground.estimate;
        let (expected, gradient) = model.expect(angle, &model.now.mean);
        let noise = ASSUMED.noise * model.misfit;
        let width = (model.now.spread(&gradient) + noise.powi(2) + model.blur(&gradient).powi(2)).sqrt();
        (expected, ASSUMED.gate * width)
    };
    for (side, ratio, taken) in [(1.0, 0.999, true), (-1.0, 0.999, true), (1.0, 1.001, false), (-1.0, 1.001, false)] {
        let (expected, width) = gate(&model, 1.0);
        assert!(width > ASSUMED.gate * ASSUMED.noise);
        assert_eq!(model.clone().observe(1.0, expected + side * ratio * width), taken);
    }
    // after a push of 0.1 mm: half the variance of c_y over the radius
    let mut moved = model.clone();
    moved.displaced(Vector2::zeros(), 1e-3);
    let moved = &moved.ground.estimate;
    let (_, gradient) = moved.expect(0.4, &moved.now.mean);
    assert!((moved.blur(&gradient) - 0.5 * 1e-6 / 0.05).abs() < 1e-9, "{}", moved.blur(&gradient));
}

#[test]
fn one_more_than_the_limit_of_consecutive_samples_is_lost_and_a_good_one_starts_again() {
    let center = Vector2::new(4e-4, 1e-4);
    let mut model = seen(center, 1.0, 200);
    let mut feed = |bad: bool| {
        model.observe(0.5, ring(center, 0.5) + if bad { 5e-5 } else { 0.0 });
        model.lost()
    };
    assert!((0..5).all(|_| !feed(true)) && !feed(false));
    assert!((0..5).all(|_| !feed(true)) && feed(true));
}

#[test]
fn a_ring_that_was_moved_is_no_rough_one() {
    let center = Vector2::new(2e-4, 1e-4);
    let lost = |other: &dyn Fn(f64) -> f64| {
        let mut model = seen(center, 0.9, 180);
        let rejected = (0..20).take_while(|k| {
            let angle = TAU * (0.9 + f64::from(*k) / 200.0);
            !model.lost() && !model.observe(angle, other(angle))
        });
        (rejected.count(), settle(&mut model), model.rejections)
    };
    let (count, explained, left) = lost(&|angle| ring(Vector2::new(1e-4, 3e-4), angle));
    assert_eq!((count, explained, left), (6, false, 6));
    // a scratch of 2 um is within what a rough ring has
    let (count, explained, left) = lost(&|angle| ring(center, angle) + 2e-6);
    assert_eq!((count, explained, left), (6, true, 0));
}

#[test]
fn a_few_measurements_make_no_rough_ring_smooth_and_more_of_them_do() {
    let center = Vector2::new(2e-4, 1e-4);
    let mut model = RingModel::new(Assumptions { noise: 2e-7, ..ASSUMED });
    let see = |model: &mut RingModel, count: u32, lobe: f64| {
        for k in 0..count {
            let angle = TAU * f64::from(k) / f64::from(count);
            model.observe(angle, ring(center, angle) + lobe * (7.0 * angle).cos());
        }
        model.refine();
        model.misfit()
    };
    let rough = see(&mut model, 200, 8e-7);
    assert!(rough > 2.0 && model.any.is_none(), "{rough}");
    for (count, kept) in [(2 * GROUND as u32, true), (2 * GROUND as u32 + 1, false)] {
        let mut pushed = model.clone();
        pushed.displaced(center, 1e-4);
        let misfit = see(&mut pushed, count, 0.0);
        assert_eq!(misfit == rough, kept, "{count}: {misfit}");
        assert!(kept || misfit == 1.0, "{count}: {misfit}");
    }
}
