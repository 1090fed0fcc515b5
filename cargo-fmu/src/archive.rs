//! Looks into an FMU that is packed already, whoever made it.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use anyhow::{Context, Result};
use zip::ZipArchive;

use crate::facts::Facts;
use crate::inspect::{self, Rules};
use crate::interface::{Interface, Part};
use crate::pack::DESCRIPTION;
use crate::platform::Platform;

/// What an FMU says of itself and what its libraries need.
pub struct Report {
    /// Lines for people.
    pub text: String,
    /// Violations of the standard, without limits of portability.
    pub faults: usize,
}

/// Reads an FMU and every library in it; nothing of it is run.
///
/// # Errors
/// When the file is no FMU.
pub fn inspect(file: &Path) -> Result<Report> {
    let shown = file.display();
    let opened = File::open(file).with_context(|| format!("cannot read `{shown}`"))?;
    let mut archive = ZipArchive::new(BufReader::new(opened)).with_context(|| format!("`{shown}` is no zip file"))?;
    let description = read(&mut archive, DESCRIPTION).with_context(|| format!("`{shown}` is no FMU"))?;
    let description = String::from_utf8(description).with_context(|| format!("`{DESCRIPTION}` is no UTF-8"))?;
    let interface = Interface::read(&description).with_context(|| format!("`{shown}`"))?;
    let mut report = Report { text: head(&interface), faults: 0 };
    if interface.required.is_empty() {
        report.add(&[format!("`{DESCRIPTION}` has no `modelIdentifier`")]);
    }

    let mut names = archive.file_names().filter_map(Result::ok).map(String::from).collect::<Vec<_>>();
    names.retain(|name| is_library(name));
    names.sort();
    let known: BTreeSet<_> = names.iter().map(|name| platform_and_model(name)).collect();
    for folder in known.iter().map(|(folder, _)| folder).collect::<BTreeSet<_>>() {
        let lacks = |identifier: &&String| !known.contains(&(*folder, identifier.as_str()));
        for identifier in interface.required.keys().filter(lacks) {
            report.add(&[format!("`binaries/{folder}` has no library of `{identifier}`")]);
        }
    }
    for name in &names {
        let library = read(&mut archive, name)?;
        let _ = writeln!(report.text, "{name} ({} kB)", library.len().div_ceil(1000));
        let (folder, identifier) = platform_and_model(name);
        let Some(required) = interface.required.get(identifier) else {
            let _ = writeln!(report.text, "    another library, not checked");
            continue;
        };
        match Facts::read(&library) {
            Ok(facts) => {
                let _ = writeln!(report.text, "    {facts}");
                report.add(&inspect::incomplete(&facts, required.iter().copied()));
                if let Some(platform) = Platform::find(folder) {
                    report.add(&inspect::misplaced(&facts, platform, &interface.guid));
                }
                for limit in inspect::limits(&library, &facts, &Rules::for_anyone()) {
                    let _ = writeln!(report.text, "    portability: {limit}");
                }
            }
            Err(error) => report.add(&[format!("{error:#}")]),
        }
    }
    Ok(report)
}

/// Platform and model of a library by its path: `binaries/win64/a.dll` gives `win64` and `a`.
fn platform_and_model(path: &str) -> (&str, &str) {
    let inside = path.trim_start_matches("binaries/");
    let (folder, file) = inside.split_once('/').unwrap_or(("", inside));
    (folder, file.rsplit_once('.').map_or(file, |(stem, _)| stem))
}

impl Report {
    fn add(&mut self, faults: &[String]) {
        self.faults += faults.len();
        for fault in faults {
            let _ = writeln!(self.text, "    warning: {fault}");
        }
    }
}

/// Name, kind and variables by the description.
fn head(interface: &Interface) -> String {
    let known = |fact: &str| if fact.is_empty() { "?".to_owned() } else { fact.to_owned() };
    let Interface { name, version, guid, tool, .. } = interface;
    let mut text = format!("{}, FMI {}, GUID {guid}\nby {}\n", known(name), known(version), known(tool));
    let counts =
        [("input", &[Part::Input][..]), ("output", &[Part::Output]), ("parameter", &[Part::Fixed, Part::Tunable])];
    let counts = counts.map(|(name, parts)| format!("{} {name}", interface.of(parts).count()));
    let _ = writeln!(text, "{} variables: {}", interface.variables.len(), counts.join(", "));
    text
}

fn is_library(path: &str) -> bool {
    path.starts_with("binaries/") && [".so", ".dll", ".dylib"].iter().any(|ending| path.ends_with(ending))
}

fn read(archive: &mut ZipArchive<BufReader<File>>, path: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    archive.by_name(path).with_context(|| format!("there is no `{path}`"))?.read_to_end(&mut bytes)?;
    Ok(bytes)
}
