//! The sample allocates nothing: not while holding, moving onto the path, tracking, nor in a fault.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use fmu_fts::controller::{Controller, Tables};
use fmu_fts::machine::Mode;
use fmu_fts::parameters::Parameters;
use fmu_fts::signals::{Input, Output};

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
    let mut controller = Controller::new(&p, &Tables::default()).unwrap();
    let mut output = Output::START;
    let before = ALLOCATIONS.get();
    for (mode, arm_angle, count) in [
        (Mode::Hold, None, 1000),
        (Mode::Track, None, 8000),
        (Mode::Identify, None, 5000),
        (Mode::CalibrateFlats, None, 1000),
        (Mode::Track, Some(f64::NAN), 100),
        (Mode::Off, None, 100),
    ] {
        for k in 0..count {
            let input = Input {
                arm_angle: arm_angle.unwrap_or(output.reference.angle),
                spindle_angle: 6e-3 * f64::from(k),
                slide_position: 0.04,
                mode,
                ..Input::START
            };
            controller.tick(&p, &input, &mut output);
        }
    }
    assert_eq!(ALLOCATIONS.get(), before);
}
