//! `cargo xtask fmu`: builds the controllers, checks the binaries, packs the FMUs.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use cargo_fmu::build::Files;
use cargo_fmu::fmu;
use cargo_fmu::inspect::Rules;
use cargo_fmu::platform::Platform;
use cargo_fmu::project::Project;
pub use cargo_fmu::{binary, build};
use cargo_metadata::Package;

use crate::fingerprint;
use crate::setup;
use crate::workspace::Workspace;

/// Folder of the FMUs for this machine.
pub const FOLDER: &str = "target/fmu";

/// Builds and packs the named controllers (`dob` or `fmu-dob`), all of them when none is named.
///
/// # Errors
/// When a name is unknown, a build fails, or a binary breaks a rule of [`cargo_fmu::inspect`].
pub fn run(workspace: &Workspace, names: &[String]) -> Result<()> {
    let packages = select(&workspace.root, &controllers(workspace), names)?;
    setup::linker(workspace)?;
    pack_all(workspace, &packages)
}

/// Builds and packs these controllers into `target/fmu` for this machine's platform; `.venv` must be there.
///
/// # Errors
/// As [`run`].
pub fn pack_all(workspace: &Workspace, packages: &[&Package]) -> Result<()> {
    pack_for(workspace, packages, &[Platform::host()?], &workspace.path(FOLDER))
}

/// Builds and packs these controllers for platforms, this machine's first. A file whose bytes would not change keeps them.
///
/// # Errors
/// As [`run`].
pub fn pack_for(
    workspace: &Workspace,
    packages: &[&Package],
    platforms: &[&'static Platform],
    folder: &Path,
) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make `{}`", folder.display()))?;
    for package in packages {
        let file = folder.join(format!("{}.fmu", package.name));
        fmu::write(&file, &pack_controller(workspace, package, platforms)?)?;
    }
    fmu::write(&folder.join("SHA256SUMS"), sums(folder)?.as_bytes())
}

/// The packages `fmu-*` of the workspace, by name; one without a C library gives an error in the build.
pub fn controllers(project: &Project) -> Vec<&Package> {
    let mut packages = project.metadata.workspace_packages();
    packages.retain(|package| package.name.starts_with("fmu-"));
    packages.sort_by(|a, b| a.name.cmp(&b.name));
    packages
}

/// The packages of these names; all if there is none.
///
/// # Errors
/// When a name is unknown.
pub fn select<'a>(root: &Path, packages: &[&'a Package], names: &[String]) -> Result<Vec<&'a Package>> {
    if names.is_empty() {
        return Ok(packages.to_vec());
    }
    let known = packages.iter().map(|package| format!("`{}`", package.name)).collect::<Vec<_>>().join(", ");
    let find = |name: &String| {
        let full = if name.starts_with("fmu-") { name.clone() } else { format!("fmu-{name}") };
        let found = packages.iter().copied().find(|package| *package.name == full);
        let stranger = root.join(&full).join("Cargo.toml").is_file();
        found.with_context(|| {
            if stranger {
                let line = format!("hint: add `\"{full}\"` to `members` in the `Cargo.toml` of the workspace");
                return format!("the controller `{full}` is no member of the workspace\n{line}");
            }
            format!("no controller `{name}`\nhint: the controllers are {known}")
        })
    };
    names.iter().map(find).collect()
}

/// The FMU of a controller, which runs on every machine of these platforms or not at all.
fn pack_controller(workspace: &Workspace, package: &Package, platforms: &[&'static Platform]) -> Result<Vec<u8>> {
    let own = build::library(workspace, package, Platform::host()?, Files::All)?;
    let source = own.library.clone();
    let all = if let [_] = platforms {
        vec![own]
    } else {
        // one library writes the files; three that can would make the FMU a tenth larger
        let built = platforms.iter().map(|platform| build::library(workspace, package, platform, Files::None));
        built.collect::<Result<_>>()?
    };
    let packed = fmu::pack(workspace, package, &source, &all, &Rules::for_host(workspace))?;
    ensure!(
        packed.faults.is_empty(),
        "a library of `{}` breaks the rules of a portable FMU: {}",
        package.name,
        packed.faults.join("\n")
    );
    Ok(packed.bytes)
}

fn sums(folder: &Path) -> Result<String> {
    let mut lines = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "fmu") {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            lines.push((name, fingerprint::sha256(&fs::read(&path)?)));
        }
    }
    if lines.is_empty() {
        bail!("`{}` holds no FMU", folder.display());
    }
    lines.sort();
    Ok(lines.iter().map(|(name, sum)| format!("{sum}  {name}\n")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cargo_fmu::contents::licences;
    use cargo_metadata::MetadataCommand;

    #[test]
    fn controllers_are_found_and_named_in_two_ways() {
        let workspace = Workspace::load().unwrap();
        let all = controllers(&workspace);
        assert!(all.iter().any(|package| *package.name == "fmu-dob"));
        assert!(all.iter().all(|package| *package.name != "fmi2-export"));
        let by_short = select(&workspace.root, &all, &["dob".into()]).unwrap();
        let by_full = select(&workspace.root, &all, &["fmu-dob".into()]).unwrap();
        assert_eq!(by_short[0].name, by_full[0].name);
    }

    #[test]
    fn an_unknown_controller_is_refused_with_the_known_ones() {
        let workspace = Workspace::load().unwrap();
        let refused = select(&workspace.root, &controllers(&workspace), &["dop".into()]).unwrap_err();
        let error = refused.to_string();
        assert!(error.starts_with("no controller `dop`") && error.contains("`fmu-dob`"), "{error}");
    }

    /// A workspace with these members, out of the empty crates `blocks` and `fmu-trial`.
    fn workspace_of(members: &[&str]) -> (tempfile::TempDir, Project) {
        let folder = tempfile::tempdir().unwrap();
        for name in ["blocks", "fmu-trial"] {
            let source = folder.path().join(name).join("src");
            fs::create_dir_all(&source).unwrap();
            fs::write(source.join("lib.rs"), "").unwrap();
            let package = format!("[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n");
            fs::write(folder.path().join(name).join("Cargo.toml"), package).unwrap();
        }
        let root = format!("[workspace]\nresolver = \"3\"\nmembers = {members:?}\n");
        fs::write(folder.path().join("Cargo.toml"), root).unwrap();
        let manifest = folder.path().join("Cargo.toml");
        let project = Project::load(MetadataCommand::new().manifest_path(manifest)).unwrap();
        (folder, project)
    }

    #[test]
    fn a_controller_that_is_no_member_is_told_with_the_line_to_add() {
        let (_folder, project) = workspace_of(&["blocks"]);
        let error = select(&project.root, &controllers(&project), &["trial".into()]).unwrap_err().to_string();
        let line = "hint: add `\"fmu-trial\"` to `members` in the `Cargo.toml` of the workspace";
        assert_eq!(error, format!("the controller `fmu-trial` is no member of the workspace\n{line}"));
    }

    #[test]
    fn a_controller_without_a_c_library_is_told_with_the_lines_to_add() {
        let (_folder, project) = workspace_of(&["blocks", "fmu-trial"]);
        let found = select(&project.root, &controllers(&project), &["trial".into()]).unwrap();
        let error =
            build::library(&project, found[0], Platform::host().unwrap(), Files::All).err().unwrap().to_string();
        assert!(error.starts_with("`fmu-trial` makes no C library\nhint: add to `"), "{error}");
        assert!(error.ends_with("    [lib]\n    crate-type = [\"cdylib\"]"), "{error}");
    }

    #[test]
    fn sums_are_sorted_and_in_the_format_of_sha256sum() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("fmu-b.fmu"), "abc").unwrap();
        fs::write(folder.path().join("fmu-a.fmu"), "").unwrap();
        fs::write(folder.path().join("other.txt"), "").unwrap();
        let text = sums(folder.path()).unwrap();
        let names: Vec<_> = text.lines().map(|line| line.split_once("  ").unwrap().1).collect();
        assert_eq!(names, ["fmu-a.fmu", "fmu-b.fmu"]);
        assert!(text.ends_with("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  fmu-b.fmu\n"));
    }

    fn dob(workspace: &Workspace) -> &Package {
        let packages = workspace.metadata.workspace_packages();
        packages.into_iter().find(|package| *package.name == "fmu-dob").unwrap()
    }

    /// Licence files of `fmu-dob` as if everything of the workspace but one crate had been compiled.
    fn licences_without(left_out: &str) -> Vec<(String, String)> {
        let workspace = Workspace::load().unwrap();
        let built = workspace.metadata.packages.iter().filter(|package| *package.name != left_out);
        let built = built.map(|package| package.id.clone()).collect();
        licences::files(&workspace, dob(&workspace), &built).unwrap()
    }

    fn notices_without(left_out: &str) -> String {
        let third_party = |(path, _): &(String, String)| path.ends_with("third-party.txt");
        licences_without(left_out).into_iter().find(third_party).unwrap().1
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
        let mut paths: Vec<_> = licences_without("").into_iter().map(|(path, _)| path).collect();
        paths.sort();
        let names = ["LICENSE-APACHE.txt", "LICENSE-MIT.txt", "license.txt", "third-party.txt"];
        assert_eq!(paths, names.map(|name| format!("documentation/licenses/{name}")));
    }
}
