//! `cargo xtask demo`: every closed loop, run and compared with its paper by `cosim test`.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use crate::fingerprint::{self, Stamp};
use crate::fmu;
use crate::process;
use crate::setup;
use crate::workspace::Workspace;

const FOLDER: &str = "target/demo";
const PAGE: &str = "report.html";
const DOCUMENTS: &str = "docs/faults";
// one for each loop, of a few seconds
const STUDIES: &[&str] = &[
    "studies/centering-rings.toml",
    "studies/deburr-machines.toml",
    "studies/dob-speeds.toml",
    "studies/fts-speeds.toml",
    "studies/polish-gain.toml",
];
// whatever can change a result
const SOURCES: &[&str] =
    &["scenarios", "studies", "plants", "cosim", DOCUMENTS, "requirements.txt", "Cargo.lock", "target/fmu/SHA256SUMS"];

/// Runs all scenarios and prints the acceptance table; true when every criterion holds.
///
/// When nothing has changed since a run in which all held, its table is printed again.
///
/// # Errors
/// When something does not build or a scenario cannot be run.
pub fn run(workspace: &Workspace) -> Result<bool> {
    setup::run(workspace)?;
    fmu::pack_all(workspace, &fmu::controllers(workspace))?;

    let folder = workspace.path(FOLDER);
    let table = folder.join("acceptance.txt");
    let stamp = Stamp(folder.join(".fingerprint"));
    let mut made = String::new();
    let wanted = fingerprint::of(&workspace.root, SOURCES, &[])?;
    let held = if stamp.holds(&wanted) && table.is_file() {
        process::up_to_date("all scenarios");
        print!("{}", fs::read_to_string(&table).with_context(|| format!("cannot read `{}`", table.display()))?);
        true
    } else {
        clear(&folder)?;
        let begun = Instant::now();
        let held = test(workspace)?;
        made = size_and_time(&folder.join(PAGE), begun.elapsed())?;
        if held {
            stamp.set(&wanted)?;
        }
        held
    };
    process::header(&format!(
        "results, plots and this table are in `{FOLDER}`; open `{FOLDER}/{PAGE}` in a browser{made}"
    ));
    Ok(held)
}

/// Size of the HTML report and the time that it took, as a text such as ` (13.1 MB, made in 400 s)`.
fn size_and_time(page: &Path, taken: Duration) -> Result<String> {
    let size = fs::metadata(page).with_context(|| format!("cannot read `{}`", page.display()))?.len();
    Ok(format!(" ({}.{} MB, made in {} s)", size / 1_000_000, size / 100_000 % 10, taken.as_secs()))
}

fn test(workspace: &Workspace) -> Result<bool> {
    process::header("run all scenarios");
    let mut command = workspace.venv_command("cosim");
    // the scenarios of this checkout, and no others
    command.args(["test", "--out", ".", "--report", PAGE]).env_remove("COSIM_SCENARIOS");
    // where the studies leave their results
    command.current_dir(workspace.path(FOLDER));
    for study in STUDIES {
        command.args(["--study", study]);
    }
    for document in documents(workspace)? {
        command.arg("--document").arg(document);
    }
    let status = process::status(&mut command)?;
    match status.code() {
        Some(0) => Ok(true),
        Some(1) => Ok(false),
        _ => bail!("`{}` failed: {status}", process::display(&command)),
    }
}

/// The texts that the page holds, by name.
fn documents(workspace: &Workspace) -> Result<Vec<PathBuf>> {
    let folder = workspace.path(DOCUMENTS);
    let entries = fs::read_dir(&folder).with_context(|| format!("cannot read `{}`", folder.display()))?;
    let mut found = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    found.retain(|file| file.extension().is_some_and(|ending| ending == "md"));
    found.sort();
    Ok(found)
}

fn clear(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot clear `{}`", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("cannot make `{}`", folder.display()))
}
