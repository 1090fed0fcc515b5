//! A sample allocates nothing: not in a motion, not while learning, not at the end of a repetition, nor in a fault.
//!
//! The one exception is the sample that writes the bank to a file; it is not one of the control law.

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use fmu_deburr::controller::Controller;
use fmu_deburr::interface::{AxisInput, Fault, Input, Law, LearningLaw, Mode, Output, Parameters, State};
use fmu_deburr::path::{Vector, path_file};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// The controller on axes that follow the command of one sample ago, or a ratio of it.
struct Loop {
    controller: Controller,
    parameters: Parameters,
    input: Input,
    output: Output,
    commanded: [f64; 6],
    ratio: f64,
    /// signal of the probe, for the distance of the tip beyond the programmed position of a touch, m
    in_contact: fn(usize, f64) -> bool,
}

impl Loop {
    fn new(change: impl FnOnce(&mut Parameters)) -> Self {
        let mut parameters = Parameters::START;
        parameters.learn.repetitions = 1;
        parameters.limits.spindle_change = 0.0;
        parameters.limits.axis.iter_mut().for_each(|axis| axis.pattern_error = 0.1);
        change(&mut parameters);
        let resources = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("resources");
        let path = path_file::read(&parameters, Some(&resources)).unwrap();
        let controller = Controller::new(&parameters, path).unwrap();
        let mut input = Input { enable: true, ..Input::START };
        for (axis, position) in input.axis.iter_mut().zip([-0.1, 0.02, 0.7, 0.0, 0.0, 0.0]) {
            axis.position = position;
        }
        Self {
            controller,
            parameters,
            input,
            output: Output::START,
            commanded: [0.0; 6],
            ratio: 1.0,
            in_contact: |_, _| false,
        }
    }

    fn step(&mut self) {
        for i in 0..6 {
            self.input.axis[i] =
                AxisInput { position: self.input.axis[i].position + 0.01 * self.ratio * self.commanded[i] };
        }
        self.commanded = self.output.axis.map(|axis| axis.velocity);
        let tip = self.parameters.arm.forward(&self.input.axis.map(|axis| axis.position)).tip;
        let number = self.output.registration.touches as usize;
        let touch = self.controller.path().touches.get(number);
        self.input.contact = touch.is_some_and(|touch| {
            let aside: Vector = tip - touch.pose.tip;
            let out = aside.dot(&touch.normal);
            (aside - touch.normal * out).norm() < 1e-3 && (self.in_contact)(number, -out)
        });
        self.tick();
    }

    fn tick(&mut self) {
        assert_no_alloc(|| {
            self.controller.bring_into_force(&mut self.parameters);
            self.controller.tick(&self.input, &self.parameters, &mut self.output);
        });
    }

    fn step_until(&mut self, condition: impl Fn(&Output) -> bool) {
        self.step();
        for _ in 0..20_000 {
            self.step();
            if condition(&self.output) {
                return;
            }
        }
        panic!("never: {:?}", self.output);
    }
}

#[test]
fn no_sample_of_a_cycle_allocates() {
    let laws: [fn(&mut Parameters); 5] = [
        |p| p.law = Law::Paper,
        |p| p.learn.identify = false,
        |p| p.learn.law = LearningLaw::LeadFilter,
        |p| p.learn.law = LearningLaw::NormOptimal,
        |p| p.learn.law = LearningLaw::Plain,
    ];
    for law in laws {
        let mut run = Loop::new(law);
        for mode in [Mode::DryRun, Mode::Learn, Mode::Playback, Mode::Deburr, Mode::Export] {
            run.input.mode = mode;
            run.step_until(|output| output.state == State::Done);
        }
    }
}

#[test]
fn a_commission_that_is_applied_and_one_that_is_aborted() {
    let mut run = Loop::new(|p| p.commission.apply = true);
    (run.input.spindle_speed, run.ratio) = (1884.0, 0.9);
    for valid in [true, false] {
        run.input.commission = false;
        (0..200).for_each(|_| run.step());
        run.input.commission = true;
        run.step_until(|output| output.state == State::Commission);
        (0..100).for_each(|_| run.step());
        run.input.commission = valid;
        run.step_until(|output| output.state == State::Idle);
        (0..10).for_each(|_| run.step());
        assert_eq!((run.output.measured.valid, run.output.bank.patterns), (valid, if valid { 5 } else { 0 }));
        assert_eq!((run.output.state, run.output.fault), (State::Idle, Fault::None));
    }
}

#[test]
fn a_registration_that_moves_learned_patterns_and_one_that_is_aborted() {
    let mut run = touching(|_, inside| inside > 1e-3);
    run.input.mode = Mode::Learn;
    run.step_until(|output| output.state == State::Done);
    for valid in [true, false] {
        (run.input.register, run.input.mode) = (false, Mode::Idle);
        (0..200).for_each(|_| run.step());
        run.input.register = true;
        run.step_until(|output| output.state == State::Register);
        (0..400).for_each(|_| run.step());
        run.input.register = valid;
        run.step_until(|output| output.state == State::Idle);
        assert_eq!((run.output.registration.valid, run.output.fault), (valid, Fault::None));
        // all faces are farther in by 1 mm: both normals
        assert_eq!(run.output.registration.x < -1e-3, valid, "{:?}", run.output.registration);
    }
}

/// A part with touches, and what its probe detects.
fn touching(in_contact: fn(usize, f64) -> bool) -> Loop {
    let mut run = Loop::new(|p| p.path.file = "touched.json".to_owned());
    run.in_contact = in_contact;
    (0..100).for_each(|_| run.step());
    run
}

/// A task in motion, on a machine and with inputs that lead to a fault.
fn towards(fault: Fault) -> Loop {
    let running = |mode: Mode, change: fn(&mut Parameters)| {
        let mut run = Loop::new(|p| {
            (p.lookup.enable, p.limits.pulses_max) = (false, 1.0);
            change(p);
        });
        run.input.mode = mode;
        run.step_until(|output| output.path.distance > 0.05);
        run
    };
    let nothing = |_: &mut Parameters| ();
    let mut run = match fault {
        Fault::None | Fault::BankEmpty => Loop::new(nothing),
        Fault::PatternTooLarge => running(Mode::Learn, nothing),
        Fault::CommissionRejected => {
            // the tool is off
            let mut run = Loop::new(|_| ());
            run.input.spindle_speed = 0.0;
            (0..100).for_each(|_| run.step());
            run
        }
        Fault::NoTouches => {
            let mut run = Loop::new(nothing);
            (0..100).for_each(|_| run.step());
            run
        }
        Fault::NoPart => touching(|_, _| false),
        Fault::UnexpectedContact => touching(|_, _| true),
        Fault::ContactFrozen => touching(|_, inside| inside > -4.99e-3),
        Fault::TouchMismatch => touching(|touch, inside| inside > if touch == 2 { 0.0 } else { 1e-3 }),
        Fault::Misplaced => touching(|_, inside| inside > 4.5e-3),
        Fault::Oscillation => Loop::new(|p| (p.servo_gain, p.lookup.enable) = ([150.0; 6], false)),
        Fault::NoCut => running(Mode::Deburr, |p| p.limits.spindle_change = 2.0),
        Fault::WrongDelay => running(Mode::DryRun, |p| p.io_delay = 3),
        Fault::NoProgress => running(Mode::DryRun, |p| p.limits.cycle_time = 5.0),
        Fault::PatternMismatch => {
            let mut run = Loop::new(|p| {
                (p.learn.repetitions, p.learn.identify) = (0, false);
                p.limits.axis = Parameters::START.limits.axis;
            });
            run.input.mode = Mode::Learn;
            run.step_until(|output| output.state == State::Done);
            run
        }
        Fault::SpindleFrozen => {
            let mut run = Loop::new(|p| p.lookup.enable = false);
            run.input.mode = Mode::Deburr;
            for speed in [1885.0, 1886.0, 1887.0, 1886.0].into_iter().cycle() {
                run.input.spindle_speed = speed;
                run.step();
                if run.output.path.distance > 0.05 {
                    break;
                }
            }
            run
        }
        _ => running(Mode::Deburr, nothing),
    };
    match fault {
        Fault::InvalidInput => run.input.speed_override = f64::NAN,
        Fault::SpindleLost => run.input.spindle_speed = f64::NAN,
        Fault::SpindleJump => run.input.spindle_speed = 0.0,
        Fault::PositionLost => run.ratio = f64::NAN,
        Fault::PositionJump => run.input.axis[0].position += 0.5,
        Fault::SpindleSlow => run.input.spindle_speed = 1600.0,
        Fault::BankEmpty | Fault::PatternMismatch => run.input.mode = Mode::Playback,
        Fault::PositionFrozen => run.ratio = 0.0,
        Fault::WeakDrive => run.ratio = 0.3,
        Fault::DriveSign => run.ratio = -1.0,
        Fault::LongStep => run.controller.begin_long_step(),
        Fault::Oscillation => run.input.mode = Mode::DryRun,
        Fault::FollowingError => run.ratio = 3.0,
        Fault::CommissionRejected => run.input.commission = true,
        Fault::NoTouches | Fault::NoPart | Fault::UnexpectedContact => run.input.register = true,
        Fault::ContactFrozen | Fault::TouchMismatch | Fault::Misplaced => run.input.register = true,
        Fault::None | Fault::PatternTooLarge | Fault::NoCut | Fault::WrongDelay | Fault::NoProgress => {}
        Fault::SpindleFrozen => {}
    }
    run
}

#[test]
fn no_fault_allocates() {
    for fault in Fault::ALL.iter().skip(1) {
        let mut run = towards(*fault);
        for _ in 0..8000 {
            run.step();
        }
        assert_eq!((run.output.state, run.output.fault), (State::Fault, *fault));
        (run.input.commission, run.input.register) = (false, false);
        (run.input.spindle_speed, run.input.speed_override, run.ratio) = (1885.0, 1.0, 1.0);
        if *fault == Fault::PositionLost {
            run.input.axis = run.output.axis.map(|axis| AxisInput { position: axis.reference });
        }
        run.step();
        run.input.reset_fault = true;
        run.step_until(|output| output.state == State::Idle);
    }
}
