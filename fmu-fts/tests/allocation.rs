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

#[test]
fn neither_a_whole_identification_nor_a_fit_allocates() {
    let mut p = Parameters::DEFAULT;
    p.identify.frequencies = "100, 200".parse().unwrap();
    let mut controller = Controller::new(&p, &Tables::default()).unwrap();
    let mut output = Output::START;
    let before = ALLOCATIONS.get();
    for (mode, count) in [(Mode::Identify, 12_000), (Mode::CalibrateToroid, 2000), (Mode::CalibrateFlats, 2000)] {
        for k in 0..count {
            // cut and read in turn, solve at the end
            let mut input = Input { arm_angle: output.reference.angle, slide_position: 0.04, mode, ..Input::START };
            (input.calibration.cut, input.probe.capture) = (k % 8 < 3, k % 8 == 5);
            (input.probe.lateral, input.probe.depth) = (1e-5 * f64::from(k), 1e-8 * f64::from(k * k));
            input.calibration.solve = k == count - 1;
            controller.tick(&p, &input, &mut output);
        }
    }
    assert_eq!(ALLOCATIONS.get(), before);
    assert_eq!(output.identify.progress, 1.0);
    assert!(output.calibration.samples > 100);
}
