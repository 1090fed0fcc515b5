//! What the page of an FMU shows besides the declaration: an example of use, the README of the package, and the Markdown
//! files that its manifest names.

use std::fs;

use anyhow::{Context, Result, ensure};
use cargo_metadata::Package;
use cargo_metadata::camino::Utf8Path;

use super::sources::Outside;
use crate::project::Project;

/// The table of a manifest that is for this program.
const TABLE: &str = "fmu";

/// End of the mark before what is generated from the declaration.
pub const GENERATED: &str = ": generated from the interface -->";

/// Texts for the page of an FMU.
#[derive(Default)]
pub struct Chapters {
    /// A program that uses the FMU, and a plot of its result.
    pub quick_start: Option<QuickStart>,
    /// Markdown: the README without its title, then the chapters.
    pub guide: String,
    /// Markdown: measured results, the last part of the page.
    pub results: String,
}

/// An example of use.
pub struct QuickStart {
    /// File name of the program.
    pub name: String,
    /// The program.
    pub program: String,
    /// Plot of its result, as SVG.
    pub plot: Option<String>,
}

/// Reads `[package.metadata.fmu]`, whose files are relative to the manifest:
///
/// - `quick-start = "FILE.py"` and `plot = "FILE.svg"`;
/// - `guide = ["FILE", "FILE#section"]`, chapters that follow the README, and `results = [...]` in the same form. A file is
///   a section with its title; `#section` takes one section of it.
///
/// # Errors
/// When a file cannot be read, or has no title or no such section.
pub fn read(package: &Package) -> Result<Chapters> {
    let folder = package.manifest_path.with_file_name("");
    let readme = package.readme.as_ref().map(|file| folder.join(file)).filter(|file| file.is_file());
    let readme = readme.map(|file| text(&file)).transpose()?.unwrap_or_default();
    let body = if readme.starts_with("# ") { readme.split_once('\n').map_or("", |(_, body)| body) } else { &readme };
    let table = &package.metadata[TABLE];
    let file =
        |key: &str| table[key].as_str().map(|name| text(&folder.join(name)).map(|text| (name, text))).transpose();
    let quick_start = match file("quick-start")? {
        None => None,
        Some((name, program)) => {
            let name = Utf8Path::new(name).file_name().unwrap_or(name).to_owned();
            Some(QuickStart { name, program, plot: file("plot")?.map(|(_, plot)| plot) })
        }
    };
    let chapters = |key: &str| chapters(package, &folder, &strings(&table[key]));
    Ok(Chapters {
        quick_start,
        guide: format!("{}{}", introduction(body), chapters("guide")?),
        results: chapters("results")?,
    })
}

/// The README without the sections that show the ports, which the page shows itself.
fn introduction(readme: &str) -> String {
    let has_ports = |section: &&str| section.contains(GENERATED);
    readme.split("\n## ").filter(|section| !has_ports(section)).collect::<Vec<_>>().join("\n## ")
}

/// The named chapters, each after a blank line.
fn chapters(package: &Package, folder: &Utf8Path, names: &[String]) -> Result<String> {
    let mut markdown = String::new();
    for name in names {
        let (file, section) = name.split_once('#').map_or((name.as_str(), None), |(file, id)| (file, Some(id)));
        let found = text(&folder.join(file)).and_then(|text| chapter(&text, section));
        let found = found.with_context(|| format!("no chapter `{name}` for the guide of `{}`", package.name))?;
        markdown += &format!("\n\n{found}");
    }
    Ok(markdown)
}

/// What of a project is not inside its FMUs: its folders, and `commands = ["NAME"]` in `[workspace.metadata.fmu]`.
pub fn outside(project: &Project, package: &Package) -> Outside {
    let folders = vec![package.manifest_path.with_file_name("").into_std_path_buf(), project.root.clone()];
    Outside { folders, commands: strings(&project.metadata.workspace_metadata[TABLE]["commands"]) }
}

/// The name by which links find a heading.
pub fn slug(title: &str) -> String {
    let words = title.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_lowercase()
}

/// A file with its title as a heading of the second order, or one of its sections.
fn chapter(text: &str, section: Option<&str>) -> Result<String> {
    if let Some(id) = section {
        let parts = text.split("\n## ").skip(1);
        let mut found = parts.filter(|part| part.lines().next().is_some_and(|title| slug(title) == id));
        return found.next().map(|part| format!("## {}", part.trim_end())).context("it has no such section");
    }
    ensure!(text.starts_with("# "), "it begins with no title");
    let mut is_code = false;
    let lower = |line: &str| {
        is_code ^= line.starts_with("```");
        format!("{}{line}\n", if line.starts_with('#') && !is_code { "#" } else { "" })
    };
    Ok(text.lines().map(lower).collect::<String>().trim_end().to_owned())
}

fn text(file: &Utf8Path) -> Result<String> {
    fs::read_to_string(file).with_context(|| format!("cannot read `{file}`"))
}

/// The strings of an array; none where there is no array.
fn strings(value: &serde_json::Value) -> Vec<String> {
    value.as_array().into_iter().flatten().filter_map(|value| value.as_str()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str =
        "# On your machine\n\nFirst.\n\n## Before it moves, all\n\n```\n# a comment\n```\n\n## After\n\nLast.\n";

    #[test]
    fn sections_with_the_ports_are_left_out_of_the_introduction() {
        let readme = format!("A spring.\n\n## Ports\n\nWire it.\n<!-- ports{GENERATED}\n\n## Limits\n\nNone.\n");
        assert_eq!(introduction(&readme), "A spring.\n\n## Limits\n\nNone.\n");
    }

    #[test]
    fn a_file_is_a_section_with_its_title_and_those_below_it() {
        let whole =
            "## On your machine\n\nFirst.\n\n### Before it moves, all\n\n```\n# a comment\n```\n\n### After\n\nLast.";
        assert_eq!(chapter(FILE, None).unwrap(), whole);
        assert!(chapter("no title", None).is_err());
    }

    #[test]
    fn a_section_is_found_by_its_name() {
        let found = chapter(FILE, Some("before-it-moves-all")).unwrap();
        assert_eq!(found, "## Before it moves, all\n\n```\n# a comment\n```");
        assert_eq!(chapter(FILE, Some("before")).unwrap_err().to_string(), "it has no such section");
    }
}
