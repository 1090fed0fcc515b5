//! Every function in every phase, against the table of FMI 2.0.5, sections 3.2.3 and 4.2.4.

use crate::common::*;
use std::ffi::c_int;
use std::ptr::{null, null_mut};

/// Status of an allowed call, and the phase after it; `None` if the call does not change the phase.
type Answer = (Status, Option<Phase>);

const STAYS: Answer = (OK, None);
/// Not offered by a sampled controller: allowed by the table, answered with an error.
const NOT_OFFERED: Answer = (ERROR, Some(Phase::Error));
/// Synchronous steps: nothing is pending, so a status is discarded (section 4.2.3).
const DISCARDED: Answer = (DISCARD, None);

const CS: &[c_int] = &[CO_SIMULATION];
const ME: &[c_int] = &[MODEL_EXCHANGE];
const BOTH: &[c_int] = &[MODEL_EXCHANGE, CO_SIMULATION];

struct Row {
    function: &'static str,
    /// FMU types that have it.
    types: &'static [c_int],
    /// Letters of the phases: Instantiated, iNitialization, Step complete, eVent mode, Continuous-time mode, Terminated,
    /// Error.
    phases: &'static str,
    answer: Answer,
    call: fn(&Instance, State) -> Status,
}

macro_rules! rows {
    ($($function:ident $types:ident $phases:literal $answer:expr, |$i:ident, $s:pat_param| $call:expr;)+) => {
        &[$(Row {
            function: stringify!($function),
            types: $types,
            phases: $phases,
            answer: $answer,
            call: |$i, $s| unsafe { $call },
        }),+]
    };
}

/// The table has no error column entry for fmi2GetXxxStatus; here they also answer after an error, so that a master can
/// ask how far the instance came. Nor has it fmi2SetInteger, -Boolean and -String in continuous-time mode; here they
/// may write again what is there.
#[rustfmt::skip]
#[allow(unused_unsafe, reason = "some rows call short forms, which are safe")]
const TABLE: &[Row] = rows! {
    fmi2SetDebugLogging             BOTH "INSVCTE"  STAYS, |i, _| (i.fmu.set_debug_logging)(i.component, 1, 0, null());
    fmi2SetupExperiment             BOTH "I"        STAYS, |i, _| i.setup(0.0, None);
    fmi2EnterInitializationMode     BOTH "I"        (OK, Some(Phase::Initialization)), |i, _| i.enter();
    fmi2ExitInitializationMode      BOTH "N"        (OK, Some(Phase::StepComplete)), |i, _| i.exit();
    fmi2Terminate                   BOTH "SVC"      (OK, Some(Phase::Terminated)), |i, _| i.terminate();
    fmi2Reset                       BOTH "INSVCTE"  (OK, Some(Phase::Instantiated)), |i, _| i.reset();
    fmi2GetReal                     BOTH "NSVCTE"   STAYS, |i, _| (i.fmu.get_real)(i.component, null(), 0, null_mut());
    fmi2GetInteger                  BOTH "NSVCTE"   STAYS, |i, _| (i.fmu.get_integer)(i.component, null(), 0, null_mut());
    fmi2GetBoolean                  BOTH "NSVCTE"   STAYS, |i, _| (i.fmu.get_boolean)(i.component, null(), 0, null_mut());
    fmi2GetString                   BOTH "NSVCTE"   STAYS, |i, _| (i.fmu.get_string)(i.component, null(), 0, null_mut());
    fmi2SetReal                     BOTH "INSVC"    STAYS, |i, _| (i.fmu.set_real)(i.component, null(), 0, null());
    fmi2SetInteger                  BOTH "INSVC"    STAYS, |i, _| (i.fmu.set_integer)(i.component, null(), 0, null());
    fmi2SetBoolean                  BOTH "INSVC"    STAYS, |i, _| (i.fmu.set_boolean)(i.component, null(), 0, null());
    fmi2SetString                   BOTH "INSVC"    STAYS, |i, _| (i.fmu.set_string)(i.component, null(), 0, null());
    fmi2GetFMUstate                 BOTH "INSVCTE"  STAYS, |i, mut s| (i.fmu.get_fmu_state)(i.component, &mut s);
    fmi2SetFMUstate                 BOTH "INSVCTE"  STAYS, |i, s| i.put_state(s);
    fmi2FreeFMUstate                BOTH "INSVCTE"  STAYS, |i, _| (i.fmu.free_fmu_state)(i.component, &mut null_mut());
    fmi2SerializedFMUstateSize      BOTH "INSVCTE"  STAYS, |i, s| (i.fmu.serialized_size)(i.component, s, &mut 0);
    fmi2SerializeFMUstate           BOTH "INSVCTE"  STAYS, |i, s| (i.fmu.serialize)(i.component, s, [0; 4096].as_mut_ptr(), 4096);
    fmi2DeSerializeFMUstate         BOTH "INSVCTE"  STAYS, |i, mut s| {
        let bytes = i.bytes();
        (i.fmu.deserialize)(i.component, bytes.as_ptr().cast(), bytes.len(), &mut s)
    };
    fmi2GetDirectionalDerivative    BOTH "NSVCTE"   NOT_OFFERED, |i, _| (i.fmu.get_directional_derivative)(i.component, null(), 0, null(), 0, null(), null_mut());
    fmi2SetRealInputDerivatives     CS   "INS"      STAYS, |i, _| (i.fmu.set_input_derivatives)(i.component, null(), 0, null(), null());
    fmi2GetRealOutputDerivatives    CS   "STE"      NOT_OFFERED, |i, _| (i.fmu.get_output_derivatives)(i.component, null(), 0, null(), null_mut());
    fmi2DoStep                      CS   "S"        STAYS, |i, _| i.step(0.0, 1e-3);
    fmi2CancelStep                  CS   ""         STAYS, |i, _| (i.fmu.cancel_step)(i.component);
    fmi2GetStatus                   CS   "STE"      DISCARDED, |i, _| (i.fmu.get_status)(i.component, DO_STEP_STATUS, &mut 0);
    fmi2GetRealStatus               CS   "STE"      STAYS, |i, _| (i.fmu.get_real_status)(i.component, LAST_SUCCESSFUL_TIME, &mut 0.0);
    fmi2GetIntegerStatus            CS   "STE"      DISCARDED, |i, _| (i.fmu.get_integer_status)(i.component, PENDING_STATUS, &mut 0);
    fmi2GetBooleanStatus            CS   "STE"      STAYS, |i, _| (i.fmu.get_boolean_status)(i.component, TERMINATED, &mut 0);
    fmi2GetStringStatus             CS   "STE"      DISCARDED, |i, _| (i.fmu.get_string_status)(i.component, PENDING_STATUS, &mut null());
    fmi2EnterEventMode              ME   "VC"      (OK, Some(Phase::EventMode)), |i, _| i.enter_event_mode();
    fmi2NewDiscreteStates           ME   "V"       STAYS, |i, _| i.new_discrete_states().0;
    fmi2EnterContinuousTimeMode     ME   "V"       (OK, Some(Phase::ContinuousTime)), |i, _| i.enter_continuous_time_mode();
    fmi2CompletedIntegratorStep     ME   "C"       STAYS, |i, _| (i.fmu.completed_integrator_step)(i.component, 1, &mut 7, &mut 7);
    fmi2SetTime                     ME   "VC"      STAYS, |i, _| i.set_time(1e-3);
    fmi2SetContinuousStates         ME   "C"       STAYS, |i, _| (i.fmu.set_continuous_states)(i.component, null(), 0);
    fmi2GetDerivatives              ME   "VCTE"    STAYS, |i, _| (i.fmu.get_derivatives)(i.component, null_mut(), 0);
    fmi2GetEventIndicators          ME   "NVCTE"   STAYS, |i, _| (i.fmu.get_event_indicators)(i.component, null_mut(), 0);
    fmi2GetContinuousStates         ME   "NVCTE"   STAYS, |i, _| (i.fmu.get_continuous_states)(i.component, null_mut(), 0);
    fmi2GetNominalsOfContinuousStates ME "IVCTE"   STAYS, |i, _| (i.fmu.get_nominals)(i.component, null_mut(), 0);
};

fn letter(phase: Phase) -> char {
    match phase {
        Phase::Instantiated => 'I',
        Phase::Initialization => 'N',
        Phase::StepComplete => 'S',
        Phase::EventMode => 'V',
        Phase::ContinuousTime => 'C',
        Phase::Terminated => 'T',
        Phase::Error => 'E',
    }
}

#[test]
fn the_table_holds_every_function_that_takes_an_instance() {
    let others = ["fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2Instantiate", "fmi2FreeInstance"];
    let listed: Vec<_> = TABLE.iter().map(|row| row.function).chain(others).collect();
    assert_eq!(listed.len(), 44);
    assert!(Fmu::FUNCTIONS.len() == 44 && Fmu::FUNCTIONS.iter().all(|name| listed.contains(name)));
}

#[test]
fn every_function_in_every_phase() {
    let fmu = Fmu::probe();
    let phases = PHASES.map(|phase| (CO_SIMULATION, phase)).into_iter();
    for (fmu_type, phase) in phases.chain(EXCHANGE_PHASES.map(|phase| (MODEL_EXCHANGE, phase))) {
        for row in TABLE {
            let what = format!("{} in {phase:?} of {fmu_type}", row.function);
            let instance = Instance::of_type_in_phase(&fmu, fmu_type, phase);
            if row.function == "fmi2EnterInitializationMode" && phase == Phase::Instantiated {
                assert_eq!(instance.setup(0.0, None), OK);
            }
            let state = instance.take_state();
            let status = (row.call)(&instance, state);
            instance.free_state(state);
            let is_allowed = row.types.contains(&fmu_type) && row.phases.contains(letter(phase));
            let (expected, next) = if is_allowed { row.answer } else { (ERROR, Some(Phase::Error)) };
            let made_for = if fmu_type == CO_SIMULATION { "is for co-simulation" } else { "is for model exchange" };
            match (expected, is_allowed) {
                (OK, _) => assert_eq!((status, instance.messages()), (OK, vec![]), "{what}"),
                (_, true) => instance.assert_rejected(status, expected, &[row.function]),
                (_, false) if row.types.contains(&fmu_type) => {
                    instance.assert_rejected(status, ERROR, &[row.function, "may not be called"]);
                }
                (_, false) => instance.assert_rejected(status, ERROR, &[row.function, "may not be called", made_for]),
            }
            let next = match next {
                Some(Phase::StepComplete) if fmu_type == MODEL_EXCHANGE => Phase::EventMode,
                next => next.unwrap_or(phase),
            };
            assert_eq!(instance.end_phase(), next, "{what}");
        }
    }
}

#[test]
fn an_instance_can_be_freed_in_every_phase() {
    let fmu = Fmu::probe();
    PHASES.iter().for_each(|phase| drop(Instance::in_phase(&fmu, *phase)));
    EXCHANGE_PHASES.iter().for_each(|phase| drop(Instance::of_type_in_phase(&fmu, MODEL_EXCHANGE, *phase)));
}

#[test]
fn initialization_needs_an_experiment() {
    let fmu = Fmu::probe();
    let instance = Instance::new(&fmu);
    instance.assert_rejected(
        instance.enter(),
        ERROR,
        &["fmi2EnterInitializationMode", "fmi2SetupExperiment was not called"],
    );
}

#[test]
fn reset_gives_start_values_and_a_whole_new_run() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    assert_eq!(instance.set_real("gain", 7.0), OK);
    assert_eq!(instance.set_real("position", 1.0), OK);
    assert_eq!(instance.step(0.0, 1e-2), OK);
    assert_eq!(instance.reset(), OK);
    for (call, name) in [(instance.setup(5.0, None), "setup"), (instance.enter(), "enter"), (instance.exit(), "exit")] {
        assert_eq!(call, OK, "{name}");
    }
    assert_eq!((instance.real("gain"), instance.integer("ticks")), (2.0, 0));
    assert_eq!(instance.step(5.0, 1e-3), OK);
    assert_eq!((instance.real("force"), instance.integer("ticks")), (1.5, 1));
}
