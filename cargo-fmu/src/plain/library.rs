//! From the compiled model to a static library that can stand beside others of its kind.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{self, Command};

use anyhow::{Context, Result, ensure};

use super::{header, modelica, source};
use crate::binary;
use crate::fmu::DESCRIPTION;
use crate::interface::Interface;
use crate::process::text;

/// A controller in plain C.
pub struct Library {
    /// The static library.
    pub archive: PathBuf,
    /// Its header.
    pub header: PathBuf,
    interface: Interface,
}

/// Writes `lib<identifier>.a` and `<identifier>.h` into a folder, out of a static library that holds the functions of FMI.
///
/// Of all symbols only those of the header are left, which begin with the identifier: two such libraries, each with its own
/// copy of Rust's standard library, can be linked into one program.
///
/// # Errors
/// When a program of the C compiler is missing or fails: `cc` and `objcopy`, which know ELF files.
pub fn write(compiled: &Path, folder: &Path) -> Result<Library> {
    // others may write into the folder at the same time
    let work = folder.join(format!("made-{}", process::id()));
    fs::create_dir_all(&work).with_context(|| format!("cannot make `{}`", work.display()))?;
    let made = make(compiled, &work).and_then(|made| {
        let place = |file: &Path| -> Result<PathBuf> {
            let target = folder.join(file.file_name().unwrap_or_default());
            fs::rename(file, &target).with_context(|| format!("cannot write `{}`", target.display()))?;
            Ok(target)
        };
        Ok(Library { archive: place(&made.archive)?, header: place(&made.header)?, ..made })
    });
    let removed = fs::remove_dir_all(&work).with_context(|| format!("cannot remove `{}`", work.display()));
    let library = made?;
    removed?;
    Ok(library)
}

/// Makes both files in a folder of their own.
fn make(compiled: &Path, work: &Path) -> Result<Library> {
    let interface = Interface::of_library(&description(compiled, work)?)?;
    let identifier = interface.identifier.clone();
    let (header, code) = (work.join(format!("{identifier}.h")), work.join(format!("{identifier}.c")));
    put(&header, &header::write(&interface)?)?;
    put(&code, &source::write(&interface))?;

    let (adapter, joined) = (work.join("adapter.o"), work.join(format!("{identifier}.o")));
    let mut cc = compiler();
    cc.args(["-std=c99", "-O2", "-fPIC", "-Wall", "-Wextra", "-Werror", "-c"]);
    text(cc.arg("-I").arg(work).arg(&code).arg("-o").arg(&adapter))?;
    let names = functions(&fs::read_to_string(&header)?, &identifier);
    ensure!(!names.is_empty(), "the header of `{identifier}` declares no function");

    // one object: what the functions need, with the names of the model and of the standard library bound to it
    let mut ld = compiler();
    ld.args(["-r", "-nostdlib", "-Wl,--gc-sections", "-Wl,--force-group-allocation"]);
    ld.args(names.iter().map(|name| format!("-Wl,-u,{name}")));
    text(ld.arg("-o").arg(&joined).arg(&adapter).arg(compiled))?;
    let mut objcopy = Command::new("objcopy");
    // what the compiler keeps for other linkers confuses `ar`
    objcopy.args(["--strip-unneeded", "--remove-section=.llvmbc", "--remove-section=.llvmcmd"]);
    objcopy.args(names.iter().map(|name| format!("--keep-global-symbol={name}")));
    text(objcopy.arg(&joined))?;

    let archive = work.join(format!("lib{identifier}.a"));
    text(Command::new("ar").arg("rcsD").arg(&archive).arg(&joined))?;
    Ok(Library { archive, header, interface })
}

/// Writes a block for each library, with all that it needs, into the folder of a Modelica package.
///
/// # Errors
/// When two variables would have one name in a block, or a file cannot be read or written.
pub fn modelica_package(libraries: &[Library], folder: &Path) -> Result<()> {
    let package = folder.file_name().unwrap_or_default().to_string_lossy();
    let (include, binaries) = (folder.join("Resources/Include"), folder.join("Resources/Library"));
    for folder in [&include, &binaries] {
        fs::create_dir_all(folder).with_context(|| format!("cannot make `{}`", folder.display()))?;
    }
    for Library { archive, header, interface } in libraries {
        put(&folder.join(format!("{}.mo", interface.name)), &modelica::block(interface, &package)?)?;
        put(&include.join(format!("{}_modelica.h", interface.identifier)), &modelica::adapter(interface))?;
        for (file, place) in [(header, &include), (archive, &binaries)] {
            let copy = place.join(file.file_name().unwrap_or_default());
            fs::copy(file, &copy).with_context(|| format!("cannot write `{}`", copy.display()))?;
        }
    }
    Ok(())
}

/// The model description, asked of the library itself.
fn description(compiled: &Path, work: &Path) -> Result<String> {
    let shared = work.join(format!("asked{}", std::env::consts::DLL_SUFFIX));
    let mut cc = compiler();
    cc.args(["-shared", "-Wl,-u,fmi2_export_file"]);
    text(cc.arg("-o").arg(&shared).arg(compiled).arg("-lm"))?;
    let files = binary::files(&shared)?;
    let found = files.into_iter().find(|(path, _)| path == DESCRIPTION).map(|(_, text)| text);
    found.with_context(|| format!("`{}` holds no `{DESCRIPTION}`", compiled.display()))
}

fn compiler() -> Command {
    Command::new(std::env::var_os("CC").unwrap_or_else(|| "cc".into()))
}

/// The functions that a header declares: a name with the identifier as its beginning and an open parenthesis behind it.
fn functions(header: &str, identifier: &str) -> Vec<String> {
    let code = header.lines().filter(|line| !line.trim_start().starts_with(['*', '/']) && line.contains('('));
    let name = |line: &str| {
        let name = line.split('(').next()?.rsplit([' ', '*']).next()?.to_owned();
        name.starts_with(&format!("{identifier}_")).then_some(name)
    };
    code.filter_map(name).collect()
}

fn put(file: &Path, text: &str) -> Result<()> {
    fs::write(file, text).with_context(|| format!("cannot write `{}`", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_functions_of_a_header_are_its_declarations() {
        let header =
            "/** m_not(a) */\ntypedef void (*m_tell)(void *);\n * m_nor(b)\nm *m_new(int a);\nbool m_step(m *self);\n";
        assert_eq!(functions(header, "m"), ["m_new", "m_step"]);
    }
}
