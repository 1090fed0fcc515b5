//! Files that text parameters name: found in the FMU's resources or by their whole path, and read once.

use std::fs;
use std::path::{Path, PathBuf};

use control_blocks::{ParameterError, require};

/// Largest file that is read, bytes.
const BYTES_MAX: u64 = 64 << 20;

/// A text parameter that names a file.
#[derive(Clone, Copy, Debug)]
pub struct FileParameter<'a> {
    /// FMI name of the parameter.
    pub name: &'static str,
    /// Its value: a file in the folder `resources`, or a whole path.
    pub file: &'a str,
    /// What to do when it is wrong.
    pub hint: &'static str,
}

impl FileParameter<'_> {
    /// Reads the file; `resources` is the folder of that name in the FMU.
    ///
    /// # Errors
    /// When there is no such file, it is no file, or it is too large.
    pub fn read(&self, resources: Option<&Path>) -> Result<Vec<u8>, ParameterError> {
        require(!self.file.is_empty(), || self.wrong("the name of a file".to_owned()))?;
        let path = self.path(resources);
        let about = fs::metadata(&path).map_err(|error| self.wrong(format!("there: {error}")))?;
        require(about.is_file(), || self.wrong("a file, not a folder or device".to_owned()))?;
        require(about.len() <= BYTES_MAX, || {
            self.wrong(format!("at most `{BYTES_MAX}` bytes long, it has `{}`", about.len()))
        })?;
        fs::read(&path).map_err(|error| self.wrong(format!("readable: {error}")))
    }

    /// The error that says what the file must be.
    pub fn wrong(&self, limit: String) -> ParameterError {
        ParameterError { name: self.name, value: self.file.to_owned(), limit, hint: self.hint }
    }

    fn path(&self, resources: Option<&Path>) -> PathBuf {
        match resources {
            Some(folder) => folder.join(self.file),
            None => self.file.into(),
        }
    }
}

/// A place for the files of tests, empty again when it is dropped.
#[cfg(test)]
pub(crate) mod place {
    use std::path::{Path, PathBuf};
    use std::sync::atomic::{AtomicU32, Ordering};

    pub(crate) struct Place(PathBuf);

    impl Place {
        pub(crate) fn new() -> Self {
            static NEXT: AtomicU32 = AtomicU32::new(0);
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let folder = std::env::temp_dir().join(format!("fmu-deburr-{}-{number}", std::process::id()));
            std::fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        pub(crate) fn path(&self) -> &Path {
            &self.0
        }
    }

    impl Drop for Place {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use place::Place;

    fn parameter(file: &str) -> FileParameter<'_> {
        FileParameter { name: "path.file", file, hint: "write one" }
    }

    #[test]
    fn read_from_resources_or_from_a_whole_path() {
        let place = Place::new();
        let whole = place.path().join("a.json");
        fs::write(&whole, "text").unwrap();
        let whole = whole.to_str().unwrap();
        for (file, resources) in [("a.json", Some(place.path())), (whole, Some(Path::new("elsewhere"))), (whole, None)]
        {
            assert_eq!(parameter(file).read(resources).unwrap(), b"text");
        }
    }

    #[test]
    fn what_cannot_be_read_says_why() {
        let place = Place::new();
        let giant = fs::File::create(place.path().join("giant")).unwrap();
        giant.set_len(BYTES_MAX + 1).unwrap();
        let cases = [
            ("", "the name of a file"),
            ("missing", "No such file"),
            (".", "not a folder"),
            ("giant", "bytes long, it has"),
        ];
        for (file, part) in cases {
            let message = parameter(file).read(Some(place.path())).unwrap_err().to_string();
            assert!(message.starts_with("parameter `path.file` is `") && message.contains(part), "{message}");
            assert!(message.contains("hint: write one"), "{message}");
        }
    }
}
