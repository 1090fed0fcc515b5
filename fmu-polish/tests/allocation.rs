//! The sample allocates nothing: not while it approaches, settles, follows, nor in a fault.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use common::{file, spiral};
use fmu_polish::axes::Axes;
use fmu_polish::cl_file::points;
use fmu_polish::controller::Controller;
use fmu_polish::machine::State;
use fmu_polish::parameters::Parameters;
use fmu_polish::signals::{Input, Output};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, counted for each thread.
struct Counting;

// SAFETY: every call is passed on to the system's allocator as it is
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller keeps the rules of `alloc`
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `System.alloc` with this layout
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn no_sample_allocates() {
    let p = Parameters::DEFAULT;
    let path = points(file(&spiral(200)).as_bytes(), &p).unwrap();
    let mut controller = Controller::new(&p, &path).unwrap();
    let mut output = Output::START;
    let mut position = path[0].contact + (p.tool.radius + 1e-4) * path[0].normal;
    let mut seen = Vec::with_capacity(10_000);
    let before = ALLOCATIONS.get();
    for k in 0..8000 {
        // a mold that is a spring of its own
        let depth = (output.desired.vector() - position).dot(&output.normal.vector());
        let force = output.normal.vector() * (178e3 * depth.max(0.0));
        let broken = k > 7900;
        let force = if broken { Axes::all(f64::NAN) } else { force.into() };
        let input = Input { enable: true, position: position.into(), force, ..Input::START };
        controller.tick(&p, &input, &mut output);
        let v = output.velocity;
        position += Axes { x: v.x, y: v.y, z: v.z }.vector() * p.sample_period;
        seen.push(output.state);
    }
    assert_eq!(ALLOCATIONS.get(), before);
    for state in [State::Idle, State::Approach, State::Settle, State::Follow, State::Fault] {
        assert!(seen.contains(&state), "{state:?}");
    }
}
