//! Cost of one step of an FMU in addition to its control law: a pass-through in Rust compared with plain C.

use std::path::Path;

use anyhow::{Context, Result};
use cargo_fmu::platform::Platform;

use super::description::Description;
use super::effort::Effort;
use super::library::Fmu;
use super::statistics::{Samples, Summary};
use super::yardstick::{self, PORTS, Runner};
use crate::fmu::{binary, build};
use crate::process;
use crate::workspace::Workspace;

/// Cost of one set + doStep + get, in ns; the three take turns.
pub struct PassThroughCosts {
    /// The pass-through of `fmi2-export`.
    pub rust: Summary,
    /// The C FMU that checks nothing.
    pub bare_c: Summary,
    /// The C FMU that checks what FMI 2.0 asks for.
    pub checked_c: Summary,
}

/// Measures a pass-through in Rust and the two C FMUs.
///
/// # Errors
/// When a build fails or an FMU does not pass its input through.
pub fn measure(workspace: &Workspace, folder: &Path, checked: &Fmu, effort: &Effort) -> Result<PassThroughCosts> {
    let library = build::example(workspace, "fmi2-export", "pass_through", Platform::host()?)?;
    let (_, xml) =
        binary::files(&library)?.into_iter().find(|(path, _)| path == "modelDescription.xml").context("no XML")?;
    let description = Description::parse(&xml)?;
    let (rust, bare) = (Fmu::load(&library, &description.guid, None)?, yardstick::bare(workspace, folder)?);
    let ports = (description.reference("u")?, description.reference("y")?);

    process::header("measure the pass-through");
    let mut runners = [Runner::start(&rust, ports)?, Runner::start(&bare, PORTS)?, Runner::start(checked, PORTS)?];
    let mut samples: [Samples; 3] = Default::default();
    for _ in 0..effort.repeats {
        for (runner, samples) in runners.iter_mut().zip(&mut samples) {
            samples.0.push(runner.cost(effort.calls)?);
        }
    }
    let [rust, bare_c, checked_c] = samples.map(|samples| samples.summary());
    Ok(PassThroughCosts { rust, bare_c, checked_c })
}
