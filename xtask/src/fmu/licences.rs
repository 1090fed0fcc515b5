//! The licences inside an FMU: the project's own and those of the crates compiled into it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;

use anyhow::{Context, Result};
use cargo_metadata::{DependencyKind, Package, PackageId};

use crate::workspace::Workspace;

const FOLDER: &str = "documentation/licenses";
const SUMMARY: &str = "\
This FMU is licensed under MIT OR Apache-2.0, at your option: see LICENSE-MIT.txt and LICENSE-APACHE.txt.
Software of others that is compiled into it, and its licences: see third-party.txt.
";
const OWN: [&str; 2] = ["LICENSE-APACHE", "LICENSE-MIT"];

/// Licence files of an FMU: path inside it and text. `built` are the packages that were compiled for it.
///
/// # Errors
/// When a licence file of the project is missing.
pub fn files(workspace: &Workspace, package: &Package, built: &BTreeSet<PackageId>) -> Result<Vec<(String, String)>> {
    let mut files = Vec::new();
    for name in OWN {
        let text = fs::read_to_string(workspace.path(name)).with_context(|| format!("cannot read `{name}`"))?;
        files.push((format!("{FOLDER}/{name}.txt"), text));
    }
    files.push((format!("{FOLDER}/license.txt"), SUMMARY.into()));
    files.push((format!("{FOLDER}/third-party.txt"), third_party(workspace, package, built)?));
    Ok(files)
}

/// The crates with their licences, then every licence text once, with the crates it belongs to.
fn third_party(workspace: &Workspace, package: &Package, built: &BTreeSet<PackageId>) -> Result<String> {
    let mut list = String::from(
        "Compiled into this FMU:\n- the Rust standard library, by the Rust Project Developers: MIT OR Apache-2.0\n",
    );
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    // the dependency graph also holds crates that no chosen feature asks for
    let linked = compiled_in(workspace, package).into_iter().filter(|package| built.contains(&package.id));
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

/// The crates of others that this package links, by name. Crates that only run in the build do not count.
fn compiled_in<'a>(workspace: &'a Workspace, package: &Package) -> Vec<&'a Package> {
    let metadata = &workspace.metadata;
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
        found.into_iter().map(|id| packages[id]).filter(|package| package.source.is_some()).collect();
    crates.sort_by_key(|package| (package.name.to_string(), package.version.clone()));
    crates
}

fn licence_texts(package: &Package) -> Result<Vec<String>> {
    let folder = package.manifest_path.parent().context("a manifest lies in a folder")?;
    let mut texts = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list the sources of `{}`", package.name))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
        if path.is_file() && ["LICENSE", "LICENCE", "COPYING", "NOTICE"].iter().any(|start| name.starts_with(start)) {
            let text = fs::read_to_string(&path).with_context(|| format!("cannot read `{}`", path.display()))?;
            texts.push(text.replace("\r\n", "\n").trim().to_owned());
        }
    }
    Ok(texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dob(workspace: &Workspace) -> &Package {
        let packages = workspace.metadata.workspace_packages();
        packages.into_iter().find(|package| *package.name == "fmu-dob").unwrap()
    }

    /// Notices of `fmu-dob` as if everything of the workspace but one crate had been compiled.
    fn notices_without(left_out: &str) -> String {
        let workspace = Workspace::load().unwrap();
        let built = workspace.metadata.packages.iter().filter(|package| *package.name != left_out);
        let built = built.map(|package| package.id.clone()).collect();
        third_party(&workspace, dob(&workspace), &built).unwrap()
    }

    #[test]
    fn what_is_linked_is_named_with_its_licence_texts() {
        let text = notices_without("cobs");
        for part in ["- postcard ", "- serde_core ", "Apache License", "Permission is hereby granted"] {
            assert!(text.contains(part), "{part}");
        }
        assert!(!text.contains("- cobs "));
    }

    #[test]
    fn what_only_runs_in_the_build_is_not_named() {
        let text = notices_without("");
        for part in ["- serde_derive ", "- syn ", "- libloading ", "- fmi2-export "] {
            assert!(!text.contains(part), "{part}");
        }
    }

    #[test]
    fn every_fmu_holds_both_licences_of_the_project() {
        let workspace = Workspace::load().unwrap();
        let files = files(&workspace, dob(&workspace), &BTreeSet::new()).unwrap();
        let paths: Vec<_> = files.into_iter().map(|(path, _)| path).collect();
        let names = ["LICENSE-APACHE.txt", "LICENSE-MIT.txt", "license.txt", "third-party.txt"];
        assert_eq!(paths, names.map(|name| format!("documentation/licenses/{name}")));
    }
}
