//! The C API of fmi2-export is that of the official headers: cbindgen writes a header from `src/c_api`, and a C
//! compiler compares it with the standard's. Functions that `export!` makes have types there, to which rustc holds them.
//! Mutations of the source show that it would notice.
#![cfg(unix)]

#[path = "../../tests/common/mod.rs"]
mod common;

use common::Fmu;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Enumerations and structures: a C compiler cannot compare two definitions of these, so [`LAYOUT`] does.
const DEFINED_TWICE: [&str; 5] = ["fmi2Status", "fmi2Type", "fmi2StatusKind", "fmi2CallbackFunctions", "fmi2EventInfo"];

/// Types of the callbacks; no prototype uses them directly.
const CALLBACKS: [&str; 4] =
    ["fmi2CallbackLogger", "fmi2CallbackAllocateMemory", "fmi2CallbackFreeMemory", "fmi2StepFinished"];

/// Types of the functions that `export!` makes; the official ones are named `fmi2...TYPE`.
const MADE_FOR_A_MODEL: [&str; 4] = ["Instantiate", "SetReal", "GetReal", "DoStep"];

/// The same prototypes and types twice: a difference does not compile.
const NAMES: &str = r#"
#include "fmi2Functions.h"
#include "names.h"
#ifdef __cplusplus
#include <type_traits>
#define SAME(name) static_assert(std::is_same<fmi2##name##TYPE *, name>::value, #name)
#else
#define SAME(name) _Static_assert(__builtin_types_compatible_p(fmi2##name##TYPE *, name), #name)
#endif
SAME(Instantiate);
SAME(SetReal);
SAME(GetReal);
SAME(DoStep);
"#;

/// Sizes, offsets and values, ours with the prefix `rs_`.
const LAYOUT: &str = r#"
#include <stddef.h>
#include "fmi2Functions.h"
#include "layout.h"
#define SAME(condition) _Static_assert(condition, #condition)
#define FIELD(name) \
    SAME(offsetof(fmi2CallbackFunctions, name) == offsetof(rs_fmi2CallbackFunctions, name)); \
    SAME(sizeof(((fmi2CallbackFunctions *)0)->name) == sizeof(((rs_fmi2CallbackFunctions *)0)->name))
#define EVENT(name) \
    SAME(offsetof(fmi2EventInfo, name) == offsetof(rs_fmi2EventInfo, name)); \
    SAME(sizeof(((fmi2EventInfo *)0)->name) == sizeof(((rs_fmi2EventInfo *)0)->name))
#define VALUE(name) SAME((int)name == (int)rs_fmi2Status_##name)

SAME(sizeof(fmi2CallbackFunctions) == sizeof(rs_fmi2CallbackFunctions));
SAME(_Alignof(fmi2CallbackFunctions) == _Alignof(rs_fmi2CallbackFunctions));
FIELD(logger);
FIELD(allocateMemory);
FIELD(freeMemory);
FIELD(stepFinished);
FIELD(componentEnvironment);
SAME(__builtin_types_compatible_p(fmi2Component, __typeof__(((rs_fmi2CallbackFunctions *)0)->componentEnvironment)));
SAME(sizeof(fmi2EventInfo) == sizeof(rs_fmi2EventInfo));
SAME(_Alignof(fmi2EventInfo) == _Alignof(rs_fmi2EventInfo));
EVENT(newDiscreteStatesNeeded);
EVENT(terminateSimulation);
EVENT(nominalsOfContinuousStatesChanged);
EVENT(valuesOfContinuousStatesChanged);
EVENT(nextEventTimeDefined);
EVENT(nextEventTime);
SAME(__builtin_types_compatible_p(fmi2Type, rs_fmi2Type));
SAME(__builtin_types_compatible_p(fmi2StatusKind, rs_fmi2StatusKind));
SAME(sizeof(fmi2Status) == sizeof(rs_fmi2Status));
VALUE(fmi2OK);
VALUE(fmi2Warning);
VALUE(fmi2Discard);
VALUE(fmi2Error);
VALUE(fmi2Fatal);
VALUE(fmi2Pending);
"#;

/// The installed FMPy, which holds the official headers.
fn fmpy() -> PathBuf {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let environments = fs::read_dir(workspace.join(".venv/lib")).into_iter().flatten().flatten();
    let installed = environments.map(|entry| entry.path().join("site-packages/fmpy"));
    let told = std::env::var_os("FMPY_DIR").map(PathBuf::from);
    let found = told.into_iter().chain(installed).find(|folder| folder.join("c-code/fmi2Functions.h").is_file());
    found.expect("FMPy with the official FMI headers is not installed\nhint: run `cargo xtask setup`")
}

/// Names and texts of the files that make the C API.
type Source = Vec<(OsString, String)>;

fn source() -> Source {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src/c_api");
    // `mod.rs` would make cbindgen read the others twice
    let files = fs::read_dir(folder).unwrap().map(Result::unwrap).filter(|file| file.file_name() != "mod.rs");
    files.map(|file| (file.file_name(), fs::read_to_string(file.path()).unwrap())).collect()
}

/// `names.h` and `layout.h` of a source, in a folder.
fn generate(source: &Source, folder: &Path) {
    let mut builder = cbindgen::Builder::new();
    for (name, text) in source {
        fs::write(folder.join(name), text).unwrap();
        builder = builder.with_src(folder.join(name));
    }
    let mut config = cbindgen::Config {
        language: cbindgen::Language::C,
        usize_is_size_t: true,
        cpp_compat: true,
        no_includes: true,
        sys_includes: vec!["stddef.h".to_owned()],
        ..Default::default()
    };
    config.export.include = CALLBACKS.iter().chain(&MADE_FOR_A_MODEL).map(ToString::to_string).collect();
    config.export.exclude = DEFINED_TWICE.map(str::to_owned).to_vec();
    let write = |config: cbindgen::Config, name| {
        builder.clone().with_config(config).generate().unwrap().write_to_file(folder.join(name))
    };
    write(config.clone(), "names.h");
    config.export.exclude.clear();
    config.export.include = DEFINED_TWICE.map(str::to_owned).to_vec();
    config.export.prefix = Some("rs_".to_owned());
    config.export.item_types =
        vec![cbindgen::ItemType::Typedefs, cbindgen::ItemType::Structs, cbindgen::ItemType::Enums];
    config.enumeration.prefix_with_name = true;
    config.style = cbindgen::Style::Type;
    write(config, "layout.h");
}

/// Compiles a text against the official headers and those in the folder; the compiler's complaints, if any.
fn compile(folder: &Path, compiler: &[&str], text: &str, suffix: &str) -> Result<(), String> {
    let file = folder.join(format!("check.{suffix}"));
    fs::write(&file, text).unwrap();
    let output = Command::new(compiler[0])
        .args(&compiler[1..])
        .args(["-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I"])
        .arg(fmpy().join("c-code"))
        .arg("-I")
        .arg(folder)
        .arg(&file)
        .output()
        .unwrap_or_else(|error| panic!("cannot run `{}`: {error}\nhint: this test needs a C compiler", compiler[0]));
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

/// Compares a source with the official headers, prototypes and layout, in C.
fn compare(source: &Source) -> Result<(), String> {
    let folder = tempfile::tempdir().unwrap();
    generate(source, folder.path());
    compile(folder.path(), &["cc", "-std=c11"], NAMES, "c")?;
    compile(folder.path(), &["cc", "-std=c11"], LAYOUT, "c")
}

#[test]
fn all_44_functions_are_those_of_the_official_headers() {
    let folder = tempfile::tempdir().unwrap();
    generate(&source(), folder.path());
    let ours = fs::read_to_string(folder.path().join("names.h")).unwrap();
    let official = fs::read_to_string(fmpy().join("c-code/fmi2Functions.h")).unwrap();
    let compared = Fmu::FUNCTIONS.iter().filter(|name| {
        let declared = official.contains(&format!("{name}TYPE")) && official.contains(&format!(" {name};"));
        let made = MADE_FOR_A_MODEL.iter().any(|made| **name == format!("fmi2{made}"));
        let written = if made { format!("(*{})(", &name[4..]) } else { format!("{name}(") };
        declared && ours.matches(&written).count() == 1
    });
    assert_eq!(compared.count(), 44, "{ours}");
    compare(&source()).unwrap();
}

#[test]
fn a_cpp_compiler_agrees() {
    let folder = tempfile::tempdir().unwrap();
    generate(&source(), folder.path());
    let language = ["c++", "-std=c++17"];
    compile(folder.path(), &language, NAMES, "cpp").unwrap();
}

/// Applies one change to the source; it must be there exactly once.
fn mutate(from: &str, to: &str) -> Source {
    let source = source();
    assert_eq!(source.iter().map(|(_, text)| text.matches(from).count()).sum::<usize>(), 1, "`{from}`");
    source.into_iter().map(|(name, text)| (name, text.replacen(from, to, 1))).collect()
}

#[test]
fn a_changed_source_does_not_pass() {
    for (from, to) in [
        // the type of one argument, of a result, of an alias, of a callback
        ("    stopTime: fmi2Real,\n", "    stopTime: f32,\n"),
        ("    categories: *const fmi2String,\n", "    categories: *mut fmi2String,\n"),
        ("fn fmi2GetVersion() -> *const c_char", "fn fmi2GetVersion() -> *mut c_char"),
        ("pub type fmi2ValueReference = c_uint;", "pub type fmi2ValueReference = c_int;"),
        ("pub type fmi2StatusKind = c_uint;", "pub type fmi2StatusKind = u64;"),
        ("fn(usize, usize) -> *mut c_void>", "fn(usize, c_uint) -> *mut c_void>"),
        // of a function made for a model
        (
            "pub type SetReal = unsafe extern \"C\" fn(\n    c: fmi2Component,\n    vr: *const",
            "pub type SetReal = unsafe extern \"C\" fn(\n    c: fmi2Component,\n    vr: *mut",
        ),
        // an argument too few
        ("    communicationStepSize: fmi2Real,\n", ""),
        // a field dropped, and two exchanged
        ("    pub stepFinished: fmi2StepFinished,\n", ""),
        (
            "    pub freeMemory: fmi2CallbackFreeMemory,\n    pub stepFinished: fmi2StepFinished,\n",
            "    pub stepFinished: fmi2StepFinished,\n    pub freeMemory: fmi2CallbackFreeMemory,\n",
        ),
        (
            "    pub terminateSimulation: fmi2Boolean,\n    pub nominalsOfContinuousStatesChanged: fmi2Boolean,\n",
            "    pub nominalsOfContinuousStatesChanged: fmi2Boolean,\n    pub terminateSimulation: fmi2Boolean,\n",
        ),
        ("    ni: usize,\n", "    ni: fmi2Integer,\n"),
        // the value of an enumerator
        ("    fmi2Discard,\n    fmi2Error,\n    fmi2Fatal,", "    fmi2Error,\n    fmi2Discard,\n    fmi2Fatal,"),
        ("    fmi2Pending,\n}", "    fmi2Pending = 7,\n}"),
    ] {
        let complaint = compare(&mutate(from, to)).expect_err(&format!("`{from}` -> `{to}` was not noticed"));
        assert!(complaint.contains("error:"), "{complaint}");
    }
}
