//! Files that text parameters name: found in a folder of resources or by their whole path, and read once.
//!
//! The file is opened before its kind and size are checked, and at most the limit is read, because the file may be
//! replaced or grow meanwhile.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::{ParameterError, require};

/// A text parameter that names a file.
#[derive(Clone, Copy, Debug)]
pub struct FileParameter<'a> {
    /// FMI name of the parameter.
    pub name: &'static str,
    /// Value: a file in the folder of resources, or an absolute path; a leading `file://` is removed.
    pub file: &'a str,
    /// Remedy if it is wrong.
    pub hint: &'static str,
}

impl FileParameter<'_> {
    /// Reads the file of at most `bytes_max` bytes; `resources` is the folder in which a relative path begins.
    ///
    /// # Errors
    /// When there is no such file, it is none, it is too large, or it cannot be read.
    pub fn read(&self, resources: Option<&Path>, bytes_max: u64) -> Result<Vec<u8>, ParameterError> {
        require(!self.file.is_empty(), || self.wrong("the name of a file".to_owned()))?;
        let path = self.path(resources);
        let absent = |error| self.wrong(format!("there: {error}"));
        let unreadable = |error| self.wrong(format!("readable: {error}"));
        let a_file =
            |about: &fs::Metadata| require(about.is_file(), || self.wrong("a file, not a folder or device".to_owned()));
        // opening a pipe would block until a process writes to it
        a_file(&fs::metadata(&path).map_err(absent)?)?;
        let opened = File::open(&path).map_err(absent)?;
        let about = opened.metadata().map_err(unreadable)?;
        a_file(&about)?;
        self.fits(about.len(), bytes_max)?;
        let mut bytes = Vec::new();
        opened.take(bytes_max.saturating_add(1)).read_to_end(&mut bytes).map_err(unreadable)?;
        self.fits(bytes.len() as u64, bytes_max)?;
        Ok(bytes)
    }

    /// The error with parameter, file and requirement.
    pub fn wrong(&self, limit: String) -> ParameterError {
        ParameterError { name: self.name, value: self.file.to_owned(), limit, hint: self.hint }
    }

    fn fits(&self, length: u64, bytes_max: u64) -> Result<(), ParameterError> {
        require(length <= bytes_max, || self.wrong(format!("at most `{bytes_max}` bytes long, it has `{length}`")))
    }

    fn path(&self, resources: Option<&Path>) -> PathBuf {
        let name = self.file.strip_prefix("file://").map_or(self.file, without_slash_before_drive);
        resources.map_or_else(|| name.into(), |folder| folder.join(name))
    }
}

/// `C:/a` for the path `/C:/a` of a file URI; any other path as it is.
fn without_slash_before_drive(path: &str) -> &str {
    let drive = |rest: &&str| rest.starts_with(|c: char| c.is_ascii_alphabetic()) && rest[1..].starts_with(":/");
    path.strip_prefix('/').filter(drive).unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: u64 = 1 << 20;

    fn parameter(file: &str) -> FileParameter<'_> {
        FileParameter { name: "path.file", file, hint: "write one" }
    }

    fn message(file: &str, resources: &Path) -> String {
        parameter(file).read(Some(resources), LIMIT).unwrap_err().to_string()
    }

    #[test]
    fn read_from_resources_by_a_whole_path_or_by_a_uri() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a b.json"), "text").unwrap();
        let whole = folder.path().join("a b.json");
        let whole = whole.to_str().unwrap();
        let uri = format!("file://{}{}", if whole.starts_with('/') { "" } else { "/" }, whole.replace('\\', "/"));
        for (file, resources) in [
            ("a b.json", Some(folder.path())),
            ("file://a b.json", Some(folder.path())),
            (whole, Some(Path::new("elsewhere"))),
            (whole, None),
            (uri.as_str(), Some(Path::new("elsewhere"))),
            (uri.as_str(), None),
        ] {
            assert_eq!(parameter(file).read(resources, LIMIT).unwrap(), b"text", "{file}");
        }
    }

    #[test]
    fn what_cannot_be_read_says_why() {
        let folder = tempfile::tempdir().unwrap();
        for (file, part) in
            [("", "must be the name of a file"), ("missing", "must be there: "), (".", "must be a file, not a folder")]
        {
            let message = message(file, folder.path());
            assert!(message.starts_with(&format!("parameter `path.file` is `{file}`, {part}")), "{message}");
            assert!(message.ends_with("hint: write one"), "{message}");
        }
    }

    #[test]
    fn the_limit_is_exact_and_a_giant_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = File::create(folder.path().join("giant")).unwrap();
        file.set_len(LIMIT).unwrap();
        assert_eq!(parameter("giant").read(Some(folder.path()), LIMIT).unwrap().len() as u64, LIMIT);
        file.set_len(LIMIT + 1).unwrap();
        assert!(message("giant", folder.path()).contains("at most `1048576` bytes long, it has `1048577`"));
        // far more than any memory
        file.set_len(1 << 42).unwrap();
        assert!(message("giant", folder.path()).contains("it has `4398046511104`"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_and_files_that_grow_while_they_are_read_are_rejected() {
        assert!(message("/dev/zero", Path::new("")).contains("not a folder or device"));
        // the kernel reports a length of 0 for files that it generates while they are read
        let grows = parameter("/proc/self/maps").read(None, 16).unwrap_err().to_string();
        assert!(grows.contains("at most `16` bytes long, it has `17`"), "{grows}");
    }

    #[test]
    fn the_slash_of_a_uri_is_no_part_of_a_drive() {
        for (path, expected) in
            [("/C:/a", "C:/a"), ("/c/a", "/c/a"), ("/home/a", "/home/a"), ("a", "a"), ("/ä:/", "/ä:/")]
        {
            assert_eq!(without_slash_before_drive(path), expected);
        }
    }
}
