//! Loading and unloading leaks no memory. Alone in its process, so that nothing else allocates.
#![cfg(target_os = "linux")]

mod common;

use common::*;
use std::fs;
use std::path::Path;

/// Resident memory of this process, in kB.
fn resident() -> i64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    between(&status, "VmRSS:", "kB").trim().parse().unwrap()
}

/// Mappings of the library in this process.
fn mappings() -> usize {
    fs::read_to_string("/proc/self/maps").unwrap().matches("libprobe").count()
}

/// Everything an importer does with an FMU, from loading to unloading.
fn cycle(library: &Path, description: &str) {
    let fmu = Fmu::load_described(library, description.to_owned());
    let (first, second) = (Instance::started(&fmu), Instance::started(&fmu));
    assert_eq!(first.set_real("position", 1.0), OK);
    assert_eq!(first.step(0.0, 1e-2), OK);
    second.restore(&first.bytes());
    // states that are not freed go with their instances
    first.take_state();
    second.take_state();
    assert_eq!(second.step(1e-2, 1e-2), OK);
    assert_eq!((second.integer("ticks"), second.text("text").is_empty()), (20, false));
    assert_eq!((second.set_real("gain", -1.0), second.step(0.0, -1.0)), (DISCARD, ERROR));
    assert_eq!((first.terminate(), first.reset()), (OK, OK));
    assert_ne!(mappings(), 0);
}

#[test]
fn a_thousand_cycles_leave_no_mapping_and_no_growth() {
    let (library, description) = (example("probe"), Fmu::probe().description);
    (0..100).for_each(|_| cycle(&library, &description));
    assert_eq!(mappings(), 0);
    let before = resident();
    (0..1000).for_each(|_| cycle(&library, &description));
    assert_eq!(mappings(), 0);
    let growth = resident() - before;

    assert!(growth < 128, "1000 cycles took {growth} kB");
}
