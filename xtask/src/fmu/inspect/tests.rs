use std::path::Path;
use std::process::Command;

use super::*;
use crate::process;

fn rules(exports: &[&str]) -> Rules {
    Rules {
        exports: exports.iter().map(ToString::to_string).collect(),
        glibc: (99, 0),
        folders: vec![PathBuf::from("/home/builder")],
    }
}

/// Compiles a C file into a library with the machine's C compiler.
fn compile(code: &str, flags: &[&str]) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.c"), code).unwrap();
    let mut command = Command::new("cc");
    command.current_dir(folder.path()).args(["-shared", "-fPIC", "-o", "m.so", "m.c"]).args(flags);
    process::text(&mut command).unwrap();
    std::fs::read(folder.path().join(Path::new("m.so"))).unwrap()
}

fn faults(library: &[u8], rules: &Rules) -> String {
    check(library, rules).unwrap_err().to_string()
}

#[test]
fn the_function_list_is_sorted_and_has_no_doubles() {
    assert!(FMI2_FUNCTIONS.is_sorted_by(|a, b| a < b));
}

#[test]
fn a_good_library_passes() {
    let library = compile("int fmi2DoStep(void) { return 0; } static int hidden(void) { return 1; }", &["-w"]);
    check(&library, &rules(&["fmi2DoStep"])).unwrap();
}

#[test]
fn missing_and_extra_exports_are_named() {
    let library = compile("int fmi2DoStep(void) { return 0; } int helper(void) { return 1; }", &[]);
    let faults = faults(&library, &rules(&["fmi2DoStep", "fmi2Reset"]));
    assert_eq!(faults, "`fmi2Reset` is not exported\n`helper` is exported and should not be");
}

#[cfg(target_os = "linux")]
#[test]
fn an_executable_stack_and_a_search_path_are_refused() {
    let library = compile("int f(void) { return 0; }", &["-Wl,-z,execstack", "-Wl,-rpath,/opt/lib"]);
    let faults = faults(&library, &rules(&["f"]));
    assert!(faults.contains("`/opt/lib` (RPATH)") && faults.contains("executable stack"), "{faults}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_new_c_library_and_a_foreign_one_are_refused() {
    let code = "#include <stdlib.h>\nvoid *f(void) { return malloc(1); }\n";
    let mut rules = rules(&["f"]);
    rules.glibc = (2, 0);
    let old = faults(&compile(code, &["-lc"]), &rules);
    assert!(old.contains("`malloc") && old.contains("newer than GLIBC_2.0"), "{old}");

    rules.glibc = (99, 0);
    let foreign = faults(&compile(code, &["-Wl,--no-as-needed", "-lgcc_s"]), &rules);
    assert!(foreign.contains("it needs the library `libgcc_s.so.1`"), "{foreign}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_function_that_another_library_could_replace_is_refused() {
    let code = "int f(void) { return 0; } int g(void) { return f() + 1; }";
    let faults = faults(&compile(code, &["-O0"]), &rules(&["f", "g"]));
    assert_eq!(faults, "it does not bind its own `f` at build time");
    check(&compile(code, &["-O0", "-Wl,-Bsymbolic"]), &rules(&["f", "g"])).unwrap();
}

#[test]
fn a_path_of_the_builder_is_refused() {
    let library = compile("const char *f(void) { return \"/home/builder/src/law.rs\"; }", &[]);
    assert_eq!(faults(&library, &rules(&["f"])), "the builder's folder `/home/builder/` is named inside");
}

#[test]
fn a_file_that_is_no_library_is_refused() {
    assert_eq!(faults(b"PK\x03\x04 something else", &rules(&[])), "this is no library");
}

#[test]
fn versions_compare_as_numbers() {
    assert_eq!(glibc_version("GLIBC_2.2.5"), Some((2, 2)));
    assert!(glibc_version("GLIBC_2.4") < glibc_version("GLIBC_2.17"));
    assert_eq!(glibc_version("GLIBC_PRIVATE"), None);
    assert_eq!(glibc_version("GCC_3.0"), None);
}
