//! From the compiled model to a static library that can be linked together with others of its kind.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{self, Command};

use anyhow::{Context, Result, ensure};

use super::{header, modelica, source};
use crate::binary;
use crate::interface::Interface;
use crate::pack::DESCRIPTION;
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
/// `flags` are more words for the C compiler, which is `cc`, or what `CC` names.
///
/// # Errors
/// When a program of the C compiler is missing or fails: `cc` and `objcopy`, which know ELF files.
pub fn write(compiled: &Path, folder: &Path, flags: &[&str]) -> Result<Library> {
    // others may write into the folder at the same time
    let work = folder.join(format!("made-{}", process::id()));
    fs::create_dir_all(&work).with_context(|| format!("cannot make `{}`", work.display()))?;
    let made = make(compiled, &work, flags).and_then(|made| {
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
fn make(compiled: &Path, work: &Path, flags: &[&str]) -> Result<Library> {
    let interface = Interface::of_library(&description(compiled, work)?)?;
    let identifier = interface.identifier.clone();
    let (header, code) = (work.join(format!("{identifier}.h")), work.join(format!("{identifier}.c")));
    put(&header, &header::write(&interface)?)?;
    put(&code, &source::write(&interface))?;

    let (adapter, joined) = (work.join("adapter.o"), work.join(format!("{identifier}.o")));
    let mut cc = compiler();
    cc.args(["-std=c99", "-O2", "-fPIC", "-Wall", "-Wextra", "-c"]).args(flags);
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

/// Writes a block for each library, with all that it needs, into the folder of a Modelica package; parameters named in
/// `starts` begin with these values there.
///
/// # Errors
/// When a block cannot hold a variable or an enumeration, or a file cannot be read or written.
pub fn modelica_package(libraries: &[Library], folder: &Path, starts: &[(&str, &str)]) -> Result<()> {
    let package = folder.file_name().unwrap_or_default().to_string_lossy();
    let (include, binaries) = (folder.join("Resources/Include"), folder.join("Resources/Library"));
    for folder in [&include, &binaries] {
        fs::create_dir_all(folder).with_context(|| format!("cannot make `{}`", folder.display()))?;
    }
    for Library { archive, header, interface } in libraries {
        put(&folder.join(format!("{}.mo", interface.name)), &modelica::block(interface, &package, starts)?)?;
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

/// The C compiler.
fn compiler() -> Command {
    command(&std::env::var("CC").unwrap_or_default())
}

/// A program with the arguments after its name, as in `CC`.
fn command(words: &str) -> Command {
    let whole = Path::new(words.trim());
    let mut words = if whole.is_file() { vec![words.trim()] } else { words.split_whitespace().collect() }.into_iter();
    let mut command = Command::new(words.next().unwrap_or("cc"));
    command.args(words);
    command
}

/// The functions that a header declares: a name with the identifier as its prefix and an open parenthesis after it.
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
    fn a_compiler_may_have_words_of_its_own() {
        let words = |text: &str| {
            let command = command(text);
            let rest = command.get_args().map(|word| word.to_owned());
            std::iter::once(command.get_program().to_owned()).chain(rest).collect::<Vec<_>>()
        };
        assert_eq!(words(" "), ["cc"]);
        assert_eq!(words("ccache gcc"), ["ccache", "gcc"]);
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("my cc");
        fs::write(&file, "").unwrap();
        assert_eq!(words(file.to_str().unwrap()), [file.as_os_str()]);
    }

    #[test]
    fn the_functions_of_a_header_are_its_declarations() {
        let header = "/** m_not(a) */\ntypedef void (*m_on_message)(void *);\n * m_nor(b)\nm *m_new(int a);\nbool m_step(m *self);\n";
        assert_eq!(functions(header, "m"), ["m_new", "m_step"]);
    }
}
