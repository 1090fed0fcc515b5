//! Command line of the project: `cargo xtask setup | new | fmu | c | demo | test | bench | wheel`.

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};
use xtask::bench::effort::Effort;
use xtask::workspace::Workspace;
use xtask::{bench, clients, demo, fmu, new, plain_c, release_set, setup, test, wheel};

/// Builds, demonstrates, tests and measures the project. Steps that are up to date are skipped.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make `.venv` with the pinned Python requirements and build the native code of plants and engine
    Setup,
    /// Make a controller with its plant, scenario and tests from a template
    New {
        /// Such as `trial`: makes `fmu-trial`, `plants/trial.py`, `scenarios/trial.toml` and their tests
        name: String,
    },
    /// Build and pack the FMUs into `target/fmu/`
    Fmu {
        /// Controllers to build, such as `dob` or `fmu-dob`; all of them when none is named
        names: Vec<String>,
        /// Put libraries for Linux on x86-64 and ARM and for Windows into each, below `target/release-set/`
        #[arg(long)]
        release_set: bool,
    },
    /// Build the controllers as static libraries with headers, for programs without FMI, into `target/c/`
    C {
        /// Controllers to build, such as `dob` or `fmu-dob`; all of them when none is named
        names: Vec<String>,
        /// Also write them as blocks of a Modelica package, below `target/modelica/`
        #[arg(long)]
        modelica: bool,
    },
    /// Run every closed loop and print the acceptance table; results land in `target/demo/`
    Demo,
    /// Prove the project: rustfmt, clippy, cargo test, ruff, mypy, pytest, the short form of bench
    Test {
        /// Instead prove the release set on the platforms that it is for, under Wine and QEMU
        #[arg(long)]
        platforms: bool,
        /// Instead run the FMUs in importers of others that take minutes to build
        #[arg(long, conflicts_with = "platforms")]
        clients: bool,
    },
    /// Measure the FMUs and both engines; results land in `target/bench/`
    Bench {
        /// Only show that everything can be measured; the numbers mean little
        #[arg(long)]
        short: bool,
        /// Scenarios to measure instead of all closed loops, such as `dob/30` or a file
        scenarios: Vec<String>,
    },
    /// Build one wheel with harness, plants, FMUs and scenarios into `target/wheel/`
    Wheel,
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

/// Runs one command; false when it ran to its end and something does not hold.
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
        Command::Wheel => wheel::run(&workspace).map(|()| true),
    }
}
