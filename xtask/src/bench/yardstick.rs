//! Reference for the cost of a controller: an FMU in C that copies its input to its output.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use super::library::Fmu;
use super::slave::{Slave, Snapshot, went_well};
use crate::process;
use crate::setup;
use crate::workspace::Workspace;

const STEP: f64 = 1e-3;

/// Value references of `u` and `y` of the FMU in C.
pub const PORTS: (u32, u32) = (0, 1);

/// The FMU in C that checks what FMI 2.0 asks for.
///
/// # Errors
/// When it does not compile or load.
pub fn checked(workspace: &Workspace, folder: &Path) -> Result<Fmu> {
    compile(workspace, folder, "checked", &["-DCHECKS"])
}

/// The FMU in C that checks nothing.
///
/// # Errors
/// When it does not compile or load.
pub fn bare(workspace: &Workspace, folder: &Path) -> Result<Fmu> {
    compile(workspace, folder, "bare", &[])
}

fn compile(workspace: &Workspace, folder: &Path, name: &str, flags: &[&str]) -> Result<Fmu> {
    let library = folder.join(format!("idle-{name}.{}", std::env::consts::DLL_EXTENSION));
    let mut command = Command::new(std::env::var_os("CC").unwrap_or_else(|| "cc".into()));
    command.args(["-std=c11", "-O3", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"]).args(flags);
    command.arg("-I").arg(setup::fmpy_folder(workspace)?.join("c-code"));
    command.arg(workspace.path("xtask/bench/idle.c")).arg("-o").arg(&library);
    process::run(&format!("compile the {name} C FMU"), &mut command)
        .context("cannot compile the C FMU\nhint: install a C compiler (Debian, Ubuntu: `apt install gcc`), or name one with `CC`")?;
    Fmu::load(&library, "", None)
}

/// An instance that is stepped on and on.
pub struct Runner<'a> {
    slave: Slave<'a>,
    input: u32,
    output: u32,
    done: u32,
}

impl<'a> Runner<'a> {
    /// Starts an instance of an FMU with these value references of input and output.
    ///
    /// # Errors
    /// When the FMU does not start.
    pub fn start(fmu: &'a Fmu, (input, output): (u32, u32)) -> Result<Self> {
        Ok(Self { slave: Slave::start(fmu, &[])?, input, output, done: 0 })
    }

    /// A copy of the instance's state.
    ///
    /// # Errors
    /// When the FMU rejects a call.
    pub fn snapshot(&self) -> Result<Snapshot<'_>> {
        self.slave.snapshot()
    }

    /// Cost (ns) of one set + doStep + get, the mean of a number of them.
    ///
    /// # Errors
    /// When a call fails or the FMU does not pass its input through.
    pub fn cost(&mut self, steps: u32) -> Result<f64> {
        let (mut value, mut worst) = ([0.0], 0);
        let start = Instant::now();
        for step in self.done..self.done + steps {
            let time = f64::from(step) * STEP;
            worst = self.slave.step((&[self.input], &[time]), time, STEP, (&[self.output], &mut value)).max(worst);
        }
        let elapsed = start.elapsed();
        self.done += steps;
        ensure!(went_well(worst), "a call of the FMU failed");
        ensure!(value[0] == f64::from(self.done - 1) * STEP, "the FMU does not pass its input through");
        Ok(elapsed.as_secs_f64() * 1e9 / f64::from(steps))
    }
}
