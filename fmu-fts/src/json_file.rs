//! Tables in JSON files, read once at initialization from the FMU's resources or from a path of the user's.

use std::fs;
use std::path::Path;

use control_blocks::{ParameterError, require};
use serde::de::DeserializeOwned;

/// Largest file that is read, bytes.
const BYTES_MAX: u64 = 16 << 20;

/// A text parameter that names a file.
#[derive(Clone, Copy, Debug)]
pub struct FileParameter<'a> {
    /// FMI name of the parameter.
    pub name: &'static str,
    /// Its value: a file in the folder `resources`, or a whole path.
    pub file: &'a str,
    /// What the file holds, in a few words.
    pub content: &'static str,
    /// How the file is written.
    pub hint: &'static str,
}

impl FileParameter<'_> {
    /// Reads the file; `resources` is the folder of that name in the FMU.
    ///
    /// # Errors
    /// When there is no such file, it is too large, or it is not JSON of this type: with line and column.
    pub fn read<T: DeserializeOwned>(&self, resources: Option<&Path>) -> Result<T, ParameterError> {
        self.require(!self.file.is_empty(), || "the name of a file".to_owned())?;
        let path = match resources {
            Some(folder) => folder.join(self.file),
            None => self.file.into(),
        };
        let about = fs::metadata(&path).map_err(|error| self.wrong(format!("there: {error}")))?;
        self.require(about.is_file(), || "a file, not a folder or device".to_owned())?;
        self.require(about.len() <= BYTES_MAX, || {
            format!("at most `{BYTES_MAX}` bytes long, it has `{}`", about.len())
        })?;
        let bytes = fs::read(&path).map_err(|error| self.wrong(format!("readable: {error}")))?;
        serde_json::from_slice(&bytes).map_err(|error| self.wrong(format!("{}: {error}", self.content)))
    }

    /// Nothing if the condition holds; if not, the error that says what the file must be.
    ///
    /// # Errors
    /// The error.
    pub fn require(&self, holds: bool, limit: impl FnOnce() -> String) -> Result<(), ParameterError> {
        require(holds, || self.wrong(limit()))
    }

    /// The error that names the field, its value and the limit.
    pub fn wrong(&self, limit: String) -> ParameterError {
        ParameterError { name: self.name, value: self.file.to_owned(), limit, hint: self.hint }
    }

    /// Checks that `value` of the field `field` lies in `low` to `high`.
    ///
    /// # Errors
    /// Names field, value and limits.
    pub fn within(
        &self,
        field: impl FnOnce() -> String,
        value: f64,
        low: f64,
        high: f64,
    ) -> Result<(), ParameterError> {
        self.require(value >= low && value <= high, || {
            format!("{}: `{}` is `{value}`, limits `{low}` to `{high}`", self.content, field())
        })
    }

    /// Checks that the field `field` has `count` entries.
    ///
    /// # Errors
    /// Names field, its number of entries and the right one.
    pub fn count(&self, field: impl FnOnce() -> String, found: usize, count: usize) -> Result<(), ParameterError> {
        self.require(found == count, || {
            format!("{}: `{}` has `{found}` entries, must have `{count}`", self.content, field())
        })
    }
}

/// A place for the files of tests, empty again when it is dropped.
#[cfg(test)]
pub(crate) mod place {
    use std::path::{Path, PathBuf};
    use std::sync::atomic::{AtomicU32, Ordering};

    pub(crate) struct Place(PathBuf);

    impl Place {
        pub(crate) fn with(file: &str, text: &str) -> Self {
            static NEXT: AtomicU32 = AtomicU32::new(0);
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let folder = std::env::temp_dir().join(format!("fmu-fts-{}-{number}", std::process::id()));
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(folder.join(file), text).unwrap();
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
        FileParameter { name: "path.file", file, content: "three numbers", hint: "write three numbers" }
    }

    fn message(file: &str, resources: Option<&Path>) -> String {
        parameter(file).read::<[f64; 3]>(resources).unwrap_err().to_string()
    }

    #[test]
    fn read_from_resources_or_from_a_whole_path() {
        let place = Place::with("table.json", "[1, 2.5, -3e2]");
        let whole = place.path().join("table.json");
        for (file, resources) in [
            ("table.json", Some(place.path())),
            (whole.to_str().unwrap(), Some(Path::new("elsewhere"))),
            (whole.to_str().unwrap(), None),
        ] {
            assert_eq!(parameter(file).read::<[f64; 3]>(resources), Ok([1.0, 2.5, -300.0]));
        }
    }

    #[test]
    fn what_cannot_be_read_says_why() {
        let place = Place::with("table.json", "[1,\n 2, \"x\"]");
        let cases = [
            (message("", Some(place.path())), "must be the name of a file"),
            (message("missing.json", Some(place.path())), "No such file"),
            (message(".", Some(place.path())), "not a folder"),
            (
                message("table.json", Some(place.path())),
                "must be three numbers: invalid type: string \"x\", expected f64 at line 2 column 7",
            ),
        ];
        for (message, part) in cases {
            assert!(message.starts_with("parameter `path.file` is `"), "{message}");
            assert!(message.contains(part) && message.contains("hint: write three numbers"), "{message}");
        }
    }

    #[test]
    fn a_device_or_a_giant_file_is_refused_before_it_is_read() {
        if Path::new("/dev/zero").exists() {
            assert!(message("/dev/zero", None).contains("not a folder or device"));
        }
        let place = Place::with("table.json", "");
        let giant = std::fs::OpenOptions::new().write(true).open(place.path().join("table.json")).unwrap();
        giant.set_len(BYTES_MAX + 1).unwrap();
        assert!(message("table.json", Some(place.path())).contains("at most `16777216` bytes long, it has `16777217`"));
    }

    #[test]
    fn numbers_that_json_does_not_have_are_refused() {
        for text in
            ["[1, 2, NaN]", "[1, 2, 1e999]", "[1, 2]", "[1, 2, 3, 4]", "[1, 2, 3] 4", "", "[1, 2, null]", "\u{0}"]
        {
            let place = Place::with("table.json", text);
            let message = message("table.json", Some(place.path()));
            assert!(message.contains("must be three numbers: ") && message.contains(" at line 1 column"), "{message}");
        }
    }
}
