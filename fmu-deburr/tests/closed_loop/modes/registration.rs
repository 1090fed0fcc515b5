//! The state `Register`: where it finds parts that lie elsewhere, what it keeps to, and what becomes of the patterns.

use fmu_deburr::interface::{BankStatus, Fault, Mode, Parameters, State};
use fmu_deburr::path::{Vector, path_file};
use rand::{RngExt, SeedableRng};

use crate::robot::Build;
use crate::setup::Loop;

/// Where a part lies: shift of the middle of its touches, m, and turn, rad.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    x: f64,
    y: f64,
    angle: f64,
}

/// A loop whose probe detects the walls of a part.
#[derive(Clone)]
struct Touching {
    run: Loop,
    part: Part,
    /// farther out at this touch, m
    chip: (usize, f64),
    /// farthest way into the part, m
    deep: f64,
    /// contact in the way of what is detected
    stuck: Option<bool>,
}

impl Touching {
    fn new(change: impl FnOnce(&mut Parameters), build: &Build, part: Part) -> Self {
        let mut p = Parameters::START;
        p.path.file = "touched.json".to_owned();
        change(&mut p);
        let mut this = Self { run: Loop::new(&p, build), part, chip: (0, 0.0), deep: 0.0, stuck: None };
        (0..20).for_each(|_| this.step());
        assert_eq!(this.run.output.state, State::Idle);
        this
    }

    fn middle(&self) -> Vector {
        let touches = &self.run.controller.path().touches;
        touches.iter().map(|touch| touch.pose.tip).sum::<Vector>() / touches.len() as f64
    }

    /// A point of the part, at its programmed position.
    fn back(&self, tip: &Vector) -> Vector {
        let (Part { x, y, angle }, middle) = (self.part, self.middle());
        let (sin, cos) = angle.sin_cos();
        let v = tip - middle - Vector::new(x, y, 0.0);
        middle + Vector::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
    }

    /// How far the tip is inside the wall at a touch, m; negative outside.
    fn inside(&self) -> f64 {
        let position = self.back(&self.run.parameters.arm.forward(&self.run.robot.positions()).tip);
        let contact = |(i, touch): (usize, &fmu_deburr::path::Touch)| {
            let offset = position - touch.pose.tip;
            let chip = if i + 1 == self.chip.0 { self.chip.1 } else { 0.0 };
            let out = offset.dot(&touch.normal);
            let along = (offset - touch.normal * out - Vector::z() * offset.z).norm();
            (along < 0.015 && offset.z.abs() < 5e-3).then_some(chip - out)
        };
        let touches = &self.run.controller.path().touches;
        touches.iter().enumerate().filter_map(contact).fold(-1.0, f64::max)
    }

    fn step(&mut self) {
        let inside = self.inside();
        if self.run.output.state == State::Register {
            self.deep = self.deep.max(inside);
        }
        self.run.input.contact = self.stuck.unwrap_or(inside > self.run.parameters.register.pretravel);
        self.run.step();
    }

    /// Steps into the state `Register`, and this number of samples on.
    fn begin(&mut self, samples: usize) {
        self.run.input.register = false;
        self.step();
        self.run.input.register = true;
        for _ in 0..400 {
            self.step();
            if self.run.output.state == State::Register {
                break;
            }
        }
        assert_eq!(self.run.output.state, State::Register);
        (0..samples).for_each(|_| self.step());
    }

    /// Runs on until it is over; its time, s.
    fn end(&mut self) -> f64 {
        let mut samples = 0;
        while matches!(self.run.output.state, State::Register | State::Stop | State::Retract) {
            self.step();
            samples += 1;
            assert!(samples < 20_000, "{:?}", self.run.output);
        }
        0.01 * f64::from(samples)
    }

    fn register(&mut self) -> f64 {
        self.begin(0);
        self.end()
    }

    fn ended(&self) -> (State, Fault) {
        (self.run.output.state, self.run.output.fault)
    }
}

/// A part that lies within 2 mm and 5 mrad.
fn part(seed: u64) -> Part {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut random_in = |maximum: f64| random.random_range(-maximum..maximum);
    Part { x: random_in(2e-3), y: random_in(2e-3), angle: random_in(5e-3) }
}

const NOISY: Build = Build { noise: 0.5, ..Build::NOMINAL };

#[test]
fn parts_are_found_where_they_are_within_their_deviations() {
    let mut off = Vec::new();
    for seed in 300..330 {
        let part = part(seed);
        let mut touching = Touching::new(|p| p.register.pretravel = 2e-5, &NOISY, part);
        let time = touching.register();
        let found = touching.run.output.registration;
        assert_eq!(touching.ended(), (State::Idle, Fault::None), "{part:?}: {found:?}");
        assert!(found.valid && found.touches == 6 && time < 60.0, "{found:?} {time}");
        assert!((found.x - part.x).abs() < 1e-5 && (found.y - part.y).abs() < 1e-5, "{part:?}: {found:?}");
        assert!((found.angle - part.angle).abs() < 2e-4, "{part:?}: {found:?}");
        // what a bare servo continues after 4 samples at 5 mm/s, its lag and its stop
        assert!(touching.deep < 8e-4, "{}", touching.deep);
        off.push((found.x - part.x) / found.x_std);
        off.push((found.y - part.y) / found.y_std);
        off.push((found.angle - part.angle) / found.angle_std);
        // the path is that of the part
        let (start, programmed) =
            (touching.run.controller.path().at(0.0), path_file::read(&Parameters::START, None).unwrap());
        assert!((touching.back(&start.tip) - programmed.at(0.0).tip).norm() < 3e-5, "{part:?}");
    }
    let scatter = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    println!("errors in deviations: {scatter:.2}, {off:.1?}");
    assert!((0.6..1.4).contains(&scatter) && off.iter().all(|off| off.abs() < 4.0), "{scatter}");
}

#[test]
fn learned_patterns_follow_the_part() {
    let build = Build { gain: 0.85, ..Build::NOMINAL };
    let mut touching =
        Touching::new(|p| p.learn.speeds = "1.0".to_owned(), &build, Part { x: 2e-3, y: -2e-3, angle: 5e-3 });
    assert!(touching.run.finish(Mode::Learn));
    let programmed = touching.run.controller.programmed_bank(&touching.run.parameters);
    let before = touching.run.largest_errors(Mode::Playback, |_| 1.0);
    touching.run.input.mode = Mode::Idle;
    (0..50).for_each(|_| touching.step());
    touching.register();
    assert_eq!(touching.ended(), (State::Idle, Fault::None));
    assert_eq!(touching.run.output.bank.status, BankStatus::Learned);
    let after = touching.run.largest_errors(Mode::Playback, |_| 1.0);
    println!("{before:.3?} {after:.3?}");
    for axis in [0, 2] {
        assert!(after[axis] < before[axis] + 0.01, "{before:?} {after:?}");
    }
    // what is written belongs to the path as programmed
    let back = touching.run.controller.programmed_bank(&touching.run.parameters);
    let values = |bank: &fmu_deburr::bank::pattern_bank::PatternBank| -> Vec<f64> {
        bank.patterns().iter().flat_map(|pattern| &pattern.samples).flat_map(|sample| sample.compensation).collect()
    };
    let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0f64, |maximum, (a, b)| maximum.max((a - b).abs()));
    assert!(differ(&values(&back), &values(&programmed)) < 1e-6);
    assert!(differ(&values(touching.run.controller.bank()), &values(&programmed)) > 5.0);
}

#[test]
fn what_is_wrong_with_the_part_is_named_with_its_numbers_and_the_path_stays() {
    type Case = (fn(&mut Touching), Fault, i32);
    let cases: [Case; 5] = [
        // along the first face, away from the second one
        (|touching| touching.part = Part { x: -8.34e-3, y: -8.63e-3, angle: 0.0 }, Fault::NoPart, 4),
        (|touching| touching.part = Part { x: 3e-3, y: 3e-3, angle: 0.0 }, Fault::Misplaced, 1),
        (|touching| touching.part.angle = 0.02, Fault::Misplaced, 2),
        (|touching| touching.chip = (3, 2e-4), Fault::TouchMismatch, 3),
        (|touching| touching.stuck = Some(false), Fault::NoPart, 1),
    ];
    for (change, fault, number) in cases {
        let mut touching = Touching::new(|_| (), &NOISY, Part::default());
        change(&mut touching);
        touching.register();
        assert_eq!(touching.ended(), (State::Fault, fault), "{:?}", touching.run.output.registration);
        assert_eq!(touching.run.output.numbers.axis, number, "{fault:?}: {:?}", touching.run.output.numbers);
        assert!(touching.run.output.drive_enable && !touching.run.output.registration.valid);
        let programmed = path_file::read(&Parameters::START, None).unwrap();
        assert_eq!(touching.run.controller.path().at(0.1), programmed.at(0.1));
        // back from the part, drawn out of it where it might be in the way
        touching.stuck = None;
        assert!(touching.inside() <= 0.0);
        (0..30).for_each(|_| touching.step());
        touching.run.input.reset_fault = true;
        (0..3).for_each(|_| touching.step());
        assert_eq!(touching.ended(), (State::Idle, Fault::None));
    }
}

#[test]
fn a_contact_that_sticks_is_reported_before_and_after_a_touch() {
    let mut touching = Touching::new(|_| (), &NOISY, Part::default());
    touching.begin(30);
    touching.stuck = Some(true);
    touching.end();
    assert_eq!((touching.ended(), touching.run.output.numbers.axis), ((State::Fault, Fault::UnexpectedContact), 1));
    let mut touching = Touching::new(|_| (), &NOISY, Part::default());
    touching.begin(0);
    while !touching.run.input.contact {
        touching.step();
    }
    touching.stuck = Some(true);
    touching.end();
    assert_eq!((touching.ended(), touching.run.output.numbers.axis), ((State::Fault, Fault::ContactFrozen), 1));
    assert!(touching.inside() <= 0.0);
}

#[test]
fn a_few_bad_samples_of_the_contact_decide_nothing() {
    let part = part(7);
    let mut touching = Touching::new(|_| (), &Build::NOMINAL, part);
    touching.begin(0);
    for k in 0.. {
        // three consecutive, during the motion and in an approach; never where the wall is detected
        touching.stuck = (k % 100 > 96 && touching.inside() < 0.0).then_some(true);
        touching.step();
        if touching.run.output.state != State::Register {
            break;
        }
    }
    let found = touching.run.output.registration;
    assert_eq!(touching.ended(), (State::Idle, Fault::None), "{found:?}");
    assert!((found.x - part.x).abs() < 1e-5 && (found.angle - part.angle).abs() < 2e-4, "{part:?}: {found:?}");
}

#[test]
fn it_is_aborted_into_rest_and_the_path_as_it_was_programmed() {
    type Cause = fn(&mut Loop);
    let causes: [(Cause, State); 4] = [
        (|run| run.input.register = false, State::Idle),
        (|run| run.input.hold = true, State::Idle),
        (|run| run.input.mode = Mode::DryRun, State::Idle),
        (|run| run.input.enable = false, State::Off),
    ];
    let mut started = Touching::new(|_| (), &NOISY, part(8));
    started.register();
    assert!(started.run.output.registration.valid);
    started.begin(0);
    // during the motion, towards the part, against it, and during the motion to another touch
    for samples in [0, 60, 150, 140, 700] {
        (0..samples).for_each(|_| started.step());
        for (cause, end) in causes {
            let mut touching = started.clone();
            touching.deep = 0.0;
            cause(&mut touching.run);
            (0..150).for_each(|_| touching.step());
            assert_eq!(touching.ended(), (end, Fault::None), "{samples}");
            assert!(touching.deep < 8e-4 && !touching.run.output.probe);
            (touching.run.input.hold, touching.run.input.enable) = (false, true);
            (0..300).for_each(|_| touching.step());
            assert_eq!(touching.ended(), (State::Idle, Fault::None), "{samples}");
            assert!(touching.run.output.axis.iter().all(|axis| axis.velocity.abs() < 1e-3));
            assert!(!touching.run.output.registration.valid);
            let programmed = path_file::read(&Parameters::START, None).unwrap();
            assert_eq!(touching.run.controller.path().at(0.1), programmed.at(0.1));
        }
    }
}

#[test]
fn one_that_is_reported_as_good_is_not_aborted_any_more() {
    let mut touching = Touching::new(|_| (), &NOISY, part(8));
    touching.begin(0);
    while !touching.run.output.registration.valid {
        touching.step();
    }
    // the answer to `registration.valid`, in the very next sample
    (touching.run.input.register, touching.run.input.mode) = (false, Mode::DryRun);
    touching.step();
    assert_eq!(touching.ended(), (State::Idle, Fault::None));
    (0..100).for_each(|_| touching.step());
    assert_eq!(touching.ended(), (State::Idle, Fault::None));
    let programmed = path_file::read(&Parameters::START, None).unwrap();
    let moved = (touching.run.controller.path().at(0.1).tip - programmed.at(0.1).tip).norm();
    assert!(touching.run.output.registration.valid && moved > 1e-4, "{moved}");
}

#[test]
fn a_contact_during_a_transfer_is_braked_from_without_a_jerk() {
    let mut touching = Touching::new(|_| (), &Build::NOMINAL, Part::default());
    let reference = |touching: &Touching| touching.run.output.axis.each_ref().map(|axis| axis.reference);
    // out after the third touch, and half of the way across to the fourth
    touching.begin(0);
    while touching.run.output.registration.touches < 3 {
        touching.step();
    }
    (0..225).for_each(|_| touching.step());
    let mut positions = vec![reference(&touching)];
    touching.stuck = Some(true);
    while touching.run.output.state != State::Fault {
        touching.step();
        positions.push(reference(&touching));
    }
    assert_eq!(touching.run.output.fault, Fault::UnexpectedContact);
    let levers = touching.run.parameters.arm.levers(&positions[0]);
    let maximum = |at: &dyn Fn(usize, usize) -> f64| {
        (1..positions.len() - 1)
            .fold(0.0f64, |maximum, k| (0..6).fold(maximum, |maximum, i| maximum.max((at(k, i) * levers[i]).abs())))
    };
    let fastest = maximum(&|k, i| positions[k][i] - positions[k - 1][i]);
    let hardest = maximum(&|k, i| positions[k + 1][i] - 2.0 * positions[k][i] + positions[k - 1][i]);
    // a thirtieth of its speed is taken in each sample
    assert!(fastest > 2e-4 && hardest < 0.15 * fastest, "{fastest} m in a sample, changed by {hardest}");
}

#[test]
fn it_never_begins_by_itself_nor_without_touches() {
    let mut touching = Touching::new(|p| p.path.file = String::new(), &Build::NOMINAL, Part::default());
    touching.run.input.mode = Mode::DryRun;
    for k in 0..3000 {
        touching.run.input.register = touching.run.output.state == State::Run && k % 2 == 0;
        touching.run.step();
        assert!(touching.run.output.state != State::Register && !touching.run.output.probe);
        if touching.run.output.state == State::Done {
            break;
        }
    }
    touching.run.input.register = false;
    (0..100).for_each(|_| touching.run.step());
    touching.run.input.register = true;
    (0..10).for_each(|_| touching.run.step());
    assert_eq!(touching.ended(), (State::Fault, Fault::NoTouches));
    assert!(touching.run.output.drive_enable);
}

#[test]
fn it_does_not_take_longer_than_it_may() {
    let mut touching = Touching::new(|p| p.register.time = 12.0, &NOISY, Part::default());
    touching.register();
    assert_eq!((touching.ended(), touching.run.output.numbers.limit), ((State::Fault, Fault::NoProgress), 12.0));
    // by itself it takes some 50 s of what is derived
    let mut touching = Touching::new(|_| (), &NOISY, Part::default());
    touching.part.x = -2e-3;
    let time = touching.register();
    assert!(touching.run.output.registration.valid && (40.0..60.0).contains(&time), "{time}");
}

#[test]
fn a_part_that_cannot_be_followed_where_it_is_is_misplaced() {
    // axis 3 ends where the path is farthest out, and half a millimeter beyond
    let mut touching = Touching::new(|p| p.axis[2].maximum = 0.7455, &NOISY, Part { x: 2e-3, ..Part::default() });
    touching.register();
    assert_eq!((touching.ended(), touching.run.output.numbers.axis), ((State::Fault, Fault::Misplaced), 3));
    let mut touching = Touching::new(|p| p.axis[2].maximum = 0.7455, &NOISY, Part { x: -2e-3, ..Part::default() });
    touching.register();
    assert!(touching.run.output.registration.valid);
}

#[test]
fn state_bytes_continue_a_registration_bit_for_bit() {
    for samples in [0, 300, 2000] {
        let mut touching = Touching::new(|_| (), &Build::NOMINAL, part(9));
        touching.begin(samples);
        let mut copy = Touching { run: touching.run.reloaded(), ..touching.clone() };
        while touching.run.output.state == State::Register {
            touching.step();
            copy.step();
            assert_eq!(copy.run.output, touching.run.output);
        }
        assert!(touching.run.output.registration.valid);
        assert_eq!(copy.run.controller.path().at(0.1), touching.run.controller.path().at(0.1));
    }
}
