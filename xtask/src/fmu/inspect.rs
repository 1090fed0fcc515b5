//! What a library must be to load everywhere: exact exports, an old C library, no traces of the builder.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use object::read::elf::{ElfFile64, ProgramHeader as _, Sym as _};
use object::{Object, elf};

use super::build;
use crate::workspace::Workspace;

/// The functions of FMI 2.0 for co-simulation, as `fmi2Functions.h` lists them.
pub const FMI2_FUNCTIONS: [&str; 34] = [
    "fmi2CancelStep",
    "fmi2DeSerializeFMUstate",
    "fmi2DoStep",
    "fmi2EnterInitializationMode",
    "fmi2ExitInitializationMode",
    "fmi2FreeFMUstate",
    "fmi2FreeInstance",
    "fmi2GetBoolean",
    "fmi2GetBooleanStatus",
    "fmi2GetDirectionalDerivative",
    "fmi2GetFMUstate",
    "fmi2GetInteger",
    "fmi2GetIntegerStatus",
    "fmi2GetReal",
    "fmi2GetRealOutputDerivatives",
    "fmi2GetRealStatus",
    "fmi2GetStatus",
    "fmi2GetString",
    "fmi2GetStringStatus",
    "fmi2GetTypesPlatform",
    "fmi2GetVersion",
    "fmi2Instantiate",
    "fmi2Reset",
    "fmi2SerializeFMUstate",
    "fmi2SerializedFMUstateSize",
    "fmi2SetBoolean",
    "fmi2SetDebugLogging",
    "fmi2SetFMUstate",
    "fmi2SetInteger",
    "fmi2SetReal",
    "fmi2SetRealInputDerivatives",
    "fmi2SetString",
    "fmi2SetupExperiment",
    "fmi2Terminate",
];

// what `fmi2-export` adds: the files of the FMU, and its GUID
const OWN_FUNCTIONS: [&str; 2] = ["fmi2_export_file", "fmi2_export_guid"];

// the parts of the GNU C library, and nothing else
const SYSTEM_LIBRARIES: &[&str] = &["libc.so.", "libm.so.", "libdl.so.", "libpthread.so.", "librt.so.", "ld-linux"];

/// What the library may hold.
pub struct Rules {
    /// Symbols that must be exported; no others may be.
    pub exports: BTreeSet<String>,
    /// Newest version of the GNU C library whose symbols may be needed.
    pub glibc: (u32, u32),
    /// Folders of the builder that the library must not name.
    pub folders: Vec<PathBuf>,
}

impl Rules {
    /// The rules for an FMU built on this machine.
    pub fn for_host(workspace: &Workspace) -> Self {
        let mut folders = build::dependency_folders(workspace);
        folders.push(workspace.root.clone());
        folders.extend(std::env::home_dir());
        let exports = FMI2_FUNCTIONS.iter().chain(&OWN_FUNCTIONS);
        Self { exports: exports.map(ToString::to_string).collect(), glibc: build::GLIBC, folders }
    }
}

/// Checks a library against the rules.
///
/// # Errors
/// One message with everything that is wrong, or why the library cannot be read.
pub fn check(library: &[u8], rules: &Rules) -> Result<()> {
    let mut faults = Vec::new();
    exports(library, rules, &mut faults)?;
    traces(library, rules, &mut faults);
    if library.starts_with(&elf::ELFMAG) {
        linux(library, rules, &mut faults).context("the ELF file is damaged")?;
    }
    ensure!(faults.is_empty(), "{}", faults.join("\n"));
    Ok(())
}

fn exports(library: &[u8], rules: &Rules, faults: &mut Vec<String>) -> Result<()> {
    let file = object::File::parse(library).context("this is no library")?;
    let mut found = BTreeSet::new();
    for export in file.exports()? {
        let export = export?;
        let object::NameOrOrdinal::Name(name) = export.name() else { bail!("an export has a number and no name") };
        let name = String::from_utf8_lossy(name).into_owned();
        // Mach-O puts an underscore before every C name
        let macho = file.format() == object::BinaryFormat::MachO;
        found.insert(if macho { name.trim_start_matches('_').to_owned() } else { name });
    }
    faults.extend(rules.exports.difference(&found).map(|name| format!("`{name}` is not exported")));
    faults.extend(found.difference(&rules.exports).map(|name| format!("`{name}` is exported and should not be")));
    Ok(())
}

fn traces(library: &[u8], rules: &Rules, faults: &mut Vec<String>) {
    for folder in &rules.folders {
        let text = format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR);
        if text.len() > 3 && contains(library, text.as_bytes()) {
            faults.push(format!("the builder's folder `{text}` is named inside"));
        }
    }
}

fn contains(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|window| window == part)
}

fn linux(library: &[u8], rules: &Rules, faults: &mut Vec<String>) -> Result<()> {
    let file = Elf::parse(library)?;
    symbol_versions(&file, rules, faults)?;
    own_symbols(&file, faults)?;
    libraries(&file, faults)?;
    stack(&file, faults);
    Ok(())
}

type Elf<'a> = ElfFile64<'a, object::Endianness>;

fn symbol_versions(file: &Elf, rules: &Rules, faults: &mut Vec<String>) -> Result<()> {
    let (endian, symbols) = (file.endian(), file.elf_dynamic_symbol_table());
    let Some(versions) = file.elf_section_table().versions(endian, file.data())? else { return Ok(()) };
    for (index, symbol) in symbols.enumerate() {
        let Some(version) = versions.version(versions.version_index(endian, index).index())? else { continue };
        let version = String::from_utf8_lossy(version.name());
        if glibc_version(&version).is_some_and(|version| version > rules.glibc) {
            let name = String::from_utf8_lossy(symbol.name(endian, symbols.strings())?);
            let (major, minor) = rules.glibc;
            faults.push(format!("`{name}` needs {version}, newer than GLIBC_{major}.{minor}"));
        }
    }
    Ok(())
}

// own functions that are looked up by name at run time: another FMU of the process could take their place
fn own_symbols(file: &Elf, faults: &mut Vec<String>) -> Result<()> {
    let (endian, symbols) = (file.endian(), file.elf_dynamic_symbol_table());
    for (_, relocation) in file.dynamic_relocations().into_iter().flatten() {
        let object::RelocationTarget::Symbol(index) = relocation.target() else { continue };
        let symbol = symbols.symbol(index)?;
        if !symbol.is_undefined(endian) {
            let name = String::from_utf8_lossy(symbol.name(endian, symbols.strings())?);
            faults.push(format!("it does not bind its own `{name}` at build time"));
        }
    }
    Ok(())
}

// other libraries, and where they are searched
fn libraries(file: &Elf, faults: &mut Vec<String>) -> Result<()> {
    let dynamic = file.elf_dynamic_table()?;
    for entry in dynamic.iter() {
        if entry.tag == elf::DT_RPATH || entry.tag == elf::DT_RUNPATH {
            let folders = String::from_utf8_lossy(dynamic.string(entry)?);
            faults.push(format!("it searches libraries in `{folders}` (RPATH)"));
        }
        if entry.tag == elf::DT_NEEDED {
            let name = String::from_utf8_lossy(dynamic.string(entry)?);
            if !SYSTEM_LIBRARIES.iter().any(|system| name.starts_with(system)) {
                faults.push(format!("it needs the library `{name}`"));
            }
        }
    }
    Ok(())
}

// without the header the kernel assumes an executable stack
fn stack(file: &Elf, faults: &mut Vec<String>) {
    let endian = file.endian();
    let header = file.elf_program_headers().iter().find(|header| header.p_type(endian) == elf::PT_GNU_STACK);
    if header.is_none_or(|header| header.p_flags(endian).contains(elf::PF_X)) {
        faults.push("it asks for an executable stack".into());
    }
}

fn glibc_version(symbol_version: &str) -> Option<(u32, u32)> {
    let mut parts = symbol_version.strip_prefix("GLIBC_")?.split('.');
    Some((parts.next()?.parse().ok()?, parts.next()?.parse().ok()?))
}

#[cfg(test)]
mod tests;
