//! An importer of others, fmi-rs, loads and steps the packed FMU.
#![cfg(not(target_os = "windows"))]

#[path = "../../tests/common/mod.rs"]
mod common;

use cargo_fmu::platform::Platform;
use cargo_fmu::{binary, pack};
use common::example;
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::{fmi2Status, fmi2StatusKind};
use fmi_rs::fmi2::{CS, FMU2, ME};
use fmi_rs::model_description::fmi2::{Causality, ModelDescription, ScalarVariable, VariableType};
use std::path::PathBuf;
use std::sync::Arc;

/// The probe, packed by the project's own packer.
fn packed(folder: &tempfile::TempDir) -> PathBuf {
    let library = example("probe");
    let mut content = pack::Content::default();
    for (path, text) in binary::files(&library).unwrap() {
        content.add(path, text.into_bytes()).unwrap();
    }
    let platform = Platform::host().unwrap();
    let inside = format!("binaries/{}/probe.{}", platform.folder, platform.extension);
    content.add(inside, std::fs::read(&library).unwrap()).unwrap();
    let file = folder.path().join("probe \u{e9}.fmu");
    std::fs::write(&file, pack::to_bytes(&content, pack::Effort::Quick).unwrap()).unwrap();
    file
}

fn reference(description: &ModelDescription, name: &str) -> [u32; 1] {
    let variable = description.modelVariables.iter().find(|variable| variable.name == name);
    [variable.unwrap_or_else(|| panic!("fmi-rs reads no variable `{name}`")).valueReference]
}

fn real(fmu: &FMU2<CS>, reference: &[u32; 1]) -> f64 {
    let mut value = [f64::NAN];
    assert_eq!(fmu.getReal(reference, &mut value), fmi2Status::Ok);
    value[0]
}

#[test]
fn fmi_rs_reads_the_description() {
    let folder = tempfile::tempdir().unwrap();
    let description = FMU2Builder::new(&packed(&folder)).unwrap().model_description;
    assert_eq!((description.modelName.as_str(), description.modelVariables.len()), ("Probe", 25));
    let count = |causality| description.modelVariables.iter().filter(|v| v.causality == causality).count();
    assert_eq!((count(Causality::Input), count(Causality::Output)), (4, 5));
}

#[test]
fn fmi_rs_steps_the_fmu() {
    let folder = tempfile::tempdir().unwrap();
    let builder = FMU2Builder::new(&packed(&folder)).unwrap();
    let find = |name| reference(&builder.model_description, name);
    let (position, gain, force, ticks, label) =
        (find("position"), find("gain"), find("force"), find("ticks"), find("label"));
    let fmu: Arc<FMU2<CS>> = builder.instantiate_cs("a name with blanks").unwrap();
    assert_eq!((fmu.getVersion().as_str(), fmu.getTypesPlatform().as_str()), ("2.0", "default"));
    assert_eq!(fmu.setString(&label, &["fmi-rs \u{b5}"]), fmi2Status::Ok);
    assert_eq!(fmu.setReal(&gain, &[4.0]), fmi2Status::Ok);
    assert_eq!(fmu.setupExperiment(Some(1e-6), 0.0, Some(1.0)), fmi2Status::Ok);
    assert_eq!(fmu.enterInitializationMode(), fmi2Status::Ok);
    assert_eq!(fmu.exitInitializationMode(), fmi2Status::Ok);

    for k in 0..100 {
        let time = f64::from(k) * 0.01;
        assert_eq!(fmu.setReal(&position, &[time]), fmi2Status::Ok);
        assert_eq!(fmu.doStep(time, 0.01, 1), fmi2Status::Ok);
        assert_eq!(real(&fmu, &force), (4.0 * time + 1.5).min(10.0));
    }
    let (mut count, mut time) = ([0], f64::NAN);
    assert_eq!(fmu.getInteger(&ticks, &mut count), fmi2Status::Ok);
    assert_eq!(count, [1000]);
    assert_eq!(fmu.getRealStatus(&fmi2StatusKind::LastSuccessfulTime, &mut time), fmi2Status::Ok);
    assert!((time - 1.0).abs() < 1e-12);
    // one step more would pass the stop time
    assert_eq!(fmu.doStep(1.0, 0.01, 1), fmi2Status::Error);
    assert_eq!(fmu.reset(), fmi2Status::Ok);
}

#[test]
fn fmi_rs_takes_and_restores_states() {
    let folder = tempfile::tempdir().unwrap();
    let builder = FMU2Builder::new(&packed(&folder)).unwrap();
    let find = |name| reference(&builder.model_description, name);
    let (position, force) = (find("position"), find("force"));
    let fmu: Arc<FMU2<CS>> = builder.instantiate_cs("probe").unwrap();
    assert_eq!(fmu.setupExperiment(None, 0.0, None), fmi2Status::Ok);
    assert_eq!((fmu.enterInitializationMode(), fmu.exitInitializationMode()), (fmi2Status::Ok, fmi2Status::Ok));

    let (mut state, mut restored, mut size) = (std::ptr::null_mut(), std::ptr::null_mut(), 0);
    assert_eq!(fmu.getFMUstate(&mut state), fmi2Status::Ok);
    assert_eq!(fmu.serializedFMUstateSize(state, &mut size), fmi2Status::Ok);
    let mut bytes = vec![0; size];
    assert_eq!(fmu.serializeFMUstate(state, &mut bytes), fmi2Status::Ok);
    let run = || {
        assert_eq!(fmu.setReal(&position, &[1.0]), fmi2Status::Ok);
        assert_eq!(fmu.doStep(0.0, 0.01, 0), fmi2Status::Ok);
        real(&fmu, &force)
    };
    assert_eq!(run(), 3.5);
    assert_eq!(fmu.deSerializeFMUstate(&bytes, &mut restored), fmi2Status::Ok);
    assert_eq!(fmu.setFMUstate(restored), fmi2Status::Ok);
    assert_eq!(run(), 3.5);
    assert_eq!(fmu.freeFMUstate(&mut state), fmi2Status::Ok);
    assert_eq!(fmu.freeFMUstate(&mut restored), fmi2Status::Ok);
}

#[test]
fn fmi_rs_comes_to_the_time_events() {
    let folder = tempfile::tempdir().unwrap();
    let builder = FMU2Builder::new(&packed(&folder)).unwrap();
    let find = |name| reference(&builder.model_description, name);
    let (position, force, ticks) = (find("position"), find("force"), find("ticks"));
    let fmu: Arc<FMU2<ME>> = builder.instantiate_me("events").unwrap();
    assert_eq!(fmu.setupExperiment(None, 0.0, Some(1.0)), fmi2Status::Ok);
    assert_eq!((fmu.enterInitializationMode(), fmu.exitInitializationMode()), (fmi2Status::Ok, fmi2Status::Ok));
    for k in 1..=100 {
        let ([mut needed, mut end, mut nominals, mut values], mut next) = ([true; 4], None);
        assert_eq!(fmu.setReal(&position, &[f64::from(k)]), fmi2Status::Ok);
        let status = fmu.newDiscreteStates(&mut needed, &mut end, &mut nominals, &mut values, &mut next);
        let (mut value, mut count) = ([f64::NAN], [0]);
        assert_eq!(fmu.getReal(&force, &mut value), fmi2Status::Ok);
        assert_eq!(fmu.getInteger(&ticks, &mut count), fmi2Status::Ok);
        assert_eq!((value[0], count[0]), ((2.0 * f64::from(k) + 1.5).min(10.0), k));
        assert_eq!((status, needed, end, nominals, values), (fmi2Status::Ok, false, false, false, false));
        let next = next.unwrap();
        assert_eq!(next, f64::from(k) * 1e-3);
        assert_eq!(fmu.enterContinuousTimeMode(), fmi2Status::Ok);
        assert_eq!((fmu.setTime(next), fmu.enterEventMode()), (fmi2Status::Ok, fmi2Status::Ok));
    }
}

/// Real outputs of an FMU with the start values, sample by sample: by steps, and by events.
fn samples(file: &PathBuf, count: u32) -> [Vec<Vec<f64>>; 2] {
    let builder = FMU2Builder::new(file).unwrap();
    let description = &builder.model_description;
    let step = description.defaultExperiment.as_ref().and_then(|told| told.stepSize.clone()).unwrap();
    let step: f64 = step.parse().unwrap();
    let is_told =
        |v: &&ScalarVariable| v.causality == Causality::Output && matches!(v.variableType, VariableType::Real { .. });
    let outputs: Vec<_> = description.modelVariables.iter().filter(is_told).map(|v| v.valueReference).collect();
    let mut values = vec![f64::NAN; outputs.len()];

    let fmu: Arc<FMU2<CS>> = builder.instantiate_cs("steps").unwrap();
    assert_eq!(fmu.setupExperiment(None, 0.0, None), fmi2Status::Ok);
    assert_eq!((fmu.enterInitializationMode(), fmu.exitInitializationMode()), (fmi2Status::Ok, fmi2Status::Ok));
    let steps = (0..count).map(|k| {
        assert_ne!(fmu.doStep(f64::from(k) * step, step, 1), fmi2Status::Error);
        assert_eq!(fmu.getReal(&outputs, &mut values), fmi2Status::Ok);
        values.clone()
    });
    let steps = steps.collect();

    let fmu: Arc<FMU2<ME>> = FMU2Builder::new(file).unwrap().instantiate_me("events").unwrap();
    assert_eq!(fmu.setupExperiment(None, 0.0, None), fmi2Status::Ok);
    assert_eq!((fmu.enterInitializationMode(), fmu.exitInitializationMode()), (fmi2Status::Ok, fmi2Status::Ok));
    let events = (0..count).map(|_| {
        let ([mut needed, mut end, mut nominals, mut changed], mut next) = ([true; 4], None);
        let status = fmu.newDiscreteStates(&mut needed, &mut end, &mut nominals, &mut changed, &mut next);
        assert_ne!(status, fmi2Status::Error);
        assert_eq!(fmu.getReal(&outputs, &mut values), fmi2Status::Ok);
        assert_eq!(fmu.enterContinuousTimeMode(), fmi2Status::Ok);
        assert_eq!((fmu.setTime(next.unwrap()), fmu.enterEventMode()), (fmi2Status::Ok, fmi2Status::Ok));
        values.clone()
    });
    [steps, events.collect()]
}

#[test]
fn fmi_rs_runs_the_fmus_that_lie_packed_in_the_workspace() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../target/fmu");
    let files = std::fs::read_dir(&folder).into_iter().flatten().map(|entry| entry.unwrap().path());
    for file in files.filter(|file| file.extension().is_some_and(|extension| extension == "fmu")) {
        let [steps, events] = samples(&file, 200);
        assert!(steps.iter().all(|row| !row.is_empty() && row.iter().all(|value| value.is_finite())), "{file:?}");
        assert_eq!(steps, events, "{file:?}");
    }
}
