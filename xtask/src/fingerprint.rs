//! Content hashes that show whether a step is up to date.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use sha2::{Digest, Sha256};

/// SHA-256 of some bytes, in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// One hash over files and folders (with everything in them) below `root`, and over words such as a version.
///
/// Names are hashed as well as contents. Hidden files, byte code and compiled modules are omitted: they are made from
/// the rest. A missing path is treated as empty.
///
/// # Errors
/// When a file cannot be read.
pub fn of(root: &Path, paths: &[&str], words: &[&str]) -> Result<String> {
    let mut files = Vec::new();
    for path in paths {
        collect(&root.join(path), &mut files)?;
    }
    files.sort();
    files.dedup();

    let mut hash = Sha256::new();
    for word in words {
        update(&mut hash, word.as_bytes());
    }
    for file in files {
        let name = file.strip_prefix(root).unwrap_or(&file).to_string_lossy().replace('\\', "/");
        update(&mut hash, name.as_bytes());
        update(&mut hash, &fs::read(&file).with_context(|| format!("cannot read `{}`", file.display()))?);
    }
    Ok(hexadecimal(&hash.finalize()))
}

/// A file that stores the fingerprint of the last run of a step.
pub struct Stamp(pub PathBuf);

impl Stamp {
    /// True when the step was done with this fingerprint.
    pub fn holds(&self, fingerprint: &str) -> bool {
        fs::read_to_string(&self.0).is_ok_and(|text| text.trim() == fingerprint)
    }

    /// Stores the fingerprint.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn set(&self, fingerprint: &str) -> Result<()> {
        fs::write(&self.0, format!("{fingerprint}\n")).with_context(|| format!("cannot write `{}`", self.0.display()))
    }
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    if path.is_file() {
        files.push(path.to_path_buf());
    } else if path.is_dir() {
        for entry in fs::read_dir(path).with_context(|| format!("cannot list `{}`", path.display()))? {
            let path = entry?.path();
            if !is_made(&path) {
                collect(&path, files)?;
            }
        }
    }
    Ok(())
}

fn is_made(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    name.starts_with('.') || name == "__pycache__" || matches!(&*extension, "pyc" | "so" | "pyd" | "dylib")
}

// the length before the bytes keeps "ab" + "c" apart from "a" + "bc"
fn update(hash: &mut Sha256, bytes: &[u8]) {
    hash.update((bytes.len() as u64).to_le_bytes());
    hash.update(bytes);
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("a/b")).unwrap();
        fs::write(folder.path().join("a/one.py"), "1").unwrap();
        fs::write(folder.path().join("a/b/two.toml"), "2").unwrap();
        folder
    }

    #[test]
    fn sha256_is_the_standard_one() {
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn contents_names_and_words_count() {
        let folder = folder();
        let before = of(folder.path(), &["a"], &["v1"]).unwrap();
        assert_eq!(before, of(folder.path(), &["a", "a/b"], &["v1"]).unwrap(), "a file counts once");
        assert_ne!(before, of(folder.path(), &["a"], &["v2"]).unwrap());

        fs::rename(folder.path().join("a/one.py"), folder.path().join("a/uno.py")).unwrap();
        let renamed = of(folder.path(), &["a"], &["v1"]).unwrap();
        assert_ne!(before, renamed);
        fs::write(folder.path().join("a/b/two.toml"), "3").unwrap();
        assert_ne!(renamed, of(folder.path(), &["a"], &["v1"]).unwrap());
    }

    #[test]
    fn made_files_do_not_count() {
        let folder = folder();
        let before = of(folder.path(), &["a"], &[]).unwrap();
        fs::create_dir(folder.path().join("a/__pycache__")).unwrap();
        fs::write(folder.path().join("a/__pycache__/one.pyc"), "x").unwrap();
        fs::write(folder.path().join("a/module.abi3.so"), "x").unwrap();
        assert_eq!(before, of(folder.path(), &["a"], &[]).unwrap());
    }

    #[test]
    fn a_stamp_holds_only_its_fingerprint() {
        let folder = folder();
        let stamp = Stamp(folder.path().join("stamp"));
        assert!(!stamp.holds("abc"));
        stamp.set("abc").unwrap();
        assert!(stamp.holds("abc") && !stamp.holds("abd"));
    }
}
