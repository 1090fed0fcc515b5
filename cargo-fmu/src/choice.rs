//! Which package of a project becomes the FMU.

use anyhow::{Context, Result, bail, ensure};
use cargo_metadata::{Metadata, Package, Target};

/// The named package; without a name the one that the manifest describes, or the only one that makes a C library.
///
/// # Errors
/// When there is no such package, or more than one; the choices are in the message.
pub fn package<'a>(metadata: &'a Metadata, name: Option<&str>) -> Result<&'a Package> {
    let members = metadata.workspace_packages();
    let choices: Vec<_> =
        members.iter().copied().filter(|package| package.targets.iter().any(Target::is_cdylib)).collect();
    if let Some(name) = name {
        let found = members.iter().copied().find(|package| *package.name == name);
        return found.with_context(|| format!("no package `{name}` in this workspace\n{}", hint(&choices)));
    }
    if let Some(package) = metadata.root_package() {
        return Ok(package);
    }
    ensure!(choices.len() < 2, "several packages make a C library\n{}", hint(&choices));
    let Some(package) = choices.first() else {
        bail!("no package of this workspace makes a C library\n{}", hint(&choices))
    };
    Ok(package)
}

fn hint(choices: &[&Package]) -> String {
    if choices.is_empty() {
        return "hint: the package of an FMU has `crate-type = [\"cdylib\"]` below `[lib]` in its `Cargo.toml`".into();
    }
    let mut words: Vec<_> = choices.iter().map(|package| format!("`--package {}`", package.name)).collect();
    words.sort();
    format!("hint: say {}", words.join(" or "))
}
