//! `cargo xtask test`: everything that proves the project, step by step, with its times.

use std::panic::resume_unwind;
use std::path::Path;
use std::process::Command;
use std::thread::{self, available_parallelism};
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
    let mut steps = Steps { start: Instant::now(), times: Vec::new(), failure: None };
    steps.timed("setup", || setup::run(workspace))?;
    let fmpy = setup::fmpy_folder(workspace)?;

    // an FMU is optimized as a whole, on one core
    let (passed, fmus) = thread::scope(|scope| {
        let fmus = scope.spawn(|| clocked(|| fmu::pack_all(workspace, &fmu::controllers(workspace))));
        let passed = steps.pass(of_sources(workspace), &fmpy);
        let (result, time) = fmus.join().unwrap_or_else(|panic| resume_unwind(panic));
        steps.times.push(("FMUs", time, result.is_ok()));
        (passed, result)
    });
    if fmus.is_err() {
        steps.summary();
    }
    fmus?;
    let passed = passed && steps.pass(of_runs(workspace), &fmpy);
    steps.summary();
    Ok(passed)
}

type Check = (&'static str, Command);

/// The checks of what is written, quick ones first, and the tests in Rust as far as they can be built without FMUs.
fn of_sources(workspace: &Workspace) -> Vec<Check> {
    let cargo = |line| with_words(|name| workspace.cargo(name), line);
    let venv = |line| with_words(|name| workspace.venv_command(name), line);
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
        ("build tests", cargo("test --workspace --locked --no-run")),
    ]
}

/// The checks of what runs, which need the FMUs.
fn of_runs(workspace: &Workspace) -> Vec<Check> {
    let cargo = |line| with_words(|name| workspace.cargo(name), line);
    // one more than there are cores: a fifth of the time a test waits for a browser, a cluster or a limit to pass
    let processes = available_parallelism().map_or(2, |cores| cores.get() + 1);
    let pytest = format!("pytest --numprocesses {processes} --dist loadgroup --durations 20");
    vec![
        ("bench", cargo("xtask bench --short")),
        ("cargo test", cargo("test --workspace --locked")),
        ("pytest", with_words(|name| workspace.venv_command(name), &pytest)),
    ]
}

/// The command of a program, the first word, with the others as its arguments.
fn with_words(command: impl Fn(&str) -> Command, line: &str) -> Command {
    let (program, arguments) = line.split_once(' ').unwrap_or((line, ""));
    let mut command = command(program);
    command.args(arguments.split_whitespace());
    command
}

/// Steps of a test run that are complete, each with its time and whether it passed.
struct Steps {
    start: Instant,
    times: Vec<(&'static str, Duration, bool)>,
    /// Messages for the end, so that later output does not hide a failed check.
    failure: Option<String>,
}

impl Steps {
    /// Runs these checks up to the first that fails; true when all passed.
    fn pass(&mut self, checks: Vec<Check>, fmpy: &Path) -> bool {
        for (name, mut command) in checks {
            command.env("FMPY_DIR", fmpy);
            if let Err(error) = self.timed(name, || process::run(name, &mut command)) {
                let hint = format!("hint: this step alone: `{}`", process::display(&command));
                self.failure = Some(format!("error: {error:#}\n{hint}"));
                return false;
            }
        }
        true
    }

    fn timed(&mut self, name: &'static str, step: impl FnOnce() -> Result<()>) -> Result<()> {
        let (result, time) = clocked(step);
        self.times.push((name, time, result.is_ok()));
        result
    }

    fn summary(&self) {
        eprintln!("\n==> summary");
        for (name, time, passed) in &self.times {
            eprintln!("{name:<12} {:>7.1} s  {}", time.as_secs_f64(), if *passed { "passed" } else { "FAILED" });
        }
        eprintln!("{:<12} {:>7.1} s", "total", self.start.elapsed().as_secs_f64());
        if let Some(failure) = &self.failure {
            eprintln!("{failure}");
        }
    }
}

/// Runs a step; returns its result and its wall time.
fn clocked<T>(step: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let result = step();
    (result, start.elapsed())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_fail_and_formatting_is_only_checked() {
        let workspace = Workspace::load().unwrap();
        let checks: Vec<_> = of_sources(&workspace).into_iter().chain(of_runs(&workspace)).collect();
        let line = |wanted: &str| {
            let (_, command) = checks.iter().find(|(name, _)| *name == wanted).unwrap();
            process::display(command)
        };
        assert!(line("clippy").ends_with("-- -D warnings"));
        assert!(line("rustfmt").ends_with("--check") && line("ruff format").ends_with("--check"));
        assert!(line("cargo test").contains("test --workspace"));
    }

    #[test]
    fn a_step_keeps_its_result_and_the_first_that_fails_is_the_last() {
        let mut steps = Steps { start: Instant::now(), times: Vec::new(), failure: None };
        let workspace = Workspace::load().unwrap();
        let cargo = |line| with_words(|name| workspace.cargo(name), line);
        let checks = vec![("good", cargo("--version")), ("bad", cargo("no-such")), ("never", cargo("--version"))];
        assert!(!steps.pass(checks, Path::new("")));
        let found: Vec<_> = steps.times.iter().map(|(name, _, passed)| (*name, *passed)).collect();
        assert_eq!(found, [("good", true), ("bad", false)]);
        assert!(steps.failure.is_some_and(|text| text.starts_with("error: ") && text.contains("no-such`")));
    }
}
