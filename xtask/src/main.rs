//! Command line of the project: `cargo xtask setup | new | fmu | c | demo | test | bench | wheel`.

use std::process::ExitCode;

use anyhow::Result;
use cargo_fmu::platform::Platform;
use clap::{Parser, Subcommand};
use xtask::bench::effort::Effort;
use xtask::workspace::Workspace;
use xtask::{bench, clients, demo, fmu, new, plain_c, release_set, setup, test, wheel};

/// Build, demonstrate, test and measure the project. Steps that are up to date are skipped.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Install the pinned Python requirements into `.venv` and build the native module
    Setup,
    /// Create a controller with its plant, scenario and tests from a template
    New {
        /// Name, such as `trial`: creates `fmu-trial`, `plants/trial.py`, `scenarios/trial.toml` and their tests
        name: String,
    },
    /// Build the FMUs into `target/fmu/`
    Fmu {
        /// Controllers, such as `dob` or `fmu-dob` [default: all]
        names: Vec<String>,
        /// Include libraries for Linux (x86-64, ARM) and Windows; write to `target/release-set/`
        #[arg(long)]
        release_set: bool,
    },
    /// Build the controllers as C libraries with headers into `target/c/`
    C {
        /// Controllers, such as `dob` or `fmu-dob` [default: all]
        names: Vec<String>,
        /// Also write a Modelica package into `target/modelica/`
        #[arg(long)]
        modelica: bool,
    },
    /// Run every closed loop and print the acceptance table; write results to `target/demo/`
    Demo,
    /// Run all fast checks: rustfmt, clippy, cargo test, ruff, mypy, pytest, short benchmarks
    Test {
        /// Test the release set under Wine and QEMU instead
        #[arg(long)]
        platforms: bool,
        /// Run the FMUs in other importing tools instead, which takes minutes to build
        #[arg(long, conflicts_with = "platforms")]
        clients: bool,
    },
    /// Measure the cost of FMUs and engines; write results to `target/bench/`
    Bench {
        /// Only check that every benchmark runs; the numbers are not meaningful
        #[arg(long)]
        short: bool,
        /// Scenarios, such as `dob/30` or a file [default: all closed loops]
        scenarios: Vec<String>,
    },
    /// Build a wheel with harness, plants, FMUs and scenarios into `target/wheel/`
    Wheel {
        /// Build for `win64`, `aarch64-linux` or `linux64` with the release set; write to `target/wheel-set/`
        #[arg(long, value_name = "NAME", value_parser = Platform::named)]
        platform: Vec<&'static Platform>,
    },
}

fn main() -> ExitCode {
    match run(&Cli::parse().command) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Runs one command; false when it completed and a check failed.
fn run(command: &Command) -> Result<bool> {
    let workspace = Workspace::load()?;
    match command {
        Command::Setup => setup::run(&workspace).map(|()| true),
        Command::New { name } => new::run(&workspace.root, name).map(|()| true),
        Command::Fmu { names, release_set: true } => release_set::run(&workspace, names).map(|()| true),
        Command::Fmu { names, release_set: false } => fmu::run(&workspace, names).map(|()| true),
        Command::C { names, modelica } => plain_c::run(&workspace, names, *modelica).map(|()| true),
        Command::Demo => demo::run(&workspace),
        Command::Test { platforms: true, .. } => release_set::test(&workspace).map(|()| true),
        Command::Test { clients: true, .. } => clients::test(&workspace).map(|()| true),
        Command::Test { .. } => test::run(&workspace),
        Command::Bench { short, scenarios } => {
            let effort = if *short { Effort::SHORT } else { Effort::FULL };
            bench::run(&workspace, &effort, scenarios).map(|()| true)
        }
        Command::Wheel { platform } => wheel::run(&workspace, platform).map(|()| true),
    }
}
