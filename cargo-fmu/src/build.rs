//! Builds the C library of an FMU.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use cargo_metadata::{Artifact, Message, Package, PackageId, Target};

use crate::facts::Format;
use crate::linker::{GLIBC, Linker};
use crate::platform::Platform;
use crate::process;
use crate::profile;
use crate::project::Project;

/// The variable of the environment by which `fmi2-export` makes outputs of local variables, if it is `all`.
pub const OUTPUTS: &str = "FMI2_EXPORT_OUTPUTS";

/// The variable of the environment by which `fmi2-export` leaves out the files of the model, if it is `none`.
const FILES: &str = "FMI2_EXPORT_FILES";

/// The files that a library can write, such as `modelDescription.xml`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Files {
    /// Those of its model.
    All,
    /// None: a smaller library, for an FMU whose files come from another library of the same model.
    None,
}

impl Files {
    /// Profile of the build. Each has a folder of its own, so that one library does not replace the other.
    fn profile(self) -> &'static str {
        match self {
            Self::All => "release",
            Self::None => "release-set",
        }
    }
}

/// A C library and the packages that were compiled for it, build scripts and macros included.
pub struct Built {
    /// Platform that the library was compiled for.
    pub platform: &'static Platform,
    /// The library.
    pub library: PathBuf,
    /// The packages.
    pub packages: BTreeSet<PackageId>,
}

impl Built {
    /// A library that was built elsewhere, of unknown packages.
    pub fn elsewhere(platform: &'static Platform, library: PathBuf) -> Self {
        Self { platform, library, packages: BTreeSet::new() }
    }
}

/// Builds a package in release mode. Alone, so that its bytes do not depend on what else is built.
///
/// For another platform than this machine's the compiler needs its standard library and a linker.
///
/// # Errors
/// When the package makes no C library, or when the build fails.
pub fn library(project: &Project, package: &Package, platform: &'static Platform, files: Files) -> Result<Built> {
    let name = &cdylib(package)?.name;
    let host = platform == Platform::host()?;
    let place = if host { String::new() } else { format!(" for {}", platform.folder) };
    let artefacts = compiled(project, package, platform, files, &format!("build `{}`{place}", package.name))?;
    let library = find(&artefacts, name, platform.extension)?;
    Ok(Built { platform, library, packages: artefacts.into_iter().map(|artefact| artefact.package_id).collect() })
}

/// Compiles the library of a package, for this machine's platform also as a static one: both in one go.
///
/// The types of the crate are named because Cargo optimizes across crates (`lto`) only where no Rust library is built in
/// addition, as tests of a package need it.
fn compiled(
    project: &Project,
    package: &Package,
    platform: &'static Platform,
    files: Files,
    title: &str,
) -> Result<Vec<Artifact>> {
    let both = platform == Platform::host()? && files == Files::All;
    let types = if both { "cdylib,staticlib" } else { "cdylib" };
    let mut command = release(project, platform, files)?;
    command.args(["--package", &package.name, "--lib", "--crate-type", types]);
    artefacts(title, command)
}

/// Builds an example of a package as a C library, in the same way as the FMUs.
///
/// # Errors
/// When the build fails.
pub fn example(project: &Project, package: &str, name: &str, platform: &'static Platform) -> Result<PathBuf> {
    let mut command = release(project, platform, Files::All)?;
    command.args(["--package", package, "--example", name]);
    let artefacts = artefacts(&format!("build the example `{name}` of `{package}`"), command)?;
    find(&artefacts, name, platform.extension)
}

/// Builds a package of this machine's platform as a static library, with the functions of FMI in it.
///
/// # Errors
/// As [`library`].
pub fn static_library(project: &Project, package: &Package) -> Result<PathBuf> {
    let (host, name) = (Platform::host()?, &cdylib(package)?.name);
    binds_names(host)?;
    let title = format!("build `{}` as a static library", package.name);
    find(&compiled(project, package, host, Files::All, &title)?, name, "a")
}

/// Names of a static library can be hidden on platforms with ELF files, by the GNU linker.
fn binds_names(platform: &Platform) -> Result<()> {
    let Platform { folder, format, .. } = platform;
    ensure!(
        *format == Format::Elf,
        "a static library for C can be made of ELF files, and `{folder}` has {format:?} files\n\
         hint: build it on Linux, or use the FMU"
    );
    Ok(())
}

/// The C library among the targets of a package.
fn cdylib(package: &Package) -> Result<&Target> {
    let lines = "    [lib]\n    crate-type = [\"cdylib\"]";
    package.targets.iter().find(|target| target.is_cdylib()).with_context(|| {
        let manifest = &package.manifest_path;
        format!("`{}` makes no C library\nhint: add to `{manifest}`:\n{lines}", package.name)
    })
}

fn release(project: &Project, platform: &Platform, files: Files) -> Result<Command> {
    let linux = platform.format == Format::Elf;
    let mut command = if project.linker == Linker::Zig && linux {
        let (major, minor) = GLIBC;
        let mut command = project.command("cargo-zigbuild");
        command.arg("rustc").arg(format!("--target={}.{major}.{minor}", platform.triple));
        command
    } else {
        let mut command = project.cargo("rustc");
        if platform != Platform::host()? {
            command.arg(format!("--target={}", platform.triple));
        }
        command
    };
    command.args(["--profile", files.profile(), "--message-format=json-render-diagnostics"]).args(&project.arguments);
    command.args(profile::arguments(&project.path("Cargo.toml"))?);
    match files {
        Files::All => command.env_remove(FILES),
        Files::None => {
            let inherits = format!("profile.{}.inherits=\"release\"", files.profile());
            command.args(["--config", &inherits]).env(FILES, "none")
        }
    };
    command.env("CARGO_ENCODED_RUSTFLAGS", flags(project, platform)?);
    if !project.environment.iter().any(|(name, _)| *name == OUTPUTS) {
        // that of the caller's shell must not change the FMU
        command.env_remove(OUTPUTS);
    }
    Ok(command)
}

/// Compiler flags of a release, as Cargo reads them from the environment.
fn flags(project: &Project, platform: &Platform) -> Result<String> {
    let mut flags = remap_flags(project);
    if platform.format == Format::Elf {
        // an FMU calls its own functions, even in a process that has loaded another one globally
        flags.push("-Clink-arg=-Wl,-Bsymbolic".into());
    }
    flags.extend(link_flags(platform)?);
    Ok(flags.join("\u{1f}"))
}

/// The compiler flag with which the linker of a platform gives the same bytes each time, if it needs one.
///
/// # Errors
/// When this machine is none of the known platforms.
pub fn link_flags(platform: &Platform) -> Result<Option<String>> {
    // the GNU linker would write the time of day
    let dated = platform.format == Format::Pe && platform != Platform::host()?;
    Ok(dated.then(|| "-Clink-arg=-Wl,--no-insert-timestamp".into()))
}

/// Compiler flags that keep the builder's folders out of the binary: in it, paths start at the workspace, at `crates`
/// or at `rust`.
pub fn remap_flags(project: &Project) -> Vec<String> {
    // of two folders that fit a path, the compiler takes the later one
    let (around, others): (Vec<_>, Vec<_>) =
        dependency_folders(project).into_iter().partition(|folder| project.root.starts_with(folder));
    let mut flags: Vec<_> = around.iter().map(|folder| remap(folder, "crates")).collect();
    flags.push(remap(&project.root, "."));
    flags.extend(others.iter().map(|folder| remap(folder, "crates")));
    if let Some(sysroot) = sysroot(project) {
        flags.push(remap(&sysroot.join("lib/rustlib/src/rust"), "rust"));
    }
    flags
}

/// The folders that hold the sources of the dependencies.
pub fn dependency_folders(project: &Project) -> Vec<PathBuf> {
    let outside = project.metadata.packages.iter().filter(|package| !project.owns(package));
    let mut folders: Vec<_> =
        outside.filter_map(|package| Some(package.manifest_path.parent()?.parent()?.to_path_buf().into())).collect();
    folders.sort();
    folders.dedup();
    folders
}

/// Folder of the compiler.
pub fn sysroot(project: &Project) -> Option<PathBuf> {
    let sysroot = process::text(project.command("rustc").args(["--print", "sysroot"])).ok()?;
    Some(PathBuf::from(sysroot.trim()))
}

fn remap(from: &Path, to: &str) -> String {
    format!("--remap-path-prefix={}={to}", from.display())
}

fn artefacts(title: &str, mut command: Command) -> Result<Vec<Artifact>> {
    process::header(title);
    let output = process::status_and_text(command.stderr(Stdio::inherit()))?;
    ensure!(output.0.success(), "`{}` failed: {}", process::display(&command), output.0);
    let mut built = Vec::new();
    for message in Message::parse_stream(output.1.as_slice()) {
        if let Message::CompilerArtifact(artefact) = message.context("cargo's messages are unreadable")? {
            built.push(artefact);
        }
    }
    Ok(built)
}

fn find(built: &[Artifact], name: &str, extension: &str) -> Result<PathBuf> {
    let matching = built.iter().filter(|artefact| artefact.target.name == name);
    let mut files = matching.flat_map(|artefact| &artefact.filenames);
    let library = files.find(|file| file.extension() == Some(extension));
    library.map(|file| file.clone().into()).with_context(|| format!("the build left no C library `{name}`"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::{AARCH64_LINUX, LINUX64, WIN64};

    #[test]
    fn a_platform_whose_names_cannot_be_hidden_is_refused_by_name() {
        assert!([LINUX64, AARCH64_LINUX].iter().all(|platform| binds_names(platform).is_ok()));
        for (platform, message) in
            [(WIN64, "`win64` has Pe files"), (Platform::named("darwin64").unwrap(), "has MachO files")]
        {
            let error = binds_names(platform).unwrap_err().to_string();
            assert!(error.contains(message) && error.contains("hint: build it on Linux"), "{error}");
        }
    }
}
