//! What a library must be to load everywhere: exact exports, an old C library, no traces of the builder.

use std::path::MAIN_SEPARATOR;

use crate::build;
use crate::facts::{Facts, Format};
use crate::functions::{FMI2_FUNCTIONS, OWN_PREFIX};
use crate::linker::{self, Linker};
use crate::platform::Platform;
use crate::project::Project;

// the parts of each system that every machine has
const LINUX: &[&str] = &["libc.so.", "libm.so.", "libdl.so.", "libpthread.so.", "librt.so.", "ld-linux"];
const LIBGCC: &str = "libgcc_s.so.";
const MACOS: &[&str] = &["/usr/lib/", "/System/Library/"];
const WINDOWS: &[&str] = &[
    "advapi32.dll",
    "api-ms-win-",
    "bcrypt.dll",
    "bcryptprimitives.dll",
    "kernel32.dll",
    "msvcrt.dll",
    "ntdll.dll",
    "ucrtbase.dll",
    "user32.dll",
    "userenv.dll",
    "ws2_32.dll",
];

/// What the library may hold.
pub struct Rules {
    /// Newest version of the GNU C library whose symbols may be needed; any when there is none.
    pub glibc: Option<(u32, u32)>,
    /// `libgcc_s` may be needed: distributions have it, small containers may not.
    pub libgcc: bool,
    /// Folders of the builder that the library must not name, each with its last separator.
    pub folders: Vec<String>,
}

impl Rules {
    /// The rules for an FMU built on this machine.
    pub fn for_host(project: &Project) -> Self {
        let mut folders = build::dependency_folders(project);
        folders.push(project.root.clone());
        folders.extend(build::sysroot(project));
        folders.extend(std::env::home_dir());
        let texts = folders.iter().map(|folder| format!("{}{MAIN_SEPARATOR}", folder.display()));
        // the root of the disk is in every path
        let folders = texts.filter(|text| text.len() > 3).collect();
        let old = project.linker == Linker::Zig;
        Self { glibc: old.then_some(linker::GLIBC), libgcc: !old, folders }
    }

    /// The rules for an FMU of unknown origin.
    pub fn for_anyone() -> Self {
        Self {
            glibc: None,
            libgcc: true,
            folders: ["/home/", "/root/", "/Users/", ":\\Users\\"].map(str::to_owned).to_vec(),
        }
    }
}

/// The functions of FMI 2.0 that a library does not export.
pub fn missing(facts: &Facts) -> Vec<&'static str> {
    FMI2_FUNCTIONS.into_iter().filter(|name| !facts.exports.contains(*name)).collect()
}

/// The required functions that a library does not export, one sentence each.
pub fn incomplete<'a>(facts: &Facts, required: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let missing = required.into_iter().filter(|name| !facts.exports.contains(*name));
    missing.map(|name| format!("`{name}` is not exported")).collect()
}

/// Everything that keeps a library from running everywhere, one sentence each; the standard allows it.
pub fn limits(library: &[u8], facts: &Facts, rules: &Rules) -> Vec<String> {
    let known = |name: &str| FMI2_FUNCTIONS.contains(&name) || name.starts_with(OWN_PREFIX);
    let extra = first_of(facts.exports.iter().filter(|name| !known(name)));
    let mut limits: Vec<_> = extra.map(|name| format!("{name} is exported and should not be")).into_iter().collect();
    let named = rules.folders.iter().filter(|folder| contains(library, folder.as_bytes()));
    limits.extend(named.map(|folder| format!("the builder's folder `{folder}` is named inside")));
    if let Some((major, minor)) = rules.glibc {
        let new = facts.glibc.iter().filter(|(_, version)| *version > &(major, minor));
        limits.extend(new.map(|(name, (needed_major, needed_minor))| {
            format!("`{name}` needs GLIBC_{needed_major}.{needed_minor}, newer than GLIBC_{major}.{minor}")
        }));
    }
    let unbound = first_of(facts.unbound.iter());
    limits.extend(unbound.map(|name| format!("it does not bind its own {name} at build time")));
    limits.extend(facts.search_paths.iter().map(|folders| format!("it searches libraries in `{folders}` (RPATH)")));
    let allowed = |name: &str| is_of_the_system(facts.format, name) || rules.libgcc && name.starts_with(LIBGCC);
    let foreign = facts.libraries.iter().filter(|name| !allowed(name));
    limits.extend(foreign.map(|name| format!("it needs the library `{name}`")));
    if facts.executable_stack {
        limits.push("it asks for an executable stack".into());
    }
    limits
}

/// The first name with the number of the others: a C++ library has hundreds.
fn first_of<'a>(mut names: impl Iterator<Item = &'a String>) -> Option<String> {
    let first = names.next()?;
    Some(match names.count() {
        0 => format!("`{first}`"),
        more => format!("`{first}` (and {more} more)"),
    })
}

/// Everything that is wrong with a library of this project, one sentence each.
pub fn faults(library: &[u8], facts: &Facts, rules: &Rules) -> Vec<String> {
    [incomplete(facts, FMI2_FUNCTIONS), limits(library, facts, rules)].concat()
}

/// What is wrong with a library in this place of an FMU that has this GUID, one sentence each.
pub fn misplaced(facts: &Facts, platform: &Platform, guid: &str) -> Vec<String> {
    let mut faults: Vec<_> = platform.refuses(facts).into_iter().collect();
    if let Some(own) = facts.guid.as_deref().filter(|own| *own != guid) {
        faults.push(format!("it is of another model: its GUID is {own}, the description has {guid}"));
    }
    faults
}

fn is_of_the_system(format: Format, library: &str) -> bool {
    let (known, name) = match format {
        Format::Elf => (LINUX, library.to_owned()),
        Format::MachO => (MACOS, library.to_owned()),
        // names of files have no case there
        Format::Pe => (WINDOWS, library.to_lowercase()),
    };
    known.iter().any(|start| name.starts_with(start))
}

fn contains(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|window| window == part)
}

#[cfg(test)]
mod tests;
