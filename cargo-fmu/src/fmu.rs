//! From a built library to the bytes of an FMU.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use anyhow::{Context, Result, bail, ensure};
use cargo_metadata::Package;

use crate::binary;
use crate::build::Built;
use crate::contents::chapters::QuickStart;
use crate::contents::terminals::Ports;
use crate::contents::{chapters, guide, licences, picture, reference, terminals};
use crate::facts::Facts;
use crate::functions::{self, FMI2_FUNCTIONS, OWN_PREFIX};
use crate::inspect::{self, Rules};
use crate::interface::Interface;
use crate::pack::{self, Content, DESCRIPTION, Effort};
use crate::platform::Platform;
use crate::process;
use crate::project::Project;

/// Path of the page for people.
const PAGE: &str = "documentation/index.html";

/// A packed FMU and what was seen of its libraries.
pub struct Packed {
    /// The file.
    pub bytes: Vec<u8>,
    /// The libraries, as the loader of their platform sees them; that of this machine is the first.
    pub facts: Vec<(&'static Platform, Facts)>,
    /// Violations of the rules for portable libraries, one line each, with the platform.
    pub faults: Vec<String>,
}

/// Packs libraries of a model with the files that `source` writes, a library of the same model for this machine; the
/// folder `resources` next to the manifest, and the licenses.
///
/// # Errors
/// When a library is not an FMI library, is of another model or for another platform than stated, when `source` cannot be
/// loaded, or when a file cannot be read.
pub fn pack(project: &Project, package: &Package, source: &Path, all: &[Built], rules: &Rules) -> Result<Packed> {
    let libraries = all.iter().map(|built| read(package, built)).collect::<Result<Vec<_>>>()?;
    let mut content = Content::default();
    let (chapters, outside) = (chapters::read(package)?, chapters::outside(project, package));
    let platforms: Vec<_> = all.iter().map(|built| built.platform.folder).collect();
    for (path, text) in binary::files(source)? {
        let text = if path == PAGE { guide::insert(&text, &chapters, &platforms, &outside) } else { text };
        content.add(path, text.into_bytes())?;
    }
    if let Some(QuickStart { name, program, plot }) = chapters.quick_start {
        content.add(format!("documentation/{name}"), program.into_bytes())?;
        if let Some(plot) = plot {
            content.add(format!("documentation/{}", guide::PLOT), plot.into_bytes())?;
        }
    }
    let interface = Interface::of_library(content.text(DESCRIPTION).unwrap_or_default())?;
    let (identifier, ports) = (&interface.identifier, Ports::of(&interface));
    let picture = picture::write(&ports)?;
    content.add(terminals::ICON, picture.clone())?;
    content.add("model.png", picture)?;
    content.add(terminals::FILE, terminals::write(&ports).into_bytes())?;
    let mut packed = Packed { bytes: Vec::new(), facts: Vec::new(), faults: Vec::new() };
    for (built, (library, facts)) in all.iter().zip(libraries) {
        belongs(built, &facts, &interface.guid)?;
        let platform = built.platform;
        let faults = inspect::faults(&library, &facts, rules);
        packed.faults.extend(faults.iter().map(|fault| format!("{}: {fault}", platform.folder)));
        packed.facts.push((platform, facts));
        content.add(format!("binaries/{}/{identifier}.{}", platform.folder, platform.extension), library)?;
    }
    let resources = package.manifest_path.with_file_name("resources").into_std_path_buf();
    match reference::files(source, &interface, &resources) {
        Ok(files) => {
            for (path, text) in files {
                content.add(path, text.into_bytes())?;
            }
        }
        Err(reason) => eprintln!("warning: there is no reference run in the FMU: {reason:#}"),
    }
    content.add_folder("resources", &resources)?;
    let packages = all.iter().flat_map(|built| built.packages.iter().cloned()).collect();
    for (path, text) in licences::files(project, package, &packages)? {
        content.add(path, text.into_bytes())?;
    }
    // what goes to many is packed once
    let effort = if all.len() == 1 { Effort::Quick } else { Effort::Thorough };
    packed.bytes = pack::to_bytes(&content, effort)?;
    Ok(packed)
}

/// Reads a library, which must be one of FMI.
fn read(package: &Package, built: &Built) -> Result<(Vec<u8>, Facts)> {
    let shown = built.library.display();
    let library = fs::read(&built.library).with_context(|| format!("cannot read `{shown}`"))?;
    let facts = Facts::read(&library).with_context(|| format!("cannot read `{shown}`"))?;
    exports_a_model(package, &facts)?;
    Ok((library, facts))
}

/// A library must be of this model, and for its platform.
fn belongs(built: &Built, facts: &Facts, guid: &str) -> Result<()> {
    let shown = built.library.display();
    ensure!(
        facts.guid.is_some(),
        "`{shown}` is of an unknown model: it does not export `{}`\nhint: Build it with `fmi2-export`.",
        functions::GUID
    );
    let misplaced = inspect::misplaced(facts, built.platform, guid);
    ensure!(misplaced.is_empty(), "`{shown}` cannot be packed: {}", misplaced.join("; "));
    Ok(())
}

/// Writes an FMU; of a file that holds the same bytes only the date changes: it is as new as the sources.
///
/// # Errors
/// When the file cannot be written.
pub fn write(file: &Path, bytes: &[u8]) -> Result<()> {
    let shown = file.file_name().unwrap_or_default().to_string_lossy();
    if fs::read(file).is_ok_and(|old| old == bytes) {
        process::up_to_date(&format!("`{shown}`"));
        // one that must not be written keeps its date
        if let Ok(kept) = fs::File::options().append(true).open(file) {
            kept.set_modified(SystemTime::now()).with_context(|| format!("cannot date `{shown}`"))?;
        }
        return Ok(());
    }
    process::header(&format!("write `{shown}` ({} kB)", bytes.len().div_ceil(1000)));
    // a reader must never see half an FMU
    let part = file.with_extension("part");
    fs::write(&part, bytes).and_then(|()| fs::rename(&part, file)).with_context(|| format!("cannot write `{shown}`"))
}

/// Hint in the error message for a package that does not depend on `fmi2-export`.
const DEPENDENCY: &str = "hint: `fmi2-export = { path = \"...\" }` or `fmi2-export = { git = \"...\" }` belongs in \
                          `[dependencies]`: it is in no registry\n";

fn exports_a_model(package: &Package, facts: &Facts) -> Result<()> {
    let missing = inspect::missing(facts);
    let name = &package.name;
    let source = package.targets.iter().find(|target| target.is_cdylib()).map(|target| target.src_path.as_str());
    let call = format!("hint: `fmi2_export::export!(YourModel);` belongs in `{}`", source.unwrap_or("src/lib.rs"));
    if facts.imports.iter().any(|import| import.starts_with(OWN_PREFIX)) {
        bail!("`{name}` uses `fmi2-export` and exports no model\n{call}");
    }
    if missing.len() == FMI2_FUNCTIONS.len() {
        let depends = package.dependencies.iter().any(|dependency| dependency.name == "fmi2-export");
        let first = if depends { "" } else { DEPENDENCY };
        bail!("the library of `{name}` exports no function of FMI 2.0\n{first}{call}");
    }
    ensure!(missing.is_empty(), "the library of `{name}` does not export `{}`", missing.join("`, `"));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_with_the_same_bytes_is_kept_and_is_as_new_as_one_that_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("fmu-a.fmu");
        write(&file, b"one").unwrap();
        let kept = fs::File::options().append(true).open(&file).unwrap();
        kept.set_modified(SystemTime::UNIX_EPOCH).unwrap();
        write(&file, b"one").unwrap();
        // still the same file, which a reader may have open
        assert!(kept.metadata().unwrap().modified().unwrap() > SystemTime::UNIX_EPOCH);
        write(&file, b"two").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"two");
        assert_eq!(kept.metadata().unwrap().len(), 3);
    }
}
