//! Finds a Python that is new enough.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, bail};

use crate::process;

/// The oldest Python the project runs on.
pub const OLDEST: (u32, u32) = (3, 11);

const NAMES: &[&str] = &["python3", "python", "python3.14", "python3.13", "python3.12", "python3.11"];
const HINT: &str = "hint: install it (Debian, Ubuntu: `apt install python3 python3-venv`; macOS: `brew install python`; \
                    Windows: `winget install Python.Python.3.13`), or name one with the environment variable `PYTHON`";

/// The first Python that is new enough: the variable `PYTHON` when it is set, else the usual names on `PATH`.
///
/// # Errors
/// When there is none, or when it lacks the module `venv` or `ensurepip`.
pub fn find() -> Result<PathBuf> {
    let named = std::env::var_os("PYTHON").map(PathBuf::from);
    let candidates = match named {
        Some(path) => vec![path],
        None => NAMES.iter().map(PathBuf::from).collect(),
    };
    let mut too_old = Vec::new();
    for candidate in candidates {
        match version(&candidate) {
            Some(version) if version >= OLDEST => return with_venv(candidate),
            Some((major, minor)) => too_old.push(format!("`{}` is {major}.{minor}", candidate.display())),
            None => {}
        }
    }
    let found = if too_old.is_empty() { String::new() } else { format!(" ({})", too_old.join(", ")) };
    bail!("Python >= {}.{} not found{found}\n{HINT}", OLDEST.0, OLDEST.1)
}

/// Version of an interpreter, None when it does not run.
pub fn version(python: &PathBuf) -> Option<(u32, u32)> {
    let code = "import sys; print('%d.%d' % sys.version_info[:2])";
    parse(&process::text(Command::new(python).args(["-c", code])).ok()?)
}

fn parse(text: &str) -> Option<(u32, u32)> {
    let (major, minor) = text.trim().split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

// Debian ships the two modules apart from the interpreter
fn with_venv(python: PathBuf) -> Result<PathBuf> {
    let imports = process::output(Command::new(&python).args(["-c", "import venv, ensurepip"]))?;
    if !imports.status.success() {
        bail!(
            "`{}` has no module `venv` or `ensurepip`\nhint: install it (Debian, Ubuntu: `apt install python3-venv`)",
            python.display()
        );
    }
    Ok(python)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_compare_as_numbers() {
        assert_eq!(parse("3.11\n"), Some((3, 11)));
        assert!(parse("3.9").unwrap() < OLDEST && parse("3.14").unwrap() > OLDEST && parse("4.0").unwrap() > OLDEST);
        assert_eq!(parse("Python"), None);
    }
}
