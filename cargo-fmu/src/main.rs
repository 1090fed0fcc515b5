//! Command line: `cargo fmu` packs a crate as an FMU, `cargo fmu inspect` looks into one.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result};
use cargo_fmu::build::{self, Built, Files};
use cargo_fmu::contents::licences;
use cargo_fmu::fmu::{self, Packed};
use cargo_fmu::inspect::Rules;
use cargo_fmu::linker::{GLIBC, Linker};
use cargo_fmu::platform::Platform;
use cargo_fmu::project::Project;
use cargo_fmu::{archive, choice, plain};
use cargo_metadata::{CargoOpt, MetadataCommand, Package};
use clap::{Args, Parser, Subcommand, ValueEnum};

#[derive(Parser)]
#[command(name = "cargo", bin_name = "cargo")]
enum Cargo {
    /// Build a crate that uses `fmi2-export` and pack it as an FMI 2.0 FMU
    #[command(version, args_conflicts_with_subcommands = true)]
    Fmu {
        #[command(subcommand)]
        command: Option<Command>,
        #[command(flatten)]
        pack: Pack,
    },
}

#[derive(Subcommand)]
enum Command {
    /// Show what an FMU holds and what its libraries need; exit code 1 when they are not portable
    Inspect {
        /// The FMU
        file: PathBuf,
    },
}

/// Which variables of the model become outputs.
#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum Outputs {
    #[default]
    Declared,
    All,
}

#[derive(Args)]
struct Pack {
    /// Package to pack; needed when a workspace has several
    #[arg(short, long)]
    package: Option<String>,
    /// The FMU to write [default: fmu/PACKAGE.fmu in the target directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write a static library and its header for C and C++ instead, below c/PACKAGE in the target directory
    #[arg(long, conflicts_with_all = ["output", "binary"])]
    plain_c: bool,
    /// A library of the same model that was built elsewhere, such as `win64=FILE`; once for each platform
    #[arg(long, value_name = "PLATFORM=FILE", value_parser = elsewhere)]
    binary: Vec<(&'static Platform, PathBuf)>,
    /// Variables with causality `output`: those that the model declares, or also its local variables
    #[arg(long, value_enum, default_value_t)]
    outputs: Outputs,
    /// Path of the `Cargo.toml`
    #[arg(long, value_name = "FILE")]
    manifest_path: Option<PathBuf>,
    /// Directory for everything that is built
    #[arg(long, value_name = "DIRECTORY")]
    target_dir: Option<PathBuf>,
    /// Features to switch on, separated by commas
    #[arg(short = 'F', long)]
    features: Option<String>,
    /// Leave the feature `default` off
    #[arg(long)]
    no_default_features: bool,
    /// Fail instead of changing `Cargo.lock`
    #[arg(long)]
    locked: bool,
    /// Do not use the network
    #[arg(long)]
    offline: bool,
}

fn main() -> ExitCode {
    let Cargo::Fmu { command, pack } = Cargo::parse();
    let result = match command {
        Some(Command::Inspect { file }) => look(&file),
        None => pack.run().map(|()| true),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// A platform and the library for it.
fn elsewhere(words: &str) -> Result<(&'static Platform, PathBuf)> {
    let (platform, file) = words.split_once('=').with_context(|| format!("`{words}` is no `PLATFORM=FILE`"))?;
    Ok((Platform::named(platform)?, file.into()))
}

/// True when nothing is wrong with the libraries of the FMU.
fn look(file: &Path) -> Result<bool> {
    let report = archive::inspect(file)?;
    print!("{}", report.text);
    Ok(report.faults == 0)
}

impl Pack {
    fn run(&self) -> Result<()> {
        let project = self.project()?;
        let package = choice::package(&project.metadata, self.package.as_deref())?;
        if self.plain_c {
            let compiled = build::static_library(&project, package)?;
            let library = plain::write(&compiled, &self.target(&project).join("c").join(&*package.name), &[])?;
            println!("{}\n{}", library.archive.display(), library.header.display());
            return Ok(());
        }
        let mut all = vec![build::library(&project, package, Platform::host()?, Files::All)?];
        all.extend(self.binary.iter().map(|(platform, file)| Built::elsewhere(platform, file.clone())));
        let packed = fmu::pack(&project, package, &all[0].library, &all, &Rules::for_host(&project))?;
        let file = match &self.output {
            Some(file) => file.clone(),
            None => self.target(&project).join("fmu").join(format!("{}.fmu", package.name)),
        };
        if let Some(folder) = file.parent() {
            fs::create_dir_all(folder).with_context(|| format!("cannot make `{}`", folder.display()))?;
        }
        fmu::write(&file, &packed.bytes)?;
        summarize(&project, package, &packed)?;
        println!("{}", file.display());
        Ok(())
    }

    fn project(&self) -> Result<Project> {
        let mut command = MetadataCommand::new();
        if let Some(manifest) = &self.manifest_path {
            command.manifest_path(manifest);
        }
        // the graph of every feature: what is built of it, the build tells
        command.features(CargoOpt::AllFeatures);
        command.other_options(self.resolution().map(str::to_owned).collect::<Vec<_>>());
        let mut project = Project::load(&command)?;
        project.linker = Linker::find();
        project.arguments = self.arguments(&project);
        if self.outputs == Outputs::All {
            project.environment.push((build::OUTPUTS, "all".into()));
        }
        Ok(project)
    }

    /// Words that decide what `cargo` may look up.
    fn resolution(&self) -> impl Iterator<Item = &'static str> {
        [(self.locked, "--locked"), (self.offline, "--offline")].into_iter().filter(|(on, _)| *on).map(|(_, word)| word)
    }

    fn arguments(&self, project: &Project) -> Vec<OsString> {
        let mut words: Vec<OsString> = self.resolution().map(OsString::from).collect();
        words.extend(["--target-dir".into(), self.target(project).into()]);
        if let Some(features) = &self.features {
            words.extend(["--features".into(), features.into()]);
        }
        if self.no_default_features {
            words.push("--no-default-features".into());
        }
        words
    }

    fn target(&self, project: &Project) -> PathBuf {
        let chosen = self.target_dir.as_ref().and_then(|folder| std::path::absolute(folder).ok());
        chosen.unwrap_or_else(|| project.metadata.target_directory.clone().into())
    }
}

/// Prints the platforms, and what limits where the FMU runs.
fn summarize(project: &Project, package: &Package, packed: &Packed) -> Result<()> {
    for (platform, facts) in &packed.facts {
        eprintln!("    {}: {facts}", platform.folder);
    }
    for fault in &packed.faults {
        eprintln!("warning: {fault}");
    }
    if licences::is_missing(project, package)? {
        eprintln!("warning: the FMU of `{}` has no license: others may not use it", package.name);
        eprintln!(
            "hint: Add `license = \"MIT\"`, for example, to `{}`, and the text to `LICENSE`.",
            package.manifest_path
        );
    }
    let needed = packed.facts.first().and_then(|(_, facts)| facts.needed_glibc());
    let newer = needed.is_some_and(|needed| needed > GLIBC);
    if project.linker == Linker::System && newer {
        let (major, minor) = GLIBC;
        eprintln!("hint: `pip install cargo-zigbuild` (with `zig`) makes it run with glibc {major}.{minor} and newer");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A crate in a folder of its own, with these lines in its manifest.
    fn package(folder: &Path, name: &str, more: &str) {
        let folder = folder.join(name);
        fs::create_dir_all(folder.join("src")).unwrap();
        fs::write(folder.join("src/lib.rs"), "").unwrap();
        let head =
            format!("[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\nlicense = \"MIT\"\n");
        fs::write(folder.join("Cargo.toml"), format!("{head}{more}[workspace]\n")).unwrap();
    }

    #[test]
    fn the_licence_of_a_crate_that_a_feature_brings_in_comes_along() {
        let folder = tempfile::tempdir().unwrap();
        package(folder.path(), "spring", "[dependencies]\ndamper = { path = \"../damper\", optional = true }\n");
        package(folder.path(), "damper", "");
        let manifest = folder.path().join("spring/Cargo.toml");
        let words =
            ["cargo", "fmu", "--offline", "--features", "damper", "--manifest-path", manifest.to_str().unwrap()];
        let Cargo::Fmu { pack, .. } = Cargo::parse_from(words);
        let project = pack.project().unwrap();
        let built = project.metadata.packages.iter().map(|package| package.id.clone()).collect();
        let package = choice::package(&project.metadata, None).unwrap();
        let files = licences::files(&project, package, &built).unwrap();
        assert!(files.iter().any(|(_, text)| text.contains("- damper 0.1.0: MIT")), "{files:?}");
    }
}
