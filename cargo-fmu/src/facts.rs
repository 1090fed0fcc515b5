//! What the loader knows of a library, read from its bytes without running it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use anyhow::{Context, Result, bail};
use object::read::elf::{ElfFile, FileHeader, ProgramHeader as _, Sym as _};
use object::{BinaryFormat, ExportTarget, NameOrOrdinal, Object, ObjectSection as _, elf};

use crate::functions;

/// Format of a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Of Linux.
    Elf,
    /// Of macOS.
    MachO,
    /// Of Windows.
    Pe,
}

/// What is read from a library.
#[derive(Debug)]
pub struct Facts {
    /// Format of the file.
    pub format: Format,
    /// Processor, such as `X86_64`.
    pub processor: String,
    /// Names that importers find.
    pub exports: BTreeSet<String>,
    /// Names that must be found elsewhere.
    pub imports: BTreeSet<String>,
    /// Files of the libraries that must be there.
    pub libraries: BTreeSet<String>,
    /// GUID of the model description; None when the library does not export it.
    pub guid: Option<String>,
    /// ELF: version of the GNU C library that each symbol of it needs.
    pub glibc: BTreeMap<String, (u32, u32)>,
    /// ELF: folders in which libraries are searched (RPATH).
    pub search_paths: Vec<String>,
    /// ELF: own functions that are looked up by name at run time: another FMU of the process could take their place.
    pub unbound: Vec<String>,
    /// ELF: the process must let data be run as code.
    pub executable_stack: bool,
}

impl Facts {
    /// Reads an ELF, Mach-O or PE library.
    ///
    /// # Errors
    /// When the bytes are no such library, or a damaged one.
    pub fn read(library: &[u8]) -> Result<Self> {
        let file = object::File::parse(library).context("this is no library")?;
        let format = match file.format() {
            BinaryFormat::Elf => Format::Elf,
            BinaryFormat::MachO => Format::MachO,
            BinaryFormat::Pe => Format::Pe,
            other => bail!("a library in the format {other:?} is not known"),
        };
        let (imports, libraries) = imports(&file)?;
        let mut facts = Self {
            format,
            processor: format!("{:?}", file.architecture()),
            exports: exports(&file)?,
            imports,
            libraries,
            guid: guid(&file)?,
            glibc: BTreeMap::new(),
            search_paths: Vec::new(),
            unbound: Vec::new(),
            executable_stack: false,
        };
        let read = match &file {
            object::File::Elf32(file) => facts.read_elf(file),
            object::File::Elf64(file) => facts.read_elf(file),
            _ => Ok(()),
        };
        read.context("the ELF file is damaged")?;
        Ok(facts)
    }

    /// Oldest version of the GNU C library that has everything; None when none is needed.
    pub fn needed_glibc(&self) -> Option<(u32, u32)> {
        self.glibc.values().copied().max()
    }

    fn read_elf<H: FileHeader>(&mut self, file: &ElfFile<H>) -> Result<()> {
        self.glibc = glibc(file)?;
        self.unbound = unbound(file)?;
        let dynamic = file.elf_dynamic_table()?;
        for entry in dynamic.iter() {
            if entry.tag == elf::DT_RPATH || entry.tag == elf::DT_RUNPATH {
                self.search_paths.push(text(dynamic.string(entry)?));
            }
            if entry.tag == elf::DT_NEEDED {
                self.libraries.insert(text(dynamic.string(entry)?));
            }
        }
        // without the header the kernel assumes an executable stack
        let endian = file.endian();
        let header = file.elf_program_headers().iter().find(|header| header.p_type(endian) == elf::PT_GNU_STACK);
        self.executable_stack = header.is_none_or(|header| header.p_flags(endian).contains(elf::PF_X));
        Ok(())
    }
}

impl fmt::Display for Facts {
    /// One line, such as `Elf X86_64, 36 functions, glibc 2.14 or newer, needs libc.so.6, libm.so.6`.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:?} {}, {} functions", self.format, self.processor, self.exports.len())?;
        if let Some((major, minor)) = self.needed_glibc() {
            write!(f, ", glibc {major}.{minor} or newer")?;
        }
        let libraries: Vec<_> = self.libraries.iter().map(String::as_str).collect();
        write!(f, ", needs {}", if libraries.is_empty() { "no library".into() } else { libraries.join(", ") })
    }
}

fn exports(file: &object::File) -> Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    for export in file.exports()? {
        let export = export?;
        let NameOrOrdinal::Name(name) = export.name() else { bail!("an export has a number and no name") };
        names.insert(c_name(file, name));
    }
    Ok(names)
}

/// The characters at the symbol.
fn guid(file: &object::File) -> Result<Option<String>> {
    for export in file.exports()? {
        let export = export?;
        let NameOrOrdinal::Name(name) = export.name() else { continue };
        if c_name(file, name) == functions::GUID {
            let ExportTarget::Address { address } = export.target() else { bail!("the GUID is in another library") };
            let bytes = file.sections().find_map(|section| section.data_range(address, 36).ok().flatten());
            return Ok(Some(text(bytes.context("the GUID is outside of the file")?)));
        }
    }
    Ok(None)
}

/// Names and, where the format lists them there, libraries.
fn imports(file: &object::File) -> Result<(BTreeSet<String>, BTreeSet<String>)> {
    let (mut names, mut libraries) = (BTreeSet::new(), BTreeSet::new());
    for import in file.imports()? {
        let import = import?;
        if let NameOrOrdinal::Name(name) = import.name() {
            names.insert(c_name(file, name));
        }
        if !import.library().is_empty() {
            libraries.insert(text(import.library()));
        }
    }
    Ok((names, libraries))
}

// Mach-O puts an underscore before every C name
fn c_name(file: &object::File, name: &[u8]) -> String {
    let name = text(name);
    if file.format() == BinaryFormat::MachO { name.strip_prefix('_').unwrap_or(&name).to_owned() } else { name }
}

fn glibc<H: FileHeader>(file: &ElfFile<H>) -> Result<BTreeMap<String, (u32, u32)>> {
    let (endian, symbols) = (file.endian(), file.elf_dynamic_symbol_table());
    let mut needed = BTreeMap::new();
    let Some(versions) = file.elf_section_table().versions(endian, file.data())? else { return Ok(needed) };
    for (index, symbol) in symbols.enumerate() {
        let Some(version) = versions.version(versions.version_index(endian, index).index())? else { continue };
        if let Some(version) = glibc_version(&text(version.name())) {
            needed.insert(text(symbol.name(endian, symbols.strings())?), version);
        }
    }
    Ok(needed)
}

fn unbound<H: FileHeader>(file: &ElfFile<H>) -> Result<Vec<String>> {
    let (endian, symbols) = (file.endian(), file.elf_dynamic_symbol_table());
    let mut names = Vec::new();
    for (_, relocation) in file.dynamic_relocations().into_iter().flatten() {
        let object::RelocationTarget::Symbol(index) = relocation.target() else { continue };
        let symbol = symbols.symbol(index)?;
        if !symbol.is_undefined(endian) {
            names.push(text(symbol.name(endian, symbols.strings())?));
        }
    }
    Ok(names)
}

fn glibc_version(symbol_version: &str) -> Option<(u32, u32)> {
    let mut parts = symbol_version.strip_prefix("GLIBC_")?.split('.');
    Some((parts.next()?.parse().ok()?, parts.next()?.parse().ok()?))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_no_library_is_refused() {
        assert_eq!(Facts::read(b"PK\x03\x04 something else").unwrap_err().to_string(), "this is no library");
    }

    #[test]
    fn versions_compare_as_numbers() {
        assert_eq!(glibc_version("GLIBC_2.2.5"), Some((2, 2)));
        assert!(glibc_version("GLIBC_2.4") < glibc_version("GLIBC_2.17"));
        assert_eq!(glibc_version("GLIBC_PRIVATE"), None);
        assert_eq!(glibc_version("GCC_3.0"), None);
    }
}
