//! `cargo xtask wheel`: one file that `pip` installs: harness, plants, native module, FMUs, scenarios, studies.

use std::borrow::Cow;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use base64::Engine;
use base64::prelude::BASE64_URL_SAFE_NO_PAD;
use cargo_fmu::build;
use cargo_fmu::facts::Format;
use cargo_fmu::linker::Linker;
use cargo_fmu::pack::Content;
use cargo_fmu::platform::Platform;
use sha2::{Digest, Sha256};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use crate::fingerprint::{self, Stamp};
use crate::fmu;
use crate::process;
use crate::release_set;
use crate::setup;
use crate::workspace::Workspace;

const FOLDER: &str = "target/wheel";
/// Folder of the wheels for named platforms, one below it for each.
const SET: &str = "target/wheel-set";
/// Where `cosim` looks for what comes with it.
const PACKED: &str = "cosim/packed";
/// Contents of a wheel in addition to the native module.
const SOURCES: &[&str] =
    &["LICENSE-APACHE", "LICENSE-MIT", "README.md", "cosim", "plants", "requirements.txt", "scenarios", "studies"];

/// Builds the wheel for this machine into `target/wheel/`, or those for named platforms into `target/wheel-set/`.
///
/// # Errors
/// When a platform is not one of the release set, when something does not build, or when a file cannot be written.
pub fn run(workspace: &Workspace, platforms: &[&'static Platform]) -> Result<()> {
    if platforms.is_empty() {
        setup::environment(workspace)?;
        fmu::pack_all(workspace, &fmu::controllers(workspace))?;
        return write(workspace, FOLDER, fmu::FOLDER, None);
    }
    for platform in platforms {
        let names = release_set::PLATFORMS.map(|platform| format!("`{}`", platform.folder));
        ensure!(
            release_set::PLATFORMS.contains(platform),
            "no wheel for `{}`\nhint: wheels are built for {}",
            platform.folder,
            names.join(", ")
        );
    }
    // a wheel holds FMUs that run where it is installed
    let cross = release_set::build_set(workspace, &[])?;
    platforms.iter().try_for_each(|platform| {
        write(&cross, &format!("{SET}/{}", platform.folder), release_set::FOLDER, Some(platform))
    })
}

/// Builds a wheel with these FMUs into a folder, for this machine if no platform is named.
fn write(workspace: &Workspace, folder: &str, fmus: &str, platform: Option<&Platform>) -> Result<()> {
    let (shown, folder) = (folder, workspace.path(folder));
    let toolchain = process::text(Command::new("rustc").arg("--version"))?;
    let sums = format!("{fmus}/SHA256SUMS");
    let sources = [SOURCES, setup::NATIVE, &[sums.as_str()]].concat();
    let wanted = fingerprint::of(&workspace.root, &sources, &[&toolchain])?;
    let stamp = Stamp(folder.join(".fingerprint"));
    if stamp.holds(&wanted)
        && let Ok(wheel) = only_wheel(&folder)
    {
        process::up_to_date(&format!("`{shown}/{}`", name_of(&wheel)));
        return Ok(());
    }
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot clear `{shown}`"))?;
    }
    let plain = folder.join("plain");
    build_packages(workspace, &plain, platform)?;
    let built = only_wheel(&plain)?;
    let wheel = folder.join(name_of(&built));
    pack(&built, &content(workspace, fmus)?, &wheel)?;
    fs::remove_dir_all(&plain).with_context(|| format!("cannot clear `{shown}/plain`"))?;
    stamp.set(&wanted)?;
    process::header(&format!("wrote `{shown}/{}` ({} kB)", name_of(&wheel), fs::metadata(&wheel)?.len() / 1000));
    Ok(())
}

/// Builds the packages `plants` and `cosim` with the native module as a wheel; for Linux with an old C library.
fn build_packages(workspace: &Workspace, folder: &Path, platform: Option<&Platform>) -> Result<()> {
    let mut maturin = workspace.venv_command("maturin");
    maturin.args(["build", "--release", "--quiet", "--out"]).arg(folder).args(&workspace.arguments);
    let mut flags = build::remap_flags(workspace);
    let place = match platform {
        Some(platform) => {
            // the module is for every Python since the oldest one: no interpreter of the platform is needed
            maturin.args(["--target", platform.triple]);
            flags.extend(build::link_flags(platform)?);
            format!(" for {}", platform.folder)
        }
        None => {
            maturin.arg("--interpreter").arg(workspace.venv_program("python"));
            String::new()
        }
    };
    if workspace.linker == Linker::Zig && platform.is_none_or(|platform| platform.format == Format::Elf) {
        maturin.arg("--zig");
    }
    maturin.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\u{1f}"));
    process::run(&format!("build the packages `plants` and `cosim`{place}"), &mut maturin)
}

/// The FMUs, the scenarios and the studies by their path in the wheel.
fn content(workspace: &Workspace, fmus: &str) -> Result<Content> {
    let mut content = Content::default();
    for package in fmu::controllers(workspace) {
        let name = format!("{}.fmu", package.name);
        let bytes = fs::read(workspace.path(fmus).join(&name)).with_context(|| format!("no `{name}`"))?;
        content.add(format!("{PACKED}/fmu/{name}"), bytes)?;
    }
    for folder in ["scenarios", "studies"] {
        content.add_folder(&format!("{PACKED}/{folder}"), &workspace.path(folder))?;
    }
    Ok(content)
}

/// Writes a wheel with the files of `plain` and more, and a new list of them all.
fn pack(plain: &Path, content: &Content, wheel: &Path) -> Result<()> {
    let mut archive = ZipArchive::new(File::open(plain)?).context("maturin left no readable wheel")?;
    let mut names = archive.file_names().filter_map(Result::ok).map(Cow::into_owned);
    let record = names.find(|name| name.ends_with(".dist-info/RECORD")).context("the wheel has no `RECORD`")?;
    drop(names);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);

    let mut writer = ZipWriter::new(File::create(wheel)?);
    let mut lines = std::io::read_to_string(archive.by_name(&record)?)?;
    for index in 0..archive.len() {
        let file = archive.by_index_raw(index)?;
        if file.name()? != record {
            writer.raw_copy_file(file)?;
        }
    }
    for (path, bytes) in content.files() {
        writer.start_file(path, options)?;
        std::io::Write::write_all(&mut writer, bytes)?;
        lines.push_str(&record_line(path, bytes));
    }
    // the list is the last file, as the format of wheels requires
    writer.start_file(record.as_str(), options)?;
    std::io::Write::write_all(&mut writer, lines.as_bytes())?;
    writer.finish()?;
    Ok(())
}

/// Line of a file in the list `RECORD` of a wheel: path, hash, size.
fn record_line(path: &str, bytes: &[u8]) -> String {
    format!("{path},sha256={},{}\n", BASE64_URL_SAFE_NO_PAD.encode(Sha256::digest(bytes)), bytes.len())
}

fn only_wheel(folder: &Path) -> Result<PathBuf> {
    let mut wheels = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list `{}`", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "whl") {
            wheels.push(path);
        }
    }
    ensure!(wheels.len() == 1, "`{}` holds {} wheels, not one", folder.display(), wheels.len());
    Ok(wheels.remove(0))
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_list_is_as_pip_wants_it() {
        assert_eq!(record_line("a/b.txt", b"abc"), "a/b.txt,sha256=ungWv48Bz-pBQUDeXa4iI7ADYaOWF3qctBD_YfIAFa0,3\n");
    }

    #[test]
    fn files_are_added_and_listed() {
        let folder = tempfile::tempdir().unwrap();
        let (plain, wheel) = (folder.path().join("plain.whl"), folder.path().join("full.whl"));
        let mut writer = ZipWriter::new(File::create(&plain).unwrap());
        let files = [("a.py", "x = 1"), ("a-1.dist-info/RECORD", "a.py,,\na-1.dist-info/RECORD,,\n")];
        for (path, text) in files {
            writer.start_file(path, SimpleFileOptions::default()).unwrap();
            std::io::Write::write_all(&mut writer, text.as_bytes()).unwrap();
        }
        writer.finish().unwrap();
        let mut content = Content::default();
        content.add("cosim/packed/fmu/a.fmu", b"abc".to_vec()).unwrap();

        pack(&plain, &content, &wheel).unwrap();
        let mut archive = ZipArchive::new(File::open(&wheel).unwrap()).unwrap();
        let names: Vec<_> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
        assert_eq!(names, ["a.py", "cosim/packed/fmu/a.fmu", "a-1.dist-info/RECORD"]);
        let record = std::io::read_to_string(archive.by_name("a-1.dist-info/RECORD").unwrap()).unwrap();
        assert!(record.starts_with("a.py,,\n") && record.contains("cosim/packed/fmu/a.fmu,sha256=ungWv48"), "{record}");
    }
}
