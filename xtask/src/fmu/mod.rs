//! `cargo xtask fmu`: builds the controllers, checks the binaries, packs the FMUs.

pub mod binary;
pub mod build;
pub mod inspect;
pub mod licences;
pub mod pack;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use cargo_metadata::Package;

use crate::fingerprint;
use crate::process;
use crate::setup;
use crate::workspace::Workspace;

/// Builds and packs the named controllers (`dob` or `fmu-dob`), all of them when none is named.
///
/// # Errors
/// When a name is unknown, a build fails, or a binary breaks a rule of [`inspect`].
pub fn run(workspace: &Workspace, names: &[String]) -> Result<()> {
    let packages = select(&controllers(workspace), names)?;
    if build::needs_environment() {
        setup::environment(workspace)?;
    }
    pack_all(workspace, &packages)
}

/// Builds and packs these controllers; `.venv` must be there. A file whose bytes would not change is left alone.
///
/// # Errors
/// As [`run`].
pub fn pack_all(workspace: &Workspace, packages: &[&Package]) -> Result<()> {
    let folder = workspace.path("target/fmu");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make `{}`", folder.display()))?;

    for package in packages {
        let file = folder.join(format!("{}.fmu", package.name));
        let bytes = pack_controller(workspace, package, &build::library(workspace, package)?)?;
        write_if_different(&file, &bytes)?;
    }
    write_if_different(&folder.join("SHA256SUMS"), sums(&folder)?.as_bytes())
}

/// The packages `fmu-*` of the workspace that make a C library, by name.
pub fn controllers(workspace: &Workspace) -> Vec<&Package> {
    let mut packages = workspace.metadata.workspace_packages();
    packages.retain(|package| {
        package.name.starts_with("fmu-") && package.targets.iter().any(cargo_metadata::Target::is_cdylib)
    });
    packages.sort_by(|a, b| a.name.cmp(&b.name));
    packages
}

fn select<'a>(packages: &[&'a Package], names: &[String]) -> Result<Vec<&'a Package>> {
    if names.is_empty() {
        return Ok(packages.to_vec());
    }
    let known = packages.iter().map(|package| format!("`{}`", package.name)).collect::<Vec<_>>().join(", ");
    let find = |name: &String| {
        let full = if name.starts_with("fmu-") { name.clone() } else { format!("fmu-{name}") };
        let found = packages.iter().copied().find(|package| *package.name == full);
        found.with_context(|| format!("no controller `{name}`\nhint: the controllers are {known}"))
    };
    names.iter().map(find).collect()
}

fn pack_controller(workspace: &Workspace, package: &Package, built: &build::Built) -> Result<Vec<u8>> {
    let library = built.library.as_path();
    let identifier = package.name.replace('-', "_");
    let bytes = fs::read(library).with_context(|| format!("cannot read `{}`", library.display()))?;
    inspect::check(&bytes, &inspect::Rules::for_host(workspace))
        .with_context(|| format!("the library of `{}` breaks the rules of a portable FMU", package.name))?;

    let mut content = pack::Content::default();
    for (path, text) in binary::files(library)? {
        content.add(path, text.into_bytes())?;
    }
    ensure!(
        content
            .text("modelDescription.xml")
            .is_some_and(|xml| xml.contains(&format!("modelIdentifier=\"{identifier}\""))),
        "modelDescription.xml of `{}` does not name the modelIdentifier `{identifier}`",
        package.name
    );
    content.add(format!("binaries/{}/{identifier}.{}", build::platform()?, build::extension()), bytes)?;
    content.add_folder("resources", &package.manifest_path.with_file_name("resources").into_std_path_buf())?;
    for (path, text) in licences::files(workspace, package, &built.packages)? {
        content.add(path, text.into_bytes())?;
    }
    pack::to_bytes(&content)
}

fn write_if_different(file: &Path, bytes: &[u8]) -> Result<()> {
    let shown = file.file_name().unwrap_or_default().to_string_lossy();
    if fs::read(file).is_ok_and(|old| old == bytes) {
        process::up_to_date(&format!("`{shown}`"));
        return Ok(());
    }
    process::header(&format!("write `{shown}` ({} kB)", bytes.len().div_ceil(1000)));
    // a reader must never see half an FMU
    let part = file.with_extension("part");
    fs::write(&part, bytes).and_then(|()| fs::rename(&part, file)).with_context(|| format!("cannot write `{shown}`"))
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

    #[test]
    fn controllers_are_found_and_named_in_two_ways() {
        let workspace = Workspace::load().unwrap();
        let all = controllers(&workspace);
        assert!(all.iter().any(|package| *package.name == "fmu-dob"));
        assert!(all.iter().all(|package| *package.name != "fmi2-export"));
        let by_short = select(&all, &["dob".into()]).unwrap();
        let by_full = select(&all, &["fmu-dob".into()]).unwrap();
        assert_eq!(by_short[0].name, by_full[0].name);
    }

    #[test]
    fn an_unknown_controller_is_refused_with_the_known_ones() {
        let workspace = Workspace::load().unwrap();
        let error = select(&controllers(&workspace), &["dop".into()]).unwrap_err().to_string();
        assert!(error.starts_with("no controller `dop`") && error.contains("`fmu-dob`"), "{error}");
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

    #[test]
    fn a_file_with_the_same_bytes_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("fmu-a.fmu");
        write_if_different(&file, b"one").unwrap();
        let mut permissions = fs::metadata(&file).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&file, permissions).unwrap();
        let before = fs::metadata(&file).unwrap().modified().unwrap();
        write_if_different(&file, b"one").unwrap();
        assert_eq!(fs::metadata(&file).unwrap().modified().unwrap(), before);
        write_if_different(&file, b"two").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"two");
    }
}
