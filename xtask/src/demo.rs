//! `cargo xtask demo`: every closed loop, run and judged against its paper.

mod acceptance;

use std::fs;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use anyhow::{Context, Error, Result, bail, ensure};

use crate::fingerprint::{self, Stamp};
use crate::fmu;
use crate::process;
use crate::setup;
use crate::workspace::Workspace;
use acceptance::Outcome;

const FOLDER: &str = "target/demo";
// whatever can change a result
const SOURCES: &[&str] = &["scenarios", "plants", "cosim", "requirements.txt", "Cargo.lock", "target/fmu/SHA256SUMS"];

/// Runs all scenarios and prints the acceptance table; true when every criterion holds.
///
/// When nothing has changed since the last run, its table is printed again.
///
/// # Errors
/// When something does not build or a scenario cannot be run.
pub fn run(workspace: &Workspace) -> Result<bool> {
    setup::run(workspace)?;
    fmu::pack_all(workspace, &fmu::controllers(workspace))?;

    let scenarios = scenarios(&workspace.path("scenarios"))?;
    let stamp = Stamp(workspace.path(FOLDER).join(".fingerprint"));
    let wanted = fingerprint::of(&workspace.root, SOURCES, &[])?;
    if stamp.holds(&wanted) && scenarios.iter().all(|name| result_file(workspace, name).is_file()) {
        process::up_to_date(&format!("{} scenarios", scenarios.len()));
    } else {
        clear(&workspace.path(FOLDER))?;
        process::header(&format!("run {} scenarios", scenarios.len()));
        run_all(workspace, &scenarios)?;
        stamp.set(&wanted)?;
    }
    report(workspace, &scenarios)
}

/// Names of the closed loops, without variants.
///
/// # Errors
/// When the scenarios cannot be listed.
pub fn loops(workspace: &Workspace) -> Result<Vec<String>> {
    toml_stems(&workspace.path("scenarios"))
}

/// Names of all scenarios, each loop followed by its variants: `dob`, `dob/paper`.
fn scenarios(folder: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for stem in toml_stems(folder)? {
        let variants = folder.join(&stem);
        names.push(stem.clone());
        if variants.is_dir() {
            names.extend(toml_stems(&variants)?.iter().map(|variant| format!("{stem}/{variant}")));
        }
    }
    ensure!(!names.is_empty(), "`{}` holds no scenario", folder.display());
    Ok(names)
}

fn toml_stems(folder: &Path) -> Result<Vec<String>> {
    let mut stems = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list `{}`", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            stems.push(path.file_stem().unwrap_or_default().to_string_lossy().into_owned());
        }
    }
    stems.sort();
    Ok(stems)
}

fn clear(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot clear `{}`", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("cannot make `{}`", folder.display()))
}

fn result_file(workspace: &Workspace, name: &str) -> PathBuf {
    workspace.path(FOLDER).join(format!("{name}.json"))
}

/// Runs the scenarios on all cores. All are tried, then the first error is returned.
fn run_all(workspace: &Workspace, scenarios: &[String]) -> Result<()> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut errors = Vec::new();
        while let Some(name) = scenarios.get(next.fetch_add(1, Ordering::Relaxed)) {
            match run_one(workspace, name) {
                Ok(outcome) => eprintln!("    {}", outcome.line()),
                Err(error) => {
                    eprintln!("    {name}: could not run");
                    errors.push(error);
                }
            }
        }
        errors
    };
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let errors: Vec<Error> = thread::scope(|scope| {
        let running: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        running.into_iter().flat_map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    });
    errors.into_iter().next().map_or(Ok(()), Err)
}

fn run_one(workspace: &Workspace, name: &str) -> Result<Outcome> {
    let result = result_file(workspace, name);
    if let Some(folder) = result.parent() {
        fs::create_dir_all(folder).with_context(|| format!("cannot make `{}`", folder.display()))?;
    }
    let mut command = workspace.venv_command("cosim");
    command.args(["run", name, "--json"]).arg(&result).arg("--plot").arg(result.with_extension("svg"));
    let output = process::output(&mut command)?;
    // 0: all criteria hold, 1: some do not
    if !matches!(output.status.code(), Some(0 | 1)) {
        let words = String::from_utf8_lossy(&output.stderr);
        bail!("the scenario `{name}` could not run ({})\n{}", output.status, words.trim_end());
    }
    acceptance::read(&result)
}

fn report(workspace: &Workspace, scenarios: &[String]) -> Result<bool> {
    let outcomes: Vec<Outcome> =
        scenarios.iter().map(|name| acceptance::read(&result_file(workspace, name))).collect::<Result<_>>()?;
    let table = acceptance::table(&outcomes);
    let file = workspace.path(FOLDER).join("acceptance.txt");
    fs::write(&file, format!("{table}\n")).with_context(|| format!("cannot write `{}`", file.display()))?;
    println!("{table}");
    process::header(&format!("results, plots and this table are in `{FOLDER}`"));
    Ok(outcomes.iter().all(|outcome| outcome.passed != Some(false)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_loop_is_followed_by_its_variants() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("dob")).unwrap();
        for file in ["dob.toml", "arm.toml", "readme.md", "dob/paper.toml", "dob/fast.toml"] {
            fs::write(folder.path().join(file), "").unwrap();
        }
        assert_eq!(scenarios(folder.path()).unwrap(), ["arm", "dob", "dob/fast", "dob/paper"]);
    }

    #[test]
    fn no_scenario_at_all_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        assert!(scenarios(folder.path()).unwrap_err().to_string().contains("holds no scenario"));
    }
}
