//! Projects that make no FMU, and what `cargo fmu` says of them.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

use cargo_fmu::functions::REQUIRED;
use cargo_fmu::platform::Platform;
use tempfile::TempDir;
use zip::write::SimpleFileOptions;

const CDYLIB: &str = "[lib]\ncrate-type = [\"cdylib\"]\n";

/// Writes files by path and text into a new folder.
fn project(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (path, text) in files {
        let file = folder.path().join(path);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, text).unwrap();
    }
    folder
}

/// Writes `a.fmu` with the description of a kind and these libraries.
fn packed(folder: &Path, version: &str, kind: &str, libraries: &[(&str, Vec<u8>)]) {
    let mut zip = zip::ZipWriter::new(fs::File::create(folder.join("a.fmu")).unwrap());
    let root = format!("<fmiModelDescription modelName=\"A\" fmiVersion=\"{version}\" guid=\"1\">");
    let description = format!("{root}{kind}</fmiModelDescription>").into_bytes();
    for (path, bytes) in [("modelDescription.xml", description)].into_iter().chain(libraries.iter().cloned()) {
        zip.start_file(path, SimpleFileOptions::default()).unwrap();
        zip.write_all(&bytes).unwrap();
    }
    zip.finish().unwrap();
}

fn manifest(name: &str, more: &str) -> String {
    format!("[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n{more}")
}

fn cargo_fmu(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cargo-fmu"));
    command.arg("fmu").args(words).current_dir(folder).env_remove("CARGO_TARGET_DIR");
    command.output().unwrap()
}

/// The error message of a rejected project.
fn refusal(folder: &TempDir, words: &[&str]) -> String {
    let output = cargo_fmu(folder.path(), words);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}

fn has(text: &str, parts: &[&str]) {
    assert!(parts.iter().all(|part| text.contains(part)), "{parts:?} in:\n{text}");
}

#[test]
fn a_folder_without_a_package() {
    has(&refusal(&project(&[]), &[]), &["error: cannot read the project", "could not find `Cargo.toml`"]);
}

#[test]
fn a_crate_that_makes_no_c_library() {
    let folder = project(&[("Cargo.toml", &manifest("spring", "")), ("src/lib.rs", "")]);
    has(
        &refusal(&folder, &[]),
        &["`spring` makes no C library", "hint: add to `", "[lib]\n    crate-type = [\"cdylib\"]"],
    );
}

#[test]
fn a_workspace_with_several_fmus() {
    let folder = project(&[
        ("Cargo.toml", "[workspace]\nresolver = \"3\"\nmembers = [\"a\", \"b\", \"c\"]\n"),
        ("a/Cargo.toml", &manifest("a", CDYLIB)),
        ("a/src/lib.rs", ""),
        ("b/Cargo.toml", &manifest("b", CDYLIB)),
        ("b/src/lib.rs", ""),
        ("c/Cargo.toml", &manifest("c", "")),
        ("c/src/lib.rs", ""),
    ]);
    let choices = "hint: say `--package a` or `--package b`";
    has(&refusal(&folder, &[]), &["several packages make a C library", choices]);
    has(&refusal(&folder, &["--package", "d"]), &["no package `d` in this workspace", choices]);
    has(&refusal(&folder, &["--package", "c"]), &["`c` makes no C library"]);
}

#[test]
fn a_profile_that_aborts() {
    let abort = format!("{CDYLIB}[profile.release]\npanic = \"abort\"\n");
    let folder = project(&[("Cargo.toml", &manifest("spring", &abort)), ("src/lib.rs", "")]);
    has(&refusal(&folder, &[]), &["`panic = \"abort\"` in `[profile.release]`", "hint: remove that line"]);
}

#[test]
fn a_library_that_does_not_build() {
    let folder = project(&[("Cargo.toml", &manifest("spring", CDYLIB)), ("src/lib.rs", "fn broken( {}")]);
    has(
        &refusal(&folder, &["--offline"]),
        &["src/lib.rs:1", "rustc ", " --profile release ", "failed: exit status: 101"],
    );
}

#[test]
fn a_library_without_a_model() {
    let folder = project(&[("Cargo.toml", &manifest("silent", CDYLIB)), ("src/lib.rs", "")]);
    let without = "the library of `silent` exports no function of FMI 2.0";
    let call = "`fmi2_export::export!(YourModel);` belongs in `";
    has(
        &refusal(&folder, &["--offline"]),
        &[without, "hint: `fmi2-export = { path = \"...\" }` or `fmi2-export = { git", call],
    );

    // the exporter's seam to a model that nobody gave
    let seam = "unsafe extern \"Rust\" { safe fn fmi2_export_model(); }\n\
                #[unsafe(no_mangle)] extern \"C\" fn fmi2DoStep() { fmi2_export_model() }\n";
    fs::write(folder.path().join("src/lib.rs"), seam).unwrap();
    has(&refusal(&folder, &["--offline"]), &["`silent` uses `fmi2-export` and exports no model", call]);
}

#[test]
fn a_library_for_a_platform_that_is_not_known() {
    let folder = project(&[]);
    has(&refusal(&folder, &["--binary", "win32=a.dll"]), &["no platform `win32`", "`linux64`", "`win64`"]);
    has(&refusal(&folder, &["--binary", "a.dll"]), &["`a.dll` is no `PLATFORM=FILE`"]);
}

#[test]
fn a_file_that_is_no_fmu() {
    let folder = project(&[("a.fmu", "no zip")]);
    has(&refusal(&folder, &["inspect", "a.fmu"]), &["`a.fmu` is no zip file"]);
    has(&refusal(&folder, &["inspect", "b.fmu"]), &["cannot read `b.fmu`"]);
}

#[test]
fn an_fmu_with_a_library_that_does_not_load() {
    let folder = tempfile::tempdir().unwrap();
    let kind = "<CoSimulation modelIdentifier=\"a\"/>";
    let names = ["binaries/linux64/a.so", "binaries/linux64/libgain.so"];
    packed(folder.path(), "2.0", kind, &names.map(|name| (name, b"no library".to_vec())));
    let output = cargo_fmu(folder.path(), &["inspect", "a.fmu"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    has(&text, &["A, FMI 2.0, GUID 1", "binaries/linux64/a.so (1 kB)\n    warning: this is no library"]);
    assert!(!text.contains("has no library"), "{text}");
    has(&text, &["binaries/linux64/libgain.so (1 kB)\n    another library, not checked\n"]);
}

#[test]
fn an_fmu_without_the_library_of_its_model() {
    let folder = tempfile::tempdir().unwrap();
    let library = ("binaries/win64/b.dll", b"no library".to_vec());
    packed(folder.path(), "2.0", "<CoSimulation modelIdentifier=\"a\"/>", &[library]);
    let output = cargo_fmu(folder.path(), &["inspect", "a.fmu"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    has(&String::from_utf8(output.stdout).unwrap(), &["    warning: `binaries/win64` has no library of `a`\n"]);
}

#[test]
fn an_fmu_of_another_version() {
    let folder = tempfile::tempdir().unwrap();
    packed(folder.path(), "3.0", "", &[]);
    let error = refusal(&folder, &["inspect", "a.fmu"]);
    has(&error, &["`a.fmu`: the FMU has FMI 3.0, only FMI 2.0 is read\nhint: Use `fmpy info FILE`."]);
}

#[cfg(target_os = "linux")]
#[test]
fn an_fmu_for_co_simulation_lacks_no_functions_of_model_exchange() {
    let folder = tempfile::tempdir().unwrap();
    let inspected = |kind: &str, more: &str| {
        let functions = |(_, _, names): &(&str, &str, &'static [&'static str])| names.iter().copied();
        let of_cosimulation =
            REQUIRED.iter().filter(|(tag, attribute, _)| *tag != "ModelExchange" && attribute.is_empty());
        let code: String =
            of_cosimulation.flat_map(functions).map(|name| format!("int {name}(void) {{ return 0; }}\n")).collect();
        fs::write(folder.path().join("a.c"), code + more).unwrap();
        let compiled =
            Command::new("cc").current_dir(folder.path()).args(["-shared", "-fPIC", "-o", "a.so", "a.c"]).status();
        assert!(compiled.unwrap().success());
        let folder_of_platform = Platform::host().unwrap().folder;
        let name = format!("binaries/{folder_of_platform}/a.so");
        packed(folder.path(), "2.0", kind, &[(name.as_str(), fs::read(folder.path().join("a.so")).unwrap())]);
        let output = cargo_fmu(folder.path(), &["inspect", "a.fmu"]);
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, text) = inspected("<CoSimulation modelIdentifier=\"a\"/>", "int gain(void) { return 1; }");
    assert_eq!(code, Some(0), "{text}");
    has(&text, &["    portability: `gain` is exported and should not be"]);
    let (code, text) = inspected("<ModelExchange modelIdentifier=\"a\"/>", "");
    assert_eq!(code, Some(1), "{text}");
    has(&text, &["    warning: `fmi2GetDerivatives` is not exported"]);
}
