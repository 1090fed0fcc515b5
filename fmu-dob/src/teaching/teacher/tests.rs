use std::f64::consts::TAU;

use super::*;

/// A teaching whose touches are as late (m) as `late` says, at a place of 50 um; with what it is afterwards.
fn taught(p: &Parameters, late: impl Fn(f64, u32) -> f64) -> Teacher {
    let mut teacher = Teacher::new(p);
    teacher.begin(p);
    for touch in 0..20 {
        assert!(!teacher.over() && !teacher.rejected);
        let velocity = teacher.approach(p).velocity;
        teacher.take(p, &Measured::START, p.direction() * p.teach.place + late(velocity, touch), 0.0);
    }
    teacher
}

fn parameters(change: impl Fn(&mut Parameters)) -> Parameters {
    let mut p = Parameters::START;
    (p.teach.place, p.teach.touches_max) = (5e-5, 4);
    change(&mut p);
    p
}

#[test]
fn a_good_teaching_is_in_force_where_it_is_to_be_and_derived_in_any_case() {
    for (apply, direction) in [(false, 1), (true, 1), (true, -1)] {
        let p = parameters(|p| (p.teach.apply, p.approach.direction) = (apply, direction));
        let truth = Bias { constant: 2e-7, fast: 1e-7, slow: 0.0 };
        let teacher = taught(&p, |v, _| truth.at(v));
        assert!(teacher.taught.valid && teacher.over() && !teacher.rejected);
        let mut later = p.clone();
        later.contact.bias = 7e-7;
        let expected = if apply { 3e-7 } else { 7e-7 };
        assert!((teacher.bias(&later).at(1e-4) - expected).abs() < 1e-12, "{apply}");
        let derived = teacher.derived();
        assert!((derived[0].1 - 2e-7).abs() < 1e-12);
        assert_eq!(derived[3], ("teach.velocity_max", 3e-4));
    }
}

#[test]
fn each_limit_is_the_last_value_that_is_accepted() {
    let p = parameters(|p| p.limits.touch_scatter = 1.2e-8);
    let good = |late: &dyn Fn(f64, u32) -> f64| {
        let teacher = taught(&p, late);
        assert_ne!(teacher.taught.valid, teacher.rejected);
        teacher.taught.valid
    };
    // four touches to and fro by x have the deviation x (4/3)^(1/2)
    let swing = |x: f64| move |_: f64, touch: u32| 2e-7 + if (touch / 5).is_multiple_of(2) { x } else { -x };
    assert!(good(&swing(1.03e-8)) && !good(&swing(1.05e-8)));
    // too soft, and before the touch
    assert!(good(&|v, _| 9.9e-7 - 1e-4 * v) && !good(&|_, _| 1.01e-6));
    // what the parts leave out, and as much of their own at an end: 8.4 nm
    assert!(good(&|_, _| -2.4e-8) && !good(&|_, _| -2.6e-8));
    let unsure = |deviation: f64| {
        let p = parameters(|p| p.teach.place_deviation = deviation);
        taught(&p, |_, _| 2e-7).taught.valid
    };
    assert!(unsure(2.86e-8) && !unsure(2.9e-8));
}

#[test]
fn touches_that_are_not_sure_are_made_once_more_while_that_may_help() {
    let touches = |most: i32, first: f64| {
        let p = parameters(|p| (p.teach.touches_max, p.teach.apply) = (most, true));
        let mut teacher = Teacher::new(&p);
        teacher.begin(&p);
        let mut made = 0;
        while !teacher.ended() {
            teacher.take(&p, &Measured::START, p.teach.place + if made < 5 { first } else { 2e-7 }, 0.0);
            made += 1;
            // the slowest is next, unless this was the last
            let next = if teacher.ended() { p.approach.velocity } else { teacher.approach(&p).velocity };
            assert!(teacher.ended() || made % 5 != 0 || next == 1e-5, "{made}");
        }
        assert_eq!(teacher.approach_after(&p), p.approach);
        let told = teacher.deviation(1e-4);
        assert_eq!(told > 0.0, teacher.taught.valid);
        (made, teacher.taught.valid, teacher.taught.touches)
    };
    // one of four is 121 nm off, 60.5 nm of scatter; of five 54 nm
    assert_eq!(touches(4, 3.21e-7), (20, false, 20));
    assert_eq!(touches(8, 3.21e-7), (25, true, 25));
    assert_eq!(touches(8, 2e-7), (20, true, 20));
    // one that is too far off is never sure, and a bias that cannot be is none of scatter
    assert_eq!(touches(6, 6e-7), (30, false, 30));
    assert_eq!(touches(8, 4e-6), (20, false, 20));
}

#[test]
fn a_slowest_speed_that_is_never_sure_is_left_out_once_all_touches_are_made() {
    let truth = Bias { constant: 2e-7, fast: 1e-7, slow: 0.0 };
    let p = parameters(|p| (p.teach.touches_max, p.teach.apply) = (6, true));
    // one speed is late by 300 nm in every second round, and by `more` besides
    let end = |odd: usize, more: f64| {
        let mut teacher = Teacher::new(&p);
        teacher.begin(&p);
        while !teacher.ended() {
            let (touch, velocity) = (teacher.taught.touches as usize, teacher.approach(&p).velocity);
            let late = if touch % 5 == odd { more + 3e-7 * (touch / 5 % 2) as f64 } else { 0.0 };
            teacher.take(&p, &Measured::START, p.teach.place + truth.at(velocity) + late, 0.0);
        }
        teacher
    };
    // in the last, too late for `limits.bias`
    for more in [0.0, 1e-6] {
        let teacher = end(0, more);
        assert!(teacher.taught.valid && teacher.taught.touches == 30, "{:?}", teacher.taught);
        assert!((teacher.taught.velocity_min - 2.34e-5).abs() < 1e-7, "{:?}", teacher.taught);
        assert!((teacher.bias(&p).at(1e-4) - 3e-7).abs() < 1e-12);
        assert!(teacher.deviation(3e-5) < 2e-8 && teacher.deviation(1e-5) > 1.5e-7 + more);
    }
    // what is told of one that is refused is what all speeds say
    let refused = end(1, 0.0);
    assert!(refused.rejected && !refused.taught.valid && refused.taught.touches == 30);
    assert!(refused.taught.velocity_min == 1e-5 && refused.taught.scatter > 6e-8, "{:?}", refused.taught);
    // none is left out where all are sure
    assert_eq!(taught(&p, |v, _| truth.at(v)).taught.velocity_min, 1e-5);
}

#[test]
fn one_that_is_broken_off_or_rejected_leaves_what_was_told() {
    let p = parameters(|p| p.teach.apply = true);
    for broken in [true, false] {
        let mut teacher = taught(&p, |_, _| 2e-7);
        teacher.end();
        teacher.begin(&p);
        assert!(!teacher.taught.valid && teacher.taught.bias == 0.0);
        if broken {
            teacher.take(&p, &Measured::START, 5.03e-5, 0.0);
            assert!(teacher.break_off() && !teacher.break_off());
            assert!(teacher.over());
        } else {
            (0..20).for_each(|_| teacher.take(&p, &Measured::START, 6e-5, 0.0));
            assert!(teacher.rejected && teacher.taught.bias > 9e-6);
        }
        teacher.end();
        assert_eq!(teacher.bias(&p), Bias::of(&p));
    }
}

#[test]
fn it_stands_for_its_share_of_a_turn_before_a_touch_and_for_none_at_its_end() {
    let p = parameters(|_| ());
    let mut teacher = Teacher::new(&p);
    teacher.begin(&p);
    let stands = |teacher: &mut Teacher| (0..99).find(|_| teacher.rested());
    for touch in 0..20 {
        // 0.4 of 10 ms more in each round
        let expected = [0, 40, 80, 20][touch / 5];
        assert_eq!(stands(&mut teacher), Some(expected), "{touch}");
        teacher.take(&p, &Measured::START, 5.02e-5, TAU / 0.01);
    }
    assert_eq!(stands(&mut teacher), Some(0));
    teacher.begin(&p);
    (0..6).for_each(|_| teacher.take(&p, &Measured::START, 5.02e-5, TAU / 0.01));
    teacher.break_off();
    assert_eq!(stands(&mut teacher), Some(0));
}

#[test]
fn beside_a_teaching_the_approach_is_that_of_the_parameters() {
    let p = parameters(|_| ());
    let mut teacher = Teacher::new(&p);
    assert_eq!(teacher.approach(&p), p.approach);
    assert!(!teacher.break_off() && !teacher.broken());
    teacher.begin(&p);
    let slowest = Approach { velocity: 1e-5, ..p.approach };
    assert_eq!(teacher.approach(&p), slowest);
    for touch in 0..20 {
        let (last, after) = (touch == 19, teacher.approach_after(&p));
        teacher.take(&p, &Measured::START, 5.02e-5, 0.0);
        assert_eq!(after, if last { p.approach } else { teacher.approach(&p) });
    }
    teacher.begin(&p);
    assert!(teacher.break_off());
    assert_eq!(teacher.approach_after(&p), p.approach);
}

#[test]
fn a_job_is_no_faster_than_was_taught_with_a_limit_of_the_force_and_is_in_force() {
    for (force_max, apply, expected) in [(0.8, true, 3e-4), (0.0, true, 1e-3), (0.8, false, 1e-3)] {
        let p = parameters(|p| {
            (p.teach.force_max, p.teach.apply, p.approach.velocity) = (force_max, apply, 1e-3);
        });
        let mut teacher = taught(&p, |_, _| 2e-7);
        assert_eq!(teacher.approach_after(&p).velocity, expected);
        teacher.end();
        assert_eq!([teacher.approach(&p).velocity, teacher.approach_after(&p).velocity], [expected; 2]);
        let slower = Approach { velocity: 5e-5, ..p.approach };
        assert_eq!(teacher.approach(&Parameters { approach: slower, ..p.clone() }), slower);
        // broken off, what was told counts
        teacher.begin(&p);
        teacher.break_off();
        assert_eq!(teacher.approach(&p).velocity, 1e-3);
        teacher.end();
        assert_eq!(teacher.approach(&p).velocity, 1e-3);
    }
}

/// A touch for so many samples, after which 10 kg stand without any thrust: F over v is 1.25 times their mass, over that time.
fn touch(teacher: &mut Teacher, p: &Parameters, samples: u32) {
    let place = p.direction() * p.teach.place;
    teacher.feel(p, &Measured::START, Some(place - 1e-9), 0.0, false);
    (0..samples).for_each(|_| teacher.feel(p, &Measured::START, Some(place + 1e-8), 0.0, false));
    (0..70).for_each(|_| teacher.feel(p, &Measured::START, Some(place - 1e-8), 0.0, true));
    teacher.take(p, &Measured::START, place + 1e-8, 0.0);
}

#[test]
fn touches_that_press_too_hard_even_at_the_slowest_speeds_end_the_teaching() {
    for direction in [1, -1] {
        let p = parameters(|p| (p.teach.force_max, p.approach.direction) = (0.8, direction));
        let mut teacher = Teacher::new(&p);
        teacher.begin(&p);
        // 23.4 um/s are touched in any case
        for last in [false, true] {
            touch(&mut teacher, &p, 4);
            assert_eq!((teacher.rejected, teacher.ended(), teacher.over()), (last, last, false));
        }
        let bearable = teacher.bearable.unwrap();
        assert!(bearable < 3e-5, "{bearable}");
        teacher.begin(&p);
        assert!(!teacher.rejected && teacher.bearable.is_none());
    }
}

#[test]
fn where_a_longer_way_back_is_needed_than_was_gone_the_stage_comes_to_rest_first() {
    // 9.4 N at 300 um/s, and twice that
    let p = parameters(|p| p.teach.force_max = 24.0);
    let mut teacher = Teacher::new(&p);
    teacher.begin(&p);
    for samples in [4, 4, 4, 4, 2] {
        assert_eq!((0..9999).find(|_| teacher.rested()), Some(0));
        touch(&mut teacher, &p, samples);
    }
    let velocity = teacher.approach(&p).velocity;
    assert!((2.6e-4..2.8e-4).contains(&velocity), "{velocity} m/s");
    assert_eq!((0..9999).find(|_| teacher.rested()), Some(1064));
}
