//! Packs an FMU: a zip file that every importer reads, with the same bytes for the same content.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Path of the description inside an FMU.
pub const DESCRIPTION: &str = "modelDescription.xml";

/// Files of an FMU by their path inside it, sorted.
#[derive(Default)]
pub struct Content(BTreeMap<String, Vec<u8>>);

impl Content {
    /// Adds a file.
    ///
    /// # Errors
    /// When the path is not a plain relative one with forward slashes, or is there already.
    pub fn add(&mut self, path: impl Into<String>, bytes: Vec<u8>) -> Result<()> {
        let path = path.into();
        let plain = path.split('/').all(|part| !matches!(part, "" | "." | ".."));
        ensure!(plain && !path.contains(['\\', ':']), "`{path}` is no path for a file inside an FMU");
        ensure!(!self.0.contains_key(&path), "`{path}` would be in the FMU twice");
        self.0.insert(path, bytes);
        Ok(())
    }

    /// Adds everything in a folder of the disk, below `prefix`, but what is hidden; a folder that is not there adds
    /// nothing.
    ///
    /// # Errors
    /// When a file cannot be read, or for a link: it may lead out of the folder, or back into it without end.
    pub fn add_folder(&mut self, prefix: &str, folder: &Path) -> Result<()> {
        if !folder.is_dir() {
            return Ok(());
        }
        for entry in fs::read_dir(folder).with_context(|| format!("cannot list `{}`", folder.display()))? {
            let entry = entry?;
            let (name, source) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
            if name.starts_with('.') {
                continue;
            }
            let (path, shown, kind) = (format!("{prefix}/{name}"), source.display(), entry.file_type()?);
            ensure!(!kind.is_symlink(), "`{shown}` is a link\nhint: put a copy of what it leads to in its place");
            if kind.is_dir() {
                self.add_folder(&path, &source)?;
            } else {
                self.add(path, fs::read(&source).with_context(|| format!("cannot read `{shown}`"))?)?;
            }
        }
        Ok(())
    }

    /// The files by path.
    pub fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.0.iter().map(|(path, bytes)| (path.as_str(), bytes.as_slice()))
    }

    /// A text file of the content.
    pub fn text(&self, path: &str) -> Option<&str> {
        std::str::from_utf8(self.0.get(path)?).ok()
    }
}

/// How much time may be spent on a small file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// A moment.
    Quick,
    /// Some seconds for a megabyte; a thirtieth smaller.
    Thorough,
}

impl Effort {
    /// Level of deflate; each level above 9 is an iteration of Zopfli.
    fn level(self) -> i64 {
        match self {
            Self::Quick => 9,
            Self::Thorough => 14,
        }
    }
}

/// Zopfli starts new blocks at the ends of what it gets: with parts of 128 KiB a library is 0.6 to 1.1 % smaller than in
/// one part, because its own search for the ends of blocks finds at most 15.
const PART: usize = 1 << 17;

/// The FMU as bytes: deflate, sorted, with one fixed time stamp, so that equal content gives equal bytes.
///
/// # Errors
/// When `modelDescription.xml` is missing.
pub fn to_bytes(content: &Content, effort: Effort) -> Result<Vec<u8>> {
    ensure!(content.0.contains_key("modelDescription.xml"), "an FMU needs a `modelDescription.xml`");
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(effort.level()))
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (path, bytes) in &content.0 {
        writer.start_file(path.as_str(), options)?;
        for part in bytes.chunks(PART) {
            writer.write_all(part)?;
        }
    }
    Ok(writer.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    fn content(order: &[&str]) -> Content {
        let mut content = Content::default();
        for path in order {
            content.add(*path, path.repeat(100).into_bytes()).unwrap();
        }
        content
    }

    #[test]
    fn the_same_content_gives_the_same_bytes() {
        let one =
            to_bytes(&content(&["modelDescription.xml", "resources/a.csv", "binaries/linux64/m.so"]), Effort::Quick)
                .unwrap();
        let two =
            to_bytes(&content(&["binaries/linux64/m.so", "modelDescription.xml", "resources/a.csv"]), Effort::Quick)
                .unwrap();
        assert_eq!(one, two);
    }

    #[test]
    fn every_entry_needs_zip_2_0_at_most_and_comes_back_whole() {
        for effort in [Effort::Quick, Effort::Thorough] {
            let bytes = to_bytes(&content(&["modelDescription.xml", "documentation/index.html"]), effort).unwrap();
            let local_headers = bytes.windows(4).enumerate().filter(|(_, window)| *window == b"PK\x03\x04");
            let versions: Vec<_> =
                local_headers.map(|(at, _)| u16::from_le_bytes([bytes[at + 4], bytes[at + 5]])).collect();
            assert_eq!(versions.len(), 2);
            assert!(versions.iter().all(|version| *version <= 20), "{versions:?}");

            let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
            let mut text = String::new();
            archive.by_name("documentation/index.html").unwrap().read_to_string(&mut text).unwrap();
            assert_eq!(text, "documentation/index.html".repeat(100));
        }
    }

    #[test]
    fn effort_makes_an_fmu_smaller() {
        let mut content = content(&["modelDescription.xml"]);
        let text = (0..10_000).map(|i: u32| i.pow(2).to_string()).collect::<String>();
        content.add("resources/squares.txt", text.into_bytes()).unwrap();
        let size = |effort| to_bytes(&content, effort).unwrap().len() as f64;
        assert!(size(Effort::Thorough) < 0.98 * size(Effort::Quick));
    }

    #[test]
    fn bad_paths_are_refused() {
        for path in ["/etc/passwd", "../up", "a\\b", "C:/x", "a//b", "", "a/./b"] {
            assert!(Content::default().add(path, Vec::new()).is_err(), "{path}");
        }
        let mut twice = content(&["modelDescription.xml"]);
        assert!(twice.add("modelDescription.xml", Vec::new()).is_err());
    }

    #[test]
    fn a_folder_is_added_with_what_lies_below_it() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("maps")).unwrap();
        fs::write(folder.path().join("maps/one.csv"), "1").unwrap();
        fs::write(folder.path().join(".hidden"), "").unwrap();
        fs::create_dir(folder.path().join(".git")).unwrap();
        fs::write(folder.path().join(".git/HEAD"), "").unwrap();
        let mut content = Content::default();
        content.add_folder("resources", folder.path()).unwrap();
        content.add_folder("resources", &folder.path().join("missing")).unwrap();
        assert_eq!(content.0.keys().collect::<Vec<_>>(), ["resources/maps/one.csv"]);
    }

    #[test]
    #[cfg(unix)]
    fn a_link_is_refused_by_name() {
        for target in ["..", "missing"] {
            let folder = tempfile::tempdir().unwrap();
            let link = folder.path().join("link");
            std::os::unix::fs::symlink(target, &link).unwrap();
            let error = Content::default().add_folder("resources", folder.path()).unwrap_err().to_string();
            assert!(error.starts_with(&format!("`{}` is a link\nhint: ", link.display())), "{error}");
        }
    }

    #[test]
    fn without_a_model_description_nothing_is_packed() {
        assert!(to_bytes(&content(&["resources/a.csv"]), Effort::Quick).is_err());
    }
}
