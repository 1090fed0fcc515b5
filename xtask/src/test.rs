//! `cargo xtask test`: everything that proves the project, step by step, with its times.

use std::process::Command;
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use anyhow::Result;

use crate::fmu;
use crate::process;
use crate::setup;
use crate::workspace::Workspace;

/// Runs all checks in order and stops at the first that fails; true when all passed.
///
/// # Errors
/// When something that the checks need is missing or does not build.
pub fn run(workspace: &Workspace) -> Result<bool> {
    let mut times = Vec::new();
    timed(&mut times, "setup", || setup::run(workspace))?;
    timed(&mut times, "FMUs", || fmu::pack_all(workspace, &fmu::controllers(workspace)))?;

    let fmpy = setup::fmpy_folder(workspace)?;
    for (name, mut command) in checks(workspace) {
        command.env("FMPY_DIR", &fmpy);
        if let Err(error) = timed(&mut times, name, || process::run(name, &mut command)) {
            summary(&times);
            eprintln!("error: {error:#}");
            eprintln!("hint: this step alone: `{}`", process::display(&command));
            return Ok(false);
        }
    }
    summary(&times);
    Ok(true)
}

/// The checks by name, quick ones first.
fn checks(workspace: &Workspace) -> Vec<(&'static str, Command)> {
    let words = |mut command: Command, line: &str| {
        command.args(line.split_whitespace().skip(1));
        command
    };
    let program = |line: &str| line.split_whitespace().next().unwrap_or_default().to_owned();
    let cargo = |line: &str| words(workspace.cargo(&program(line)), line);
    let venv = |line: &str| words(workspace.venv_command(&program(line)), line);
    // one more than there are cores: a fifth of the time a test waits for a browser, a cluster or a limit to pass
    let processes = available_parallelism().map_or(2, |cores| cores.get() + 1);
    vec![
        ("rustfmt", cargo("fmt --all --check")),
        ("ruff format", venv("ruff format --check")),
        ("ruff", venv("ruff check")),
        ("mypy", venv("mypy")),
        // with what only the Python module needs
        (
            "clippy",
            cargo(
                "clippy --workspace --all-targets --features machining-native/extension-module --locked -- -D warnings",
            ),
        ),
        ("bench", cargo("xtask bench --short")),
        ("cargo test", cargo("test --workspace --locked")),
        ("pytest", venv(&format!("pytest --numprocesses {processes} --dist loadgroup --durations 20"))),
    ]
}

fn timed(
    times: &mut Vec<(&'static str, Duration, bool)>,
    name: &'static str,
    step: impl FnOnce() -> Result<()>,
) -> Result<()> {
    let start = Instant::now();
    let result = step();
    times.push((name, start.elapsed(), result.is_ok()));
    result
}

fn summary(times: &[(&str, Duration, bool)]) {
    eprintln!("\n==> summary");
    for (name, time, passed) in times {
        eprintln!("{name:<12} {:>7.1} s  {}", time.as_secs_f64(), if *passed { "passed" } else { "FAILED" });
    }
    let total: Duration = times.iter().map(|(_, time, _)| *time).sum();
    eprintln!("{:<12} {:>7.1} s", "total", total.as_secs_f64());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_fail_and_formatting_is_only_checked() {
        let checks = checks(&Workspace::load().unwrap());
        let line = |wanted: &str| {
            let (_, command) = checks.iter().find(|(name, _)| *name == wanted).unwrap();
            process::display(command)
        };
        assert!(line("clippy").ends_with("-- -D warnings"));
        assert!(line("rustfmt").ends_with("--check") && line("ruff format").ends_with("--check"));
        assert!(line("cargo test").contains("test --workspace"));
    }

    #[test]
    fn a_step_keeps_its_time_and_its_result() {
        let mut times = Vec::new();
        timed(&mut times, "good", || Ok(())).unwrap();
        timed(&mut times, "bad", || anyhow::bail!("broken")).unwrap_err();
        assert_eq!(
            times.iter().map(|(name, _, passed)| (*name, *passed)).collect::<Vec<_>>(),
            [("good", true), ("bad", false)]
        );
    }
}
