//! Writes a file completely or not at all.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes under another name and renames; an older file stays until the new one is complete.
///
/// # Errors
/// If `path` is a folder or a device, or has no file name, or if the operating system cannot write the file. The
/// partial file is removed.
pub fn save(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if fs::metadata(path).is_ok_and(|about| !about.is_file()) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "there is a folder or device of this name"));
    }
    let partial = neighbor(path)?;
    let written = write(&partial, bytes).and_then(|()| fs::rename(&partial, path));
    if written.is_err() {
        let _ = fs::remove_file(&partial);
    }
    written
}

fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Name of the unfinished file; of this process alone.
fn neighbor(path: &Path) -> io::Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "no name of a file"))?;
    let mut name = name.to_owned();
    name.push(format!(".{}.partial", std::process::id()));
    Ok(path.with_file_name(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &tempfile::TempDir) -> Vec<String> {
        let entries = fs::read_dir(folder.path()).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_written_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("bank.bin");
        for text in ["one", "another"] {
            save(&file, text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&file).unwrap(), text);
        }
        assert_eq!(names(&folder), ["bank.bin"]);
    }

    #[test]
    fn what_cannot_be_written_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        assert!(save(&folder.path().join("missing").join("bank.bin"), b"x").is_err());
        assert!(save(Path::new("/"), b"x").is_err());
        assert!(save(Path::new("/dev/full"), b"x").unwrap_err().to_string().contains("device"));
        // a folder is in the way
        fs::create_dir(folder.path().join("folder")).unwrap();
        fs::write(folder.path().join("folder").join("inside"), "kept").unwrap();
        assert!(save(&folder.path().join("folder"), b"x").is_err());
        assert_eq!(names(&folder), ["folder"]);
    }
}
