//! A profile that aborts on panic does not compile: the barrier between model and importer would be gone.

use std::path::Path;
use std::process::Command;

#[test]
fn a_profile_that_aborts_is_rejected_with_a_hint() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs");
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let message = |panic| {
        let mut command = Command::new(&compiler);
        command.args(["--edition=2024", "--crate-type=lib", "--emit=metadata", "-o", "-", "-C", panic]).arg(&source);
        String::from_utf8(command.output().expect("rustc runs").stderr).unwrap()
    };
    let hint = "hint: remove `panic = \"abort\"` from the profile";
    assert!(message("panic=abort").contains(hint));
    assert!(!message("panic=unwind").contains(hint));
}
