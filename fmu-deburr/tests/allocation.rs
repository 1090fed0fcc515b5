//! A sample allocates nothing: not in a motion, not while learning, not at the end of a repetition, nor in a fault.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::Path;

use fmu_deburr::controller::Controller;
use fmu_deburr::machine::{Mode, State};
use fmu_deburr::parameters::{Law, Parameters};
use fmu_deburr::path_file;
use fmu_deburr::signals::{Input, Output};

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
    for law in [Law::Plain, Law::LeadFilter, Law::NormOptimal] {
        let mut p = Parameters::DEFAULT;
        (p.learn.law, p.learn.repetitions) = (law, 1);
        let resources = Path::new(env!("CARGO_MANIFEST_DIR")).join("resources");
        let path = path_file::read(&p, "path.json", Some(&resources)).unwrap();
        let mut controller = Controller::new(&p, path, "path.json").unwrap();
        let (mut input, mut output) = (Input::START, Output::START);
        let before = ALLOCATIONS.get();
        for mode in [Mode::DryRun, Mode::Learn, Mode::Playback, Mode::Deburr, Mode::Export] {
            input.mode = mode;
            for k in 0..20_000 {
                // the axes are where they should be, a little late
                input.set_positions(&output.axes().map(|axis| axis.reference));
                controller.tick(&p, &input, &mut output);
                if k > 0 && output.state == State::Done {
                    break;
                }
            }
            assert_eq!(output.state, State::Done, "{mode:?} {:?}", output.fault);
        }
        input.spindle_speed = f64::NAN;
        controller.tick(&p, &input, &mut output);
        assert_eq!(output.state, State::Fault);
        assert_eq!(ALLOCATIONS.get(), before);
    }
}
