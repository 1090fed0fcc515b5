//! No sample allocates: not in a task, under either control law, when it is aborted, nor in any fault.

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use fmu_fts::controller::Controller;
use fmu_fts::interface::{Fault, Input, Mode, Output, Parameters, State, Status};
use fmu_fts::texts::Tables;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// The controller with an arm that does what it should.
struct Bench {
    p: Parameters,
    controller: Controller,
    input: Input,
    output: Output,
    sample: i32,
}

impl Bench {
    fn new(p: Parameters) -> Self {
        let controller = Controller::new(&p, &Tables::default()).unwrap();
        let input = Input { enable: true, slide_position: 0.04, ..Input::START };
        Self { p, controller, input, output: Output::START, sample: 0 }
    }

    /// Samples of one mode, 6 mrad of the spindle each; `change` changes the inputs of each.
    fn run(&mut self, mode: Mode, samples: i32, change: impl Fn(i32, &mut Input)) {
        self.input.mode = mode;
        for k in 0..samples {
            self.sample += 1;
            self.input.arm_angle = self.output.reference.angle;
            self.input.spindle_angle = 6e-3 * f64::from(self.sample);
            change(k, &mut self.input);
            assert_no_alloc(|| self.controller.tick(&self.input, &self.p, &mut self.output));
        }
    }
}

#[test]
fn no_sample_of_a_task_allocates_under_either_law() {
    for parameters in [Parameters::START, Parameters::PAPER] {
        let mut bench = Bench::new(parameters);
        bench.run(Mode::Hold, 1000, |_, _| ());
        bench.run(Mode::Track, 8000, |_, _| ());
        assert_eq!(bench.output.state, State::Track);
        bench.run(Mode::Approach, 1000, |_, _| ());
        bench.run(Mode::Idle, 10, |_, _| ());
        assert_eq!(bench.output.state, State::Retract);
        bench.run(Mode::Track, 4000, |_, input| input.enable = false);
        assert_eq!(bench.output.state, State::Idle);
    }
}

#[test]
fn neither_a_whole_identification_nor_a_fit_allocates() {
    let mut p = Parameters::START;
    p.identify.grid = "100, 200".parse().unwrap();
    // the arm of the bench oscillates without a torque
    p.limits.arm_spread = 0.1;
    let mut bench = Bench::new(p);
    bench.run(Mode::Identify, 12_000, |_, _| ());
    assert_eq!(bench.output.identify_progress, 1.0);
    for mode in [Mode::CalibrateToroid, Mode::CalibrateFlats] {
        // cut and read in turn, solve at the end
        bench.run(mode, 2000, |k, input| {
            (input.calibration_cut, input.probe_capture) = (k % 8 < 3, k % 8 == 5);
            (input.probe_lateral, input.probe_depth) = (1e-5 * f64::from(k), 1e-8 * f64::from(k * k));
            input.calibration_solve = k == 1999;
        });
        assert!(bench.output.calibration.samples > 100);
    }
}

#[test]
fn neither_the_form_of_a_lens_nor_its_correction_allocates() {
    let mut p = Parameters::START;
    (p.form.apply, p.form.depth_max, p.form.std_max, p.limits.arm_spread) = (true, 1e-2, 1e-3, 0.1);
    let mut bench = Bench::new(p);
    bench.run(Mode::CalibrateForm, 4000, |k, input| {
        (input.probe_capture, input.calibration_solve) = (k % 2 == 1, k == 3999);
        // twenty places at each of twenty angles, and some where nothing is
        (input.probe_lateral, input.probe_angle) = (0.02 + 1e-3 * f64::from(k / 2 % 20), f64::from(k / 40) * 0.314);
        input.probe_lateral += if k > 3900 { 0.1 } else { 0.0 };
    });
    assert_eq!(bench.output.calibration.status, Status::Solved);
    bench.run(Mode::Track, 8000, |_, _| ());
    assert!(bench.output.state == State::Track && bench.output.form.corrected);
}

#[test]
fn neither_a_whole_commission_nor_what_it_brings_into_force_allocates() {
    for apply in [true, false] {
        let mut p = Parameters::START;
        // the arm of the bench follows its reference without a torque
        (p.commission.apply, p.limits.arm_spread, p.limits.drive_gain_ratio) = (apply, 0.1, 0.0);
        let mut bench = Bench::new(p);
        bench.run(Mode::Idle, 10, |_, _| ());
        bench.run(Mode::Idle, 110_000, |_, input| input.commission = true);
        assert_eq!((bench.output.state, bench.output.fault), (State::Fault, Fault::CommissionRejected));
        bench.run(Mode::Idle, 5000, |_, _| ());
        let reset = |k: i32, input: &mut Input| (input.commission, input.reset_fault) = (false, k > 5);
        bench.run(Mode::Idle, 10, reset);
        bench.run(Mode::Idle, 2000, |_, input| input.commission = true);
        assert_eq!(bench.output.state, State::Commission);
        bench.run(Mode::Idle, 2000, |_, input| input.commission = false);
        assert_eq!(bench.output.state, State::Idle);
    }
}

#[test]
fn an_error_that_grows_from_revolution_to_revolution_allocates_nothing() {
    let mut p = Parameters::START;
    // the arm of the bench does nothing for its torque
    p.limits.disturbance = 1.0;
    p.limits.following_error = 1e-2;
    let mut bench = Bench::new(p);
    bench.run(Mode::Track, 5000, |_, _| ());
    // 1047 samples per revolution, a quarter more in each
    bench.run(Mode::Track, 15_000, |k, input| {
        let wave = (2.0 * input.spindle_angle).sin();
        input.arm_angle += 2e-4 * 1.25_f64.powf(f64::from(k.min(7000)) / 1047.0) * wave;
    });
    assert_eq!((bench.output.state, bench.output.fault), (State::Fault, Fault::Divergence));
}

#[test]
fn no_fault_allocates() {
    type Spoil = fn(&mut Input);
    let wrong: [(Fault, Spoil); 5] = [
        (Fault::PositionJump, |input| input.arm_angle += 0.1),
        (Fault::SpindleJump, |input| input.spindle_angle *= 10.0),
        (Fault::SlideJump, |input| input.slide_position = 1.0),
        (Fault::PositionLost, |input| input.arm_angle = f64::NAN),
        (Fault::InvalidInput, |input| input.hold_angle = f64::NAN),
    ];
    for (fault, spoil) in wrong {
        let mut bench = Bench::new(Parameters::START);
        bench.run(Mode::Track, 5000, |_, _| ());
        // until the arm is out of the part
        bench.run(Mode::Track, 4000, |_, input| spoil(input));
        assert_eq!((bench.output.state, bench.output.fault), (State::Fault, fault));
        bench.run(Mode::Track, 10, |k, input| input.reset_fault = k > 5);
        assert_eq!((bench.output.state, bench.output.fault), (State::Idle, Fault::None));
        (bench.input.slide_position, bench.input.hold_angle) = (0.04, 0.0);
        bench.run(Mode::Hold, 100, |_, _| ());
        assert_eq!(bench.output.state, State::Hold);
    }
}
