use std::process::Command;

use super::*;
use crate::{functions, process};

fn rules() -> Rules {
    Rules { glibc: None, libgcc: false, folders: vec!["/home/builder/".into()] }
}

/// Compiles all functions of FMI and some more C code into a library with the machine's C compiler.
fn compile(more: &str, flags: &[&str]) -> Vec<u8> {
    let functions = FMI2_FUNCTIONS.map(|name| format!("int {name}(void) {{ return 0; }}\n")).concat();
    compile_only(&format!("{functions}{more}"), flags)
}

fn compile_only(code: &str, flags: &[&str]) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.c"), code).unwrap();
    let mut command = Command::new("cc");
    command.current_dir(folder.path()).args(["-w", "-shared", "-fPIC", "-o", "m.so", "m.c"]).args(flags);
    process::text(&mut command).unwrap();
    std::fs::read(folder.path().join("m.so")).unwrap()
}

fn faults(library: &[u8], rules: &Rules) -> Vec<String> {
    super::faults(library, &Facts::read(library).unwrap(), rules)
}

#[test]
fn the_function_list_is_sorted_and_has_no_doubles() {
    assert!(FMI2_FUNCTIONS.is_sorted_by(|a, b| a < b));
}

#[test]
fn the_standard_requires_each_function_for_one_reason() {
    let mut required: Vec<_> = functions::REQUIRED.iter().flat_map(|(_, _, names)| names.iter().copied()).collect();
    required.sort_unstable();
    assert_eq!(required, FMI2_FUNCTIONS);
}

#[test]
fn a_good_library_passes() {
    let library = compile("static int hidden(void) { return 1; } int fmi2_export_file(void) { return 2; }", &[]);
    assert_eq!(faults(&library, &rules()), [""; 0]);
}

#[test]
fn missing_and_extra_exports_are_named() {
    let library = compile("int helper(void) { return 1; }", &["-Dfmi2Reset=other"]);
    let names = ["`fmi2Reset` is not exported", "`helper` (and 1 more) is exported and should not be"];
    assert!(names.iter().all(|name| faults(&library, &rules()).iter().any(|fault| fault == name)));
    let nothing = Facts::read(&compile_only("int f(void) { return 0; }", &[])).unwrap();
    assert_eq!(missing(&nothing), FMI2_FUNCTIONS);
}

#[cfg(target_os = "linux")]
#[test]
fn an_executable_stack_and_a_search_path_are_refused() {
    let library = compile("", &["-Wl,-z,execstack", "-Wl,-rpath,/opt/lib"]);
    let found = ["it searches libraries in `/opt/lib` (RPATH)", "it asks for an executable stack"];
    assert_eq!(faults(&library, &rules()), found);
}

#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
#[test]
fn a_library_of_32_bits_is_looked_into_like_any_other() {
    let narrow = |more: &str, flags: &[&str]| compile(more, &[flags, &["-m32", "-nostdlib"]].concat());
    let good = narrow("", &[]);
    assert_eq!(Facts::read(&good).unwrap().processor, "I386");
    assert_eq!(faults(&good, &rules()), [""; 0]);
    let found = faults(&narrow("int helper(void) { return 1; }", &["-Wl,-rpath,/opt/lib"]), &rules());
    assert!(found.iter().any(|fault| fault == "`helper` is exported and should not be"), "{found:?}");
    assert!(found.iter().any(|fault| fault == "it searches libraries in `/opt/lib` (RPATH)"), "{found:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_new_c_library_and_a_foreign_one_are_refused() {
    let code = "#include <stdlib.h>\nvoid *fmi2_export_f(void) { return malloc(1); }\n";
    let library = compile(code, &["-lc"]);
    let old = faults(&library, &Rules { glibc: Some((2, 0)), ..rules() }).concat();
    assert!(old.contains("`malloc") && old.contains("newer than GLIBC_2.0"), "{old}");
    assert_eq!(faults(&library, &Rules { glibc: Some((99, 0)), ..rules() }), [""; 0]);
    assert!(Facts::read(&library).unwrap().needed_glibc() >= Some((2, 2)));

    let foreign = compile(code, &["-Wl,--no-as-needed", "-lgcc_s"]);
    assert_eq!(faults(&foreign, &rules()), ["it needs the library `libgcc_s.so.1`"]);
    assert_eq!(faults(&foreign, &Rules { libgcc: true, ..rules() }), [""; 0]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_function_that_another_library_could_replace_is_refused() {
    let code = "int fmi2_export_f(void) { return 0; } int fmi2_export_g(void) { return fmi2_export_f() + 1; }";
    let found = faults(&compile(code, &["-O0"]), &rules());
    assert_eq!(found, ["it does not bind its own `fmi2_export_f` at build time"]);
    assert_eq!(faults(&compile(code, &["-O0", "-Wl,-Bsymbolic"]), &rules()), [""; 0]);
}

#[test]
fn a_path_of_the_builder_is_refused() {
    let library = compile("const char *fmi2_export_f(void) { return \"/home/builder/src/law.rs\"; }", &[]);
    assert_eq!(faults(&library, &rules()), ["the builder's folder `/home/builder/` is named inside"]);
    assert_eq!(faults(&library, &Rules::for_anyone()), ["the builder's folder `/home/` is named inside"]);
}

#[test]
fn a_library_of_another_model_or_platform_is_in_the_wrong_place() {
    let guid = "00000000-1111-2222-3333-444444444444";
    let library = compile(&format!("const char fmi2_export_guid[36] = \"{guid}\";"), &[]);
    let facts = Facts::read(&library).unwrap();
    assert_eq!(facts.guid.as_deref(), Some(guid));
    let host = Platform::host().unwrap();
    assert_eq!(misplaced(&facts, host, guid), [""; 0]);
    let other = misplaced(&facts, host, "9");
    assert_eq!(other, [format!("it is of another model: its GUID is {guid}, the description has 9")]);
    let strange = if host.folder == "win64" { "linux64" } else { "win64" };
    let found = misplaced(&facts, Platform::named(strange).unwrap(), guid);
    assert!(found.len() == 1 && found[0].starts_with("it is for ") && found[0].contains(strange), "{found:?}");
    assert_eq!(Facts::read(&compile("", &[])).unwrap().guid, None);
}

#[test]
fn libraries_of_each_system_are_known() {
    assert!(is_of_the_system(Format::Pe, "KERNEL32.dll") && !is_of_the_system(Format::Pe, "libgcc_s_seh-1.dll"));
    assert!(is_of_the_system(Format::MachO, "/usr/lib/libSystem.B.dylib"));
    assert!(!is_of_the_system(Format::MachO, "/opt/homebrew/lib/libomp.dylib"));
    assert!(!is_of_the_system(Format::Elf, "libgcc_s.so.1"));
}
