//! Looks into an FMU that is packed already, whoever made it.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use anyhow::{Context, Result};
use roxmltree::Document;
use zip::ZipArchive;

use crate::facts::Facts;
use crate::fmu::{self, DESCRIPTION};
use crate::inspect::{self, Rules};
use crate::platform::Platform;

/// What an FMU says of itself and what its libraries need.
pub struct Report {
    /// Lines for people.
    pub text: String,
    /// Faults of its libraries.
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
    let guid = fmu::guid(&description)?;
    let mut report = Report { text: head(&description)?, faults: 0 };

    let mut names = archive.file_names().filter_map(Result::ok).map(String::from).collect::<Vec<_>>();
    names.retain(|name| is_library(name));
    names.sort();
    for name in names {
        let library = read(&mut archive, &name)?;
        let _ = writeln!(report.text, "{name} ({} kB)", library.len().div_ceil(1000));
        match Facts::read(&library) {
            Ok(facts) => {
                let _ = writeln!(report.text, "    {facts}");
                report.tell(&inspect::faults(&library, &facts, &Rules::for_anyone()));
                if let Some(platform) = name.split('/').nth(1).and_then(Platform::find) {
                    report.tell(&inspect::misplaced(&facts, platform, &guid));
                }
            }
            Err(error) => report.tell(&[format!("{error:#}")]),
        }
    }
    Ok(report)
}

impl Report {
    fn tell(&mut self, faults: &[String]) {
        self.faults += faults.len();
        for fault in faults {
            let _ = writeln!(self.text, "    warning: {fault}");
        }
    }
}

/// Name, kind and variables by the description.
fn head(description: &str) -> Result<String> {
    let document = Document::parse(description).with_context(|| format!("`{DESCRIPTION}` is not well-formed"))?;
    let root = document.root_element();
    let fact = |name: &str| root.attribute(name).unwrap_or("?").to_owned();
    let mut text = format!("{}, FMI {}, GUID {}\n", fact("modelName"), fact("fmiVersion"), fact("guid"));
    let _ = writeln!(text, "by {}", fact("generationTool"));
    let variables: Vec<_> = document.descendants().filter(|node| node.has_tag_name("ScalarVariable")).collect();
    let counts = ["input", "output", "parameter"].map(|causality| {
        let count = variables.iter().filter(|node| node.attribute("causality") == Some(causality)).count();
        format!("{count} {causality}")
    });
    let _ = writeln!(text, "{} variables: {}", variables.len(), counts.join(", "));
    Ok(text)
}

fn is_library(path: &str) -> bool {
    path.starts_with("binaries/") && [".so", ".dll", ".dylib"].iter().any(|ending| path.ends_with(ending))
}

fn read(archive: &mut ZipArchive<BufReader<File>>, path: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    archive.by_name(path).with_context(|| format!("there is no `{path}`"))?.read_to_end(&mut bytes)?;
    Ok(bytes)
}
