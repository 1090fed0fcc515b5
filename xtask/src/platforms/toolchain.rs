//! One compiler with the standard libraries of several platforms, and the linker for Windows.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use cargo_fmu::platform::{Platform, WIN64};

use super::{FOLDER, debian};
use crate::fingerprint::{self, Stamp};
use crate::process;
use crate::workspace::Workspace;

const HINT: &str = "hint: `rustup` fetches the compiler and the standard libraries; it must reach its server";

/// Makes `workspace` build for these platforms, by a compiler of the same version as the one in use.
///
/// # Errors
/// When the compiler or the linker cannot be fetched.
pub fn install(workspace: &mut Workspace, platforms: &[&Platform]) -> Result<()> {
    let compiler = compiler(workspace, platforms)?;
    let mut variables = vec![("RUSTC", compiler.join("rustc").into())];
    let mut programs = vec![compiler];
    if platforms.contains(&WIN64) && *WIN64 != *Platform::host()? {
        let root = debian::unpack(workspace, "mingw", None, &["gcc-mingw-w64-x86-64-win32"])?;
        let linker = root.join("usr/bin/x86_64-w64-mingw32-gcc-win32");
        variables.push(("CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER", linker.into()));
        variables.push(("LD_LIBRARY_PATH", libraries(&root).into()));
        // the compiler itself calls `dlltool`
        programs.push(root.join("usr/bin"));
    }
    workspace.build_with(&format!("{FOLDER}/build"), &programs, variables);
    Ok(())
}

/// Where packages of this machine's processor put their libraries below a root folder.
pub fn libraries(root: &Path) -> PathBuf {
    root.join(format!("usr/lib/{}-linux-gnu", std::env::consts::ARCH))
}

/// Folder of the programs of the compiler.
fn compiler(workspace: &Workspace, platforms: &[&Platform]) -> Result<PathBuf> {
    let answer = process::text(workspace.command("rustc").arg("--version"))?;
    let version = answer.split_whitespace().nth(1).with_context(|| format!("`rustc` prints no version: {answer}"))?;
    let home = workspace.path(FOLDER).join("rust");
    let triples: Vec<_> = platforms.iter().map(|platform| platform.triple).collect();
    let wanted = fingerprint::of(&workspace.root, &[], &[&[version], triples.as_slice()].concat())?;
    let stamp = Stamp(home.with_extension("stamp"));
    if stamp.holds(&wanted) {
        process::up_to_date(&format!("`{FOLDER}/rust`"));
    } else {
        let mut rustup = Command::new("rustup");
        rustup.env("RUSTUP_HOME", &home).env_remove("RUSTUP_TOOLCHAIN");
        rustup.args(["toolchain", "install", version, "--profile", "minimal", "--no-self-update"]);
        rustup.args(["--target", &triples.join(",")]);
        process::run(&format!("fetch Rust {version} for {} platforms", triples.len()), &mut rustup).context(HINT)?;
        stamp.set(&wanted)?;
    }
    Ok(home.join(format!("toolchains/{version}-{}/bin", Platform::host()?.triple)))
}
