//! The stepper on a plant and a controller of a few lines of C-like Rust.

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::NonNull;

use cosim_engine::ffi::{Apply, Bank, Body, Call, Controller, Functions, Physics, Slot, Table, Trap};
use cosim_engine::{
    Condition, Delay, End, Failure, FaultEffect, Injection, Link, Links, Log, Machine, Operation, Shape, Stepper,
    Trigger,
};
use plants::{Circuit, Element, Place, Ports};

/// model of the fake plant: x continues by h u in the second half, the first half copies it to the sensor
#[derive(Default)]
struct FakePlant {
    x: f64,
    u: f64,
    sensor: f64,
    warnings: c_int,
    halves: usize,
}

unsafe extern "C-unwind" fn first_half(_: *const c_void, data: *mut c_void) {
    // SAFETY: the tests pass a `FakePlant`.
    let world = unsafe { &mut *data.cast::<FakePlant>() };
    world.sensor = world.x;
    world.halves += 1;
}

unsafe extern "C-unwind" fn second_half(_: *const c_void, data: *mut c_void) {
    // SAFETY: as above.
    let world = unsafe { &mut *data.cast::<FakePlant>() };
    world.x += 0.5 * world.u;
    world.halves += 1;
    world.warnings = c_int::from(world.x > 1e3);
}

/// controller: out = -0.5 in, and an error on demand
#[derive(Default)]
struct FakeController {
    real: [f64; 2],
    times: Vec<f64>,
    fail_at: Option<usize>,
    end_at: Option<usize>,
}

unsafe extern "C" fn set(brain: *mut c_void, references: *const c_uint, count: usize, values: *mut c_void) -> c_int {
    // SAFETY: the tests pass a `FakeController` and arrays of `count`.
    unsafe {
        for i in 0..count {
            (*brain.cast::<FakeController>()).real[references.add(i).read() as usize] =
                values.cast::<f64>().add(i).read();
        }
    }
    0
}

unsafe extern "C" fn get(brain: *mut c_void, references: *const c_uint, count: usize, values: *mut c_void) -> c_int {
    // SAFETY: as above.
    unsafe {
        for i in 0..count {
            values
                .cast::<f64>()
                .add(i)
                .write((&(*brain.cast::<FakeController>()).real)[references.add(i).read() as usize]);
        }
    }
    1
}

unsafe extern "C" fn do_step(brain: *mut c_void, time: f64, _: f64, _: c_int) -> c_int {
    // SAFETY: as above.
    let brain = unsafe { &mut *brain.cast::<FakeController>() };
    let k = brain.times.len();
    brain.times.push(time);
    brain.real[1] = -0.5 * brain.real[0];
    if brain.fail_at == Some(k) {
        3
    } else if brain.end_at == Some(k) {
        2
    } else {
        0
    }
}

unsafe extern "C" fn status(brain: *mut c_void, kind: c_int, value: *mut c_int) -> c_int {
    // SAFETY: as above.
    unsafe { value.write(c_int::from(kind == 3 && (*brain.cast::<FakeController>()).end_at.is_some())) };
    0
}

unsafe extern "C" fn make(_: *const c_void, _: c_int, _: *const c_void, _: *mut c_char, _: c_int) -> *mut c_void {
    NonNull::<u64>::dangling().as_ptr().cast()
}

unsafe extern "C" fn delete(_: *mut c_void) {}

unsafe extern "C-unwind" fn apply(
    _: *mut c_void,
    _: *const c_int,
    _: c_int,
    body: Body,
    argument: *mut c_void,
    _: c_int,
) -> c_int {
    // SAFETY: as MuJoCo calls it.
    unsafe { body(std::ptr::null(), std::ptr::null_mut(), 0, argument) };
    0
}

unsafe extern "C-unwind" fn refuse(
    _: *mut c_void,
    _: *const c_int,
    _: c_int,
    _: Body,
    _: *mut c_void,
    _: c_int,
) -> c_int {
    1
}

unsafe extern "C" fn words(_: *const c_void, _: c_int) -> *const c_char {
    c"mj_step1: requested failure\n".as_ptr()
}

/// All memory of a loop; boxed, so that it stays where it is.
#[derive(Default)]
struct Bench {
    world: FakePlant,
    brain: FakeController,
    sensed: f64,
    command: f64,
    input: f64,
    output: f64,
    table: [[f64; 4]; 8],
    begin: f64,
}

fn at(value: &mut f64) -> Slot {
    // SAFETY: the bench outlives the stepper.
    unsafe { Slot::real(NonNull::from(value)) }
}

fn link(source: Slot, target: Slot, delay: usize) -> Link {
    let (minimum, maximum) = (f64::NEG_INFINITY, f64::INFINITY);
    let shape = Shape { from_plant: true, scale: 1.0, offset: 0.0, quantum: 0.0, minimum, maximum };
    Link { source, target, shape, noise: None, delay: Delay::new(delay, vec![0.0; delay]) }
}

fn place(value: &mut f64) -> Place {
    // SAFETY: the bench outlives the stepper.
    unsafe { Place::new(NonNull::from(value), 1, (1.0, 0.0), 0, false) }
}

fn machine(world: &mut FakePlant, substeps: usize) -> Machine {
    let warnings = vec![&raw const world.warnings];
    // SAFETY: the fakes do what MuJoCo does, and the bench outlives the stepper.
    let physics =
        unsafe { Physics::new(first_half, second_half, std::ptr::null(), (&raw mut *world).cast(), warnings) };
    Machine {
        physics,
        timestep: 0.5,
        substeps,
        readings: vec![place(&mut world.sensor)],
        commands: vec![place(&mut world.u)],
        truths: vec![place(&mut world.x)],
    }
}

fn controller(bench: &mut Bench) -> Controller {
    static REFERENCES: [c_uint; 2] = [0, 1];
    let call = |function, reference: usize, value: &mut f64| Call {
        function,
        references: &raw const REFERENCES[reference],
        count: 1,
        values: (&raw mut *value).cast(),
    };
    let (set, get) = (vec![call(set, 0, &mut bench.input)], vec![call(get, 1, &mut bench.output)]);
    // SAFETY: the bench outlives the stepper.
    unsafe { Controller::new((&raw mut bench.brain).cast(), set, do_step, status, get) }
}

fn log(bench: &mut Bench, stop: Option<Condition>) -> Log {
    // SAFETY: the bench outlives the stepper.
    unsafe {
        let banks =
            vec![Bank::reals(NonNull::from(&mut bench.input), 1), Bank::reals(NonNull::from(&mut bench.output), 1)];
        let table = Table::new(NonNull::from(&mut bench.table).cast(), 8, 4);
        Log { table, start: 1, banks, every: 1, stop, triggers: vec![] }
    }
}

fn links(bench: &mut Bench, delay: usize) -> Links {
    Links {
        sensed: vec![at(&mut bench.sensed)],
        readings: vec![link(at(&mut bench.sensed), at(&mut bench.input), 0)],
        outputs: vec![link(at(&mut bench.output), at(&mut bench.command), delay)],
        commands: vec![at(&mut bench.command)],
        ..Links::default()
    }
}

fn stepper(bench: &mut Bench, delay: usize, substeps: usize, apply: Apply, stop: Option<Condition>) -> Stepper {
    let (links, log) = (links(bench, delay), log(bench, stop));
    assembled(bench, substeps, apply, links, log)
}

fn assembled(bench: &mut Bench, substeps: usize, apply: Apply, links: Links, log: Log) -> Stepper {
    let controller = controller(bench);
    let functions = Functions { make, delete, apply, error: words };
    // SAFETY: the fakes do what MuJoCo does.
    let trap = unsafe { Trap::new(functions, std::ptr::null()) }.expect("a trap");
    Stepper::new(machine(&mut bench.world, substeps), Some(controller), links, Some(log), 0.1, trap)
}

fn start() -> Box<Bench> {
    Box::new(Bench { world: FakePlant { x: 1.0, ..FakePlant::default() }, sensed: 1.0, ..Bench::default() })
}

fn run(stepper: &mut Stepper, until: usize) -> Result<Option<End>, Failure> {
    stepper.run(&mut Circuit::default(), &mut Circuit::default(), until)
}

#[test]
fn the_controller_moves_first_and_sees_the_plant_of_its_time() {
    // x continues by 2 * 0.5 * u = -0.5 x
    let mut bench = start();
    let mut stepper = stepper(&mut bench, 0, 2, apply, None);
    assert_eq!(run(&mut stepper, 1), Ok(None));
    assert_eq!(run(&mut stepper, 4), Ok(None));
    assert_eq!(stepper.steps(), 4);
    let rows = [[0.0, 1.0, -0.5, 1.0], [0.1, 0.5, -0.25, 0.5], [0.2, 0.25, -0.125, 0.25]];
    assert_eq!(bench.table[..3], rows);
    assert_eq!(bench.table[3][0].to_bits(), (3.0 * 0.1_f64).to_bits());
    // the measurements at time zero were read before
    assert_eq!(bench.world.halves, 4 * 2 * 2 - 1);
    assert_eq!(stepper.warned(), Some((2, 0.0)));
    assert_eq!(bench.brain.times, [0.0, 0.1, 0.2, 3.0 * 0.1]);
}

#[test]
fn a_delayed_command_acts_one_step_later() {
    let mut bench = start();
    let mut stepper = stepper(&mut bench, 1, 1, apply, None);
    assert_eq!(run(&mut stepper, 4), Ok(None));
    let truths = bench.table.map(|row| row[3]);
    assert_eq!(truths[..4], [1.0, 1.0, 0.75, 0.5]);
}

#[test]
fn a_condition_ends_the_run_after_its_step() {
    let program = vec![Operation::Column(3), Operation::Number(0.3), Operation::named("less").expect("an operation")];
    let mut bench = start();
    let mut stepper = stepper(&mut bench, 0, 2, apply, Condition::new(program, 4));
    assert_eq!(run(&mut stepper, 8), Ok(Some(End::Stopped)));
    assert_eq!((stepper.steps(), bench.world.x), (3, 0.125));
}

#[test]
fn a_controller_that_terminates_ends_the_run_after_its_step() {
    let mut bench = start();
    bench.brain.end_at = Some(2);
    let mut ending = stepper(&mut bench, 0, 2, apply, None);
    assert_eq!(run(&mut ending, 8), Ok(Some(End::Terminated)));
    assert_eq!((ending.steps(), bench.world.x), (3, 0.125));
}

#[test]
fn a_condition_begins_an_injection_once_and_it_ends_by_itself() {
    let program = vec![Operation::Column(3), Operation::Number(0.6), Operation::named("less").expect("an operation")];
    let mut bench = start();
    bench.begin = f64::INFINITY;
    let (mut links, mut log) = (links(&mut bench, 0), log(&mut bench, None));
    let (change, target) = (FaultEffect::Offset(1.0), at(&mut bench.input));
    links.input_faults = vec![Injection { begin: at(&mut bench.begin), length: 2.0, change, series: None, target }];
    let condition = Condition::new(program, 4).expect("a condition");
    log.triggers = vec![Trigger { condition, delay: 1.0, begin: at(&mut bench.begin) }];
    let mut stepper = assembled(&mut bench, 2, apply, links, log);
    assert_eq!(run(&mut stepper, 5), Ok(None));
    // x is below 0.6 in the row of step 1; what arrives in the steps 2 and 3 is x + 1
    let rows = bench.table.map(|row| (row[1], row[3]));
    assert_eq!(rows[..5], [(1.0, 1.0), (0.5, 0.5), (1.25, 0.25), (0.625, -0.375), (-0.6875, -0.6875)]);
    assert_eq!(bench.begin, 2.0);
}

#[test]
fn failures_name_their_step() {
    let mut bench = start();
    bench.brain.fail_at = Some(2);
    let mut stepper = stepper(&mut bench, 0, 1, apply, None);
    assert_eq!(run(&mut stepper, 8), Err(Failure::Call { call: 1, status: 3 }));
    assert_eq!(stepper.steps(), 2);
}

#[test]
fn what_is_not_finite_is_found_where_it_arises() {
    let mut bench = start();
    bench.world.x = f64::NAN;
    assert_eq!(run(&mut stepper(&mut bench, 0, 1, apply, None), 2), Err(Failure::Sensed));
    (bench.world.x, bench.sensed) = (1e4, 1e4);
    let mut stepper = stepper(&mut bench, 0, 1, apply, None);
    assert_eq!(run(&mut stepper, 8), Err(Failure::Warning));
    assert_eq!(stepper.steps(), 1);
}

#[test]
fn words_of_a_mujoco_error_come_back() {
    let mut bench = start();
    let refused = run(&mut stepper(&mut bench, 0, 1, refuse, None), 1);
    assert_eq!(refused, Err(Failure::MuJoCo("mj_step1: requested failure".into())));
}

#[derive(Clone)]
struct Panics;

impl Element for Panics {
    fn ports(&self) -> Ports {
        Ports { inputs: &[], outputs: &[] }
    }

    fn step(&mut self, _: &[f64], _: &mut [f64], _: f64) {
        panic!("a bug of an element");
    }
}

#[test]
fn a_panic_crosses_no_c_function() {
    let mut bench = start();
    let mut stepper = stepper(&mut bench, 0, 1, apply, None);
    let mut broken = Circuit::default();
    broken.bind("bug".into(), Box::new(Panics), vec![], vec![]);
    let caught = catch_unwind(AssertUnwindSafe(|| stepper.run(&mut Circuit::default(), &mut broken, 1)));
    let words = caught.expect_err("a panic");
    assert_eq!(words.downcast_ref::<&str>(), Some(&"a bug of an element"));
}
