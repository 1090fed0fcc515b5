//! `cargo xtask c`: the controllers as static libraries with headers, for programs that know nothing of FMI, and as a
//! package of Modelica.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use cargo_fmu::build;
use cargo_fmu::plain::{self, Library};

use crate::fmu::{controllers, select};
use crate::setup;
use crate::workspace::Workspace;

/// Parameters with another start value in the Modelica blocks: a command acts there at the instant of its sample.
const STARTS: [(&str, &str); 1] = [("io_delay", "0")];

/// Name of the Modelica package; what of it is not made from declarations lies in `modelica/`.
const PACKAGE: &str = "MachiningFMUs";

/// Builds the named controllers (`dob` or `fmu-dob`), all of them when none is named, into `target/c/<package>/`; and with
/// `modelica` a block for each of them into `target/modelica/`.
///
/// # Errors
/// When a name is unknown, a build fails, or the C compiler or `objcopy` is missing.
pub fn run(workspace: &Workspace, names: &[String], modelica: bool) -> Result<()> {
    setup::linker(workspace)?;
    let mut libraries: Vec<Library> = Vec::new();
    for package in select(&workspace.root, &controllers(workspace), names)? {
        let compiled = build::static_library(workspace, package)?;
        let library = plain::write(&compiled, &workspace.path("target/c").join(&*package.name), &["-Werror"])?;
        println!("{}", library.archive.display());
        libraries.push(library);
    }
    if modelica {
        let folder = workspace.path("target/modelica").join(PACKAGE);
        // of a package as a whole nothing old is left; with names its other blocks stay
        if names.is_empty() && folder.exists() {
            fs::remove_dir_all(&folder).with_context(|| format!("cannot remove `{}`", folder.display()))?;
        }
        copy(&workspace.path("modelica").join(PACKAGE), &folder)?;
        plain::modelica_package(&libraries, &folder, &STARTS)?;
        remove_examples(&folder)?;
        println!("{}", folder.display());
    }
    Ok(())
}

/// Removes the examples of blocks that are not there.
fn remove_examples(folder: &Path) -> Result<()> {
    let examples = folder.join("Examples");
    for entry in fs::read_dir(&examples).with_context(|| format!("cannot list `{}`", examples.display()))? {
        let file = entry?.path();
        let text = fs::read_to_string(&file).with_context(|| format!("cannot read `{}`", file.display()))?;
        let block =
            text.lines().find_map(|line| line.trim().strip_prefix(PACKAGE)?.strip_prefix('.')?.split(' ').next());
        if block.is_some_and(|block| !folder.join(format!("{block}.mo")).exists()) {
            fs::remove_file(&file).with_context(|| format!("cannot remove `{}`", file.display()))?;
        }
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| format!("cannot make `{}`", to.display()))?;
    for entry in fs::read_dir(from).with_context(|| format!("cannot list `{}`", from.display()))? {
        let (source, target) = (entry?.path(), to.to_owned());
        let target = target.join(source.file_name().unwrap_or_default());
        if source.is_dir() {
            copy(&source, &target)?;
        } else {
            fs::copy(&source, &target).with_context(|| format!("cannot write `{}`", target.display()))?;
        }
    }
    Ok(())
}
