//! A sample allocates nothing: not in a motion, not while learning, not at the end of a repetition, nor in a fault.
//!
//! The one exception is the sample that writes the bank to a file; it is not one of the law.

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use fmu_deburr::controller::Controller;
use fmu_deburr::interface::{AxisInput, Fault, Input, Law, LearningLaw, Mode, Output, Parameters, State};
use fmu_deburr::path::path_file;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// The controller on axes that are where they should be, a little late.
struct Loop {
    controller: Controller,
    parameters: Parameters,
    input: Input,
    output: Output,
}

impl Loop {
    fn new(change: impl FnOnce(&mut Parameters)) -> Self {
        let mut parameters = Parameters::START;
        parameters.learn.repetitions = 1;
        change(&mut parameters);
        let path = path_file::read(&parameters, None).unwrap();
        let controller = Controller::new(&parameters, path).unwrap();
        Self { controller, parameters, input: Input { enable: true, ..Input::START }, output: Output::START }
    }

    fn step(&mut self) {
        self.input.axis = self.output.axis.map(|axis| AxisInput { position: axis.reference });
        self.tick();
    }

    fn tick(&mut self) {
        assert_no_alloc(|| self.controller.tick(&self.input, &self.parameters, &mut self.output));
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
fn no_sample_of_a_job_allocates() {
    let laws: [fn(&mut Parameters); 4] = [
        |p| p.law = Law::Paper,
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
fn no_fault_allocates() {
    let running = |mode: Mode| {
        let mut run = Loop::new(|p| (p.lookup.enable, p.limits.pulses_max) = (false, 1.0));
        run.input.mode = mode;
        run.step_until(|output| output.path.distance > 0.0);
        run
    };
    for fault in Fault::ALL {
        let mut run = match fault {
            Fault::None => continue,
            Fault::BankEmpty => Loop::new(|_| ()),
            Fault::PatternTooLarge => running(Mode::Learn),
            Fault::InvalidInput | Fault::ControlError | Fault::SpindleSlow => running(Mode::Deburr),
        };
        match fault {
            Fault::InvalidInput => run.input.spindle_speed = f64::NAN,
            Fault::SpindleSlow => run.input.spindle_speed = 1000.0,
            Fault::BankEmpty => run.input.mode = Mode::Playback,
            _ => {}
        }
        for _ in 0..2000 {
            match fault {
                // axes that stay, or that follow badly
                Fault::ControlError => run.tick(),
                _ => run.step(),
            }
        }
        assert_eq!((run.output.state, run.output.fault), (State::Fault, *fault));
        run.input.spindle_speed = 1885.0;
        run.step();
        run.input.reset_fault = true;
        run.step_until(|output| output.state == State::Idle);
    }
}
