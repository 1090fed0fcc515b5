//! The platforms for which an FMU can hold a library, as FMI 2.0.4 names them.

use anyhow::{Context, Result, bail};

use crate::facts::{Facts, Format};

/// A platform.
#[derive(Debug, PartialEq, Eq)]
pub struct Platform {
    /// Folder of its library below `binaries`.
    pub folder: &'static str,
    /// How the compiler names it.
    pub triple: &'static str,
    /// File name extension of its C libraries.
    pub extension: &'static str,
    /// Format of its libraries.
    pub format: Format,
    /// Processor, as in [`Facts`].
    pub processor: &'static str,
}

const fn platform(
    folder: &'static str,
    triple: &'static str,
    extension: &'static str,
    format: Format,
    processor: &'static str,
) -> Platform {
    Platform { folder, triple, extension, format, processor }
}

/// Linux on x86-64.
pub const LINUX64: &Platform = &PLATFORMS[0];
/// Linux on 64-bit ARM.
pub const AARCH64_LINUX: &Platform = &PLATFORMS[1];
/// Windows on x86-64.
pub const WIN64: &Platform = &PLATFORMS[2];

const PLATFORMS: [Platform; 6] = [
    platform("linux64", "x86_64-unknown-linux-gnu", "so", Format::Elf, "X86_64"),
    platform("aarch64-linux", "aarch64-unknown-linux-gnu", "so", Format::Elf, "Aarch64"),
    platform("win64", "x86_64-pc-windows-gnu", "dll", Format::Pe, "X86_64"),
    platform("aarch64-windows", "aarch64-pc-windows-gnullvm", "dll", Format::Pe, "Aarch64"),
    platform("darwin64", "x86_64-apple-darwin", "dylib", Format::MachO, "X86_64"),
    platform("aarch64-darwin", "aarch64-apple-darwin", "dylib", Format::MachO, "Aarch64"),
];

impl Platform {
    /// The platform of this machine.
    ///
    /// # Errors
    /// When FMI has no name for it.
    pub fn host() -> Result<&'static Self> {
        let (system, processor) = (std::env::consts::OS, std::env::consts::ARCH);
        let folder = match (system, processor) {
            ("linux", "x86_64") => "linux64",
            ("windows", "x86_64") => "win64",
            ("macos", "x86_64") => "darwin64",
            ("linux", "aarch64") => "aarch64-linux",
            ("windows", "aarch64") => "aarch64-windows",
            ("macos", "aarch64") => "aarch64-darwin",
            _ => bail!("FMI 2.0 has no binary folder for `{system}` on `{processor}`"),
        };
        Self::named(folder)
    }

    /// The platform of a folder below `binaries`.
    ///
    /// # Errors
    /// When there is none of that name; the names are in the message.
    pub fn named(folder: &str) -> Result<&'static Self> {
        Self::find(folder).with_context(|| {
            let names: Vec<_> = PLATFORMS.iter().map(|platform| format!("`{}`", platform.folder)).collect();
            format!("no platform `{folder}`\nhint: the platforms are {}", names.join(", "))
        })
    }

    /// The platform of a folder below `binaries`, None for one that is not known.
    pub fn find(folder: &str) -> Option<&'static Self> {
        PLATFORMS.iter().find(|platform| platform.folder == folder)
    }

    /// Why a library cannot be loaded on this platform; None when it can.
    pub fn refuses(&self, facts: &Facts) -> Option<String> {
        let (format, processor) = (facts.format, &facts.processor);
        let fits = format == self.format && processor == self.processor;
        (!fits).then(|| {
            let Self { folder, format: expected, processor: own, .. } = self;
            format!("it is for {format:?} {processor}, and `{folder}` loads {expected:?} {own}")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_host_is_a_platform_and_loads_the_tests_themselves() {
        let host = Platform::host().unwrap();
        assert_eq!(Platform::named(host.folder).unwrap(), host);
        assert_eq!(host.extension, std::env::consts::DLL_EXTENSION);
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert_eq!(host.refuses(&Facts::read(&own).unwrap()), None);
    }

    #[test]
    fn an_unknown_platform_is_refused_with_the_known_ones() {
        let error = Platform::named("win32").unwrap_err().to_string();
        assert!(error.starts_with("no platform `win32`\nhint: the platforms are `linux64`, "), "{error}");
    }

    #[test]
    fn names_of_the_release_set_are_those_of_the_standard() {
        assert_eq!([LINUX64, AARCH64_LINUX, WIN64].map(|p| p.folder), ["linux64", "aarch64-linux", "win64"]);
    }
}
