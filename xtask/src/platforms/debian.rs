//! Unpacks packages of Debian or Ubuntu into a folder, with all that they need and the machine lacks.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use super::FOLDER;
use crate::fingerprint::{self, Stamp};
use crate::process;
use crate::workspace::Workspace;

/// Unpacks packages, for another processor if Debian's name of one is given; returns their root folder.
///
/// # Errors
/// When `apt-get` or `dpkg` is missing, or when a package cannot be had.
pub fn unpack(workspace: &Workspace, name: &str, processor: Option<&str>, packages: &[&str]) -> Result<PathBuf> {
    let root = workspace.path(FOLDER).join(name);
    let words: Vec<_> = processor.iter().chain(packages).copied().collect();
    let wanted = fingerprint::of(&workspace.root, &[], &words)?;
    let stamp = Stamp(root.with_extension("stamp"));
    if stamp.holds(&wanted) {
        process::up_to_date(&format!("`{FOLDER}/{name}`"));
        return Ok(root);
    }
    let apt = Apt::new(root.with_extension("apt"), processor)?;
    for word in packages {
        process::header(&format!("fetch `{word}`"));
    }
    process::text(apt.command().arg("update")).context("cannot fetch the list of packages")?;
    let mut install = apt.command();
    install.args(["install", "--yes", "--no-install-recommends", "--download-only"]).args(packages);
    process::text(&mut install).context("cannot fetch the packages")?;
    fs::create_dir_all(&root)?;
    for file in apt.files()? {
        process::text(Command::new("dpkg").arg("-x").arg(&file).arg(&root))?;
    }
    fs::remove_dir_all(&apt.folder)?;
    stamp.set(&wanted)?;
    Ok(root)
}

/// `apt-get` with its own lists and files, separate from those of the machine.
struct Apt {
    folder: PathBuf,
    options: Vec<String>,
}

impl Apt {
    fn new(folder: PathBuf, processor: Option<&str>) -> Result<Self> {
        for part in ["state/lists/partial", "cache/archives/partial"] {
            fs::create_dir_all(folder.join(part)).with_context(|| format!("cannot make `{}`", folder.display()))?;
        }
        // of another processor nothing is on the machine
        let nothing = folder.join("state/status");
        fs::write(&nothing, "")?;
        let status = if processor.is_some() { &nothing } else { Path::new("/var/lib/dpkg/status") };
        let mut options = vec![
            format!("Dir::State={}", folder.join("state").display()),
            format!("Dir::State::status={}", status.display()),
            format!("Dir::Cache={}", folder.join("cache").display()),
            // what is written here belongs to whoever builds
            "Debug::NoLocking=1".into(),
            "APT::Sandbox::User=".into(),
        ];
        options.extend(processor.map(|name| format!("APT::Architecture={name}")));
        options.extend(processor.map(|name| format!("APT::Architectures={name}")));
        Ok(Self { folder, options })
    }

    fn command(&self) -> Command {
        let mut command = Command::new("apt-get");
        command.arg("--quiet").args(self.options.iter().flat_map(|option| ["-o", option]));
        command
    }

    /// The fetched packages.
    fn files(&self) -> Result<Vec<PathBuf>> {
        let mut files = Vec::new();
        for entry in fs::read_dir(self.folder.join("cache/archives"))? {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "deb") {
                files.push(path);
            }
        }
        files.sort();
        Ok(files)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_packages_stay_in_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("arm.apt");
        let words = process::display(&Apt::new(place.clone(), Some("arm64")).unwrap().command());
        for key in ["Dir::State", "Dir::State::status", "Dir::Cache"] {
            assert!(words.contains(&format!("-o {key}={}", place.display())), "{key} in {words}");
        }
        assert!(words.contains("-o APT::Architecture=arm64"), "{words}");

        // what the machine has is not fetched again
        let own = process::display(&Apt::new(place, None).unwrap().command());
        assert!(own.contains("Dir::State::status=/var/lib/dpkg/status") && !own.contains("Architecture"), "{own}");
    }

    #[test]
    fn only_packages_are_unpacked_in_the_order_of_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let apt = Apt::new(folder.path().join("a.apt"), None).unwrap();
        for name in ["b.deb", "a.deb", "lock"] {
            fs::write(apt.folder.join("cache/archives").join(name), "").unwrap();
        }
        let files = apt.files().unwrap();
        let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["a.deb", "b.deb"]);
    }
}
