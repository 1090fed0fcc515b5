//! What one step of an FMU costs beside its law: a pass-through in Rust against the same in plain C.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use super::description::Description;
use super::slave::Slave;
use super::statistics::Samples;
use crate::fmu::{binary, build};
use crate::process;
use crate::setup;
use crate::workspace::Workspace;

const STEPS: u32 = 20_000;
const REPEATS: usize = 300;
const STEP: f64 = 1e-3;

/// Cost of one set + doStep + get, in ns.
pub struct PassThroughCosts {
    /// The pass-through of `fmi2-export`.
    pub rust: Samples,
    /// The C FMU that checks nothing.
    pub bare_c: Samples,
    /// The C FMU that checks what FMI 2.0 asks for.
    pub checked_c: Samples,
}

/// Builds the three FMUs and measures them in turns.
///
/// # Errors
/// When a build fails or an FMU does not pass its input through.
pub fn measure(workspace: &Workspace, folder: &Path) -> Result<PassThroughCosts> {
    let library = build::example(workspace, "fmi2-export", "pass_through")?;
    let (_, xml) =
        binary::files(&library)?.into_iter().find(|(path, _)| path == "modelDescription.xml").context("no XML")?;
    let description = Description::parse(&xml)?;
    let rust = Runner::new(&library, &description.guid, description.reference("u")?, description.reference("y")?)?;
    let bare = Runner::new(&compile(workspace, folder, "bare", &[])?, "", 0, 1)?;
    let checked = Runner::new(&compile(workspace, folder, "checked", &["-DCHECKS"])?, "", 0, 1)?;

    process::header("measure the pass-through");
    let mut runners = [rust, bare, checked];
    let mut samples: [Vec<f64>; 3] = Default::default();
    for _ in 0..REPEATS {
        for (runner, samples) in runners.iter_mut().zip(&mut samples) {
            samples.push(runner.nanoseconds_per_step()?);
        }
    }
    let [rust, bare_c, checked_c] = samples.map(Samples);
    Ok(PassThroughCosts { rust, bare_c, checked_c })
}

fn compile(workspace: &Workspace, folder: &Path, name: &str, flags: &[&str]) -> Result<PathBuf> {
    let library = folder.join(format!("idle-{name}.{}", build::extension()));
    let mut command = Command::new(std::env::var_os("CC").unwrap_or_else(|| "cc".into()));
    command.args(["-std=c11", "-O3", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"]).args(flags);
    command.arg("-I").arg(setup::fmpy_folder(workspace)?.join("c-code"));
    command.arg(workspace.path("xtask/bench/idle.c")).arg("-o").arg(&library);
    process::run(&format!("compile the {name} C FMU"), &mut command)
        .context("cannot compile the C FMU\nhint: install a C compiler (Debian, Ubuntu: `apt install gcc`), or name one with `CC`")?;
    Ok(library)
}

struct Runner {
    slave: Slave,
    input: u32,
    output: u32,
    done: u32,
}

impl Runner {
    fn new(library: &Path, guid: &str, input: u32, output: u32) -> Result<Self> {
        Ok(Self { slave: Slave::start(library, guid, &[])?, input, output, done: 0 })
    }

    fn nanoseconds_per_step(&mut self) -> Result<f64> {
        let (mut value, mut faults) = ([0.0], 0);
        let start = Instant::now();
        for step in self.done..self.done + STEPS {
            let time = f64::from(step) * STEP;
            faults += self.slave.step((&[self.input], &[time]), time, STEP, (&[self.output], &mut value));
        }
        let elapsed = start.elapsed();
        self.done += STEPS;
        ensure!(faults == 0, "a call of the FMU failed");
        ensure!(value[0] == f64::from(self.done - 1) * STEP, "the FMU does not pass its input through");
        Ok(elapsed.as_secs_f64() * 1e9 / f64::from(STEPS))
    }
}
