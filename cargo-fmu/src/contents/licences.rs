//! The licences inside an FMU: that of the model and those of the crates compiled into it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use cargo_metadata::{DependencyKind, Package, PackageId};

use crate::project::Project;

const FOLDER: &str = "documentation/licenses";

/// Licence files of an FMU: path inside it and text. `built` are the packages that were compiled for it.
///
/// The model's own texts are the files `LICENSE*` next to its manifest, otherwise those at the root of the workspace.
///
/// # Errors
/// When a file cannot be read.
pub fn files(project: &Project, package: &Package, built: &BTreeSet<PackageId>) -> Result<Vec<(String, String)>> {
    let mut own = licence_files(folder_of(package)?)?;
    if own.is_empty() {
        own = licence_files(&project.root)?;
    }
    let names: Vec<_> = own.iter().map(|(name, _)| text_name(name)).collect();
    let mut files = vec![("license.txt".to_owned(), summary(package.license.as_deref(), &names))];
    files.push(("third-party.txt".into(), third_party(project, package, built)?));
    files.extend(names.into_iter().zip(own.into_iter().map(|(_, text)| text)));
    Ok(files.into_iter().map(|(name, text)| (format!("{FOLDER}/{name}"), text)).collect())
}

/// True when neither the manifest nor a file states the license of the model.
pub fn is_missing(project: &Project, package: &Package) -> Result<bool> {
    let told = package.license.is_some()
        || !licence_files(folder_of(package)?)?.is_empty()
        || !licence_files(&project.root)?.is_empty();
    Ok(!told)
}

/// Every file gets the ending that opens it on every system.
fn text_name(name: &str) -> String {
    if Path::new(name).extension().is_some_and(|ending| ending == "txt") { name.into() } else { format!("{name}.txt") }
}

/// Text of `license.txt`: the license expression, and the names of the license files in the order of the expression.
fn summary(licence: Option<&str>, names: &[String]) -> String {
    let mut text = match licence {
        Some(licence) if licence.contains(" OR ") => format!("This FMU is licensed under {licence}, at your option"),
        Some(licence) => format!("This FMU is licensed under {licence}"),
        None if names.is_empty() => "The author of this FMU states no license".into(),
        None => "The author of this FMU states the license".into(),
    };
    if !names.is_empty() {
        // `LICENSE-MIT` stands where the expression names MIT
        let expression = licence.unwrap_or_default().to_uppercase();
        let place = |name: &&str| {
            let kind = name.trim_end_matches(".txt").split_once('-').map(|(_, kind)| kind.to_uppercase());
            kind.and_then(|kind| expression.find(&kind)).unwrap_or(usize::MAX)
        };
        let mut ordered: Vec<_> = names.iter().map(String::as_str).collect();
        ordered.sort_by_key(place);
        let _ = write!(text, ": see {}", ordered.join(" and "));
    }
    text + ".\nSoftware of others that is compiled into it, and its licences: see third-party.txt.\n"
}

/// The crates with their licences, then every licence text once, with the crates it belongs to.
fn third_party(project: &Project, package: &Package, built: &BTreeSet<PackageId>) -> Result<String> {
    let mut list = String::from(
        "Compiled into this FMU:\n- the Rust standard library, by the Rust Project Developers: MIT OR Apache-2.0\n",
    );
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    // the dependency graph also holds crates that no chosen feature asks for
    let linked = compiled_in(project, package).into_iter().filter(|package| built.contains(&package.id));
    for package in linked {
        let name = format!("{} {}", package.name, package.version);
        let licence = package.license.as_deref().unwrap_or("see its text below");
        let _ = writeln!(list, "- {name}: {licence}");
        for text in licence_texts(package)? {
            texts.entry(text).or_default().push(name.clone());
        }
    }
    let mut texts: Vec<_> = texts.into_iter().map(|(text, names)| (names, text)).collect();
    texts.sort();
    for (names, text) in texts {
        let rule = "=".repeat(80);
        let _ = write!(list, "\n{rule}\n{}\n{rule}\n\n{text}\n", names.join(", "));
    }
    Ok(list)
}

/// The crates of others that this package links, by name. Crates that only run in the build are ignored.
fn compiled_in<'a>(project: &'a Project, package: &Package) -> Vec<&'a Package> {
    let metadata = &project.metadata;
    let nodes: BTreeMap<&PackageId, _> =
        metadata.resolve.iter().flat_map(|resolve| &resolve.nodes).map(|node| (&node.id, node)).collect();
    let packages: BTreeMap<&PackageId, &Package> =
        metadata.packages.iter().map(|package| (&package.id, package)).collect();

    let mut found = BTreeSet::new();
    let mut open = vec![&package.id];
    while let Some(id) = open.pop() {
        for dependency in nodes.get(id).into_iter().flat_map(|node| &node.deps) {
            let linked = dependency.dep_kinds.iter().any(|kind| kind.kind == DependencyKind::Normal);
            let macros = packages[&dependency.pkg].targets.iter().any(cargo_metadata::Target::is_proc_macro);
            if linked && !macros && found.insert(&dependency.pkg) {
                open.push(&dependency.pkg);
            }
        }
    }
    let mut crates: Vec<_> =
        found.into_iter().map(|id| packages[id]).filter(|package| !project.owns(package)).collect();
    crates.sort_by_key(|package| (package.name.to_string(), package.version.clone()));
    crates
}

fn licence_texts(package: &Package) -> Result<Vec<String>> {
    let files = licence_files(folder_of(package)?)?;
    Ok(files.into_iter().map(|(_, text)| text.replace("\r\n", "\n").trim().to_owned()).collect())
}

/// Names and texts of the licence files in a folder, by name.
fn licence_files(folder: &Path) -> Result<Vec<(String, String)>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list `{}`", folder.display()))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let known = |start: &&str| name.to_uppercase().starts_with(*start);
        if path.is_file() && ["LICENSE", "LICENCE", "COPYING", "NOTICE"].iter().any(known) {
            let bytes = fs::read(&path).with_context(|| format!("cannot read `{}`", path.display()))?;
            // older texts hold names in Latin-1
            files.push((name, String::from_utf8_lossy(&bytes).into_owned()));
        }
    }
    files.sort();
    Ok(files)
}

fn folder_of(package: &Package) -> Result<&Path> {
    Ok(package.manifest_path.parent().context("a manifest lies in a folder")?.as_std_path())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_not_utf_8_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("COPYING"), b"Copyright M\xfcller").unwrap();
        let files = licence_files(folder.path()).unwrap();
        assert_eq!(files, [("COPYING".into(), "Copyright M\u{fffd}ller".into())]);
    }

    #[test]
    fn the_summary_names_licence_and_files_in_the_order_of_the_expression() {
        let names = |names: &[&str]| names.iter().map(|name| text_name(name)).collect::<Vec<_>>();
        let both = summary(Some("MIT OR Apache-2.0"), &names(&["LICENSE-APACHE", "LICENSE-MIT"]));
        let first =
            "This FMU is licensed under MIT OR Apache-2.0, at your option: see LICENSE-MIT.txt and LICENSE-APACHE.txt.";
        assert_eq!(both.lines().next(), Some(first));
        let one = summary(Some("BSD-2-Clause"), &names(&["LICENSE.txt"]));
        assert!(one.starts_with("This FMU is licensed under BSD-2-Clause: see LICENSE.txt.\n"), "{one}");
        assert!(summary(None, &[]).starts_with("The author of this FMU states no license.\n"));
    }
}
