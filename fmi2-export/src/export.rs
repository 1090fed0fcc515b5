//! What a shared library offers: its files and its instances.

use crate::check;
use crate::documentation;
use crate::hash::GUID;
use crate::instance::Instance;
use crate::logger::Logger;
use crate::model::Model;
use crate::model_description::{self, elements};
use crate::slave::Slave;
use crate::variable::{Kind, Role, Variable};
use std::ffi::{CStr, CString};
use std::marker::PhantomData;
use std::path::PathBuf;
use std::sync::OnceLock;

/// Everything the C API needs to know of a model, whatever its type.
pub trait Factory: Sync {
    /// GUID of the model description.
    fn guid(&self) -> &str;
    /// Text of a generated file of the FMU; `""` lists their paths, one per line.
    fn file(&self, path: &str) -> Option<&CStr>;
    /// A new instance with all variables at their start values.
    fn instantiate(&'static self, resources: Option<PathBuf>, logger: Logger) -> Box<dyn Slave>;
}

/// The export of one model; made once by [`export!`](crate::export).
pub struct Export<M: Model> {
    /// Kept inline: what a library has allocated for itself is lost when it is unloaded.
    guid: OnceLock<[u8; GUID]>,
    /// Made only for packers; importers never ask for it.
    files: OnceLock<Files>,
    model: PhantomData<fn() -> M>,
}

/// The generated files by their paths, and the list of the paths.
struct Files {
    texts: [(&'static str, CString); 2],
    list: CString,
}

/// Rows and elements behind the value references.
pub struct Index<V: 'static> {
    /// Row and element of each value reference.
    pub entries: Vec<(&'static Variable<V>, usize)>,
    /// Those of the Reals that the model writes.
    pub computed: Vec<(&'static Variable<V>, usize)>,
}

impl<M: Model> Default for Export<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: Model> Export<M> {
    /// Checks the model's table and facts; in a `static`, a wrong one does not compile.
    pub const fn new() -> Self {
        check::table(M::VARIABLES);
        check::info(&M::INFO);
        Self { guid: OnceLock::new(), files: OnceLock::new(), model: PhantomData }
    }

    fn files(&self) -> &Files {
        self.files.get_or_init(|| {
            let texts = [
                ("modelDescription.xml", c_string(model_description::write::<M>().0)),
                ("documentation/index.html", c_string(documentation::write::<M>())),
            ];
            let list = c_string(texts.each_ref().map(|(path, _)| *path).join("\n"));
            Files { texts, list }
        })
    }
}

impl<M: Model> Factory for Export<M> {
    fn guid(&self) -> &str {
        let guid = self.guid.get_or_init(|| {
            let (_, guid) = model_description::write::<M>();
            guid.into_bytes().try_into().expect("a GUID has 36 characters")
        });
        std::str::from_utf8(guid).expect("a GUID is hexadecimal")
    }

    fn file(&self, path: &str) -> Option<&CStr> {
        let files = self.files();
        if path.is_empty() {
            return Some(&files.list);
        }
        files.texts.iter().find(|(name, _)| *name == path).map(|(_, text)| text.as_c_str())
    }

    fn instantiate(&'static self, resources: Option<PathBuf>, logger: Logger) -> Box<dyn Slave> {
        Box::new(Instance::new(self, resources, logger))
    }
}

impl<V> Index<V> {
    pub fn new(table: &'static [Variable<V>]) -> Self {
        let computed = |row: &Variable<V>| {
            matches!(row.kind, Kind::Real { .. }) && matches!(row.role(), Role::Output | Role::Local | Role::Calculated)
        };
        let entries: Vec<_> = elements(table).collect();
        let computed = entries.iter().copied().filter(|(row, _)| computed(row)).collect();
        Self { entries, computed }
    }
}

/// A C string without the NUL bytes that `text` may hold.
pub(crate) fn c_string(text: impl Into<String>) -> CString {
    let mut bytes = text.into().into_bytes();
    bytes.retain(|byte| *byte != 0);
    CString::new(bytes).unwrap_or_default()
}

/// Exports a [`Model`](crate::Model) from this library as an FMI 2.0 co-simulation FMU.
///
/// One library holds one model. A wrong table does not compile:
///
/// ```compile_fail
/// # use fmi2_export::*;
/// # #[derive(Clone, serde::Serialize, serde::Deserialize)] struct Vars { kp: f64 }
/// # impl Start for Vars { const START: Self = Self { kp: 3.0 }; }
/// struct Wrong;
/// impl Model for Wrong {
///     const INFO: Info = Info { name: "Wrong", identifier: "wrong", description: "x", ..Info::DEFAULT };
///     const VARIABLES: &'static [Variable<Vars>] =
///         &[real!(Vars => kp).parameter().range(0.0, 1.0).describe("starts outside its range")];
///     # type Vars = Vars; type State = ();
///     # fn period(_: &Vars) -> f64 { 1.0 }
///     # fn initialise(_: &mut Vars, _: &mut Env) -> Result<(), Error> { Ok(()) }
///     # fn tick(_: &mut Vars, _: &mut (), _: &mut Env) -> Result<(), Error> { Ok(()) }
/// }
/// export!(Wrong);
/// # fn main() {}
/// ```
#[macro_export]
macro_rules! export {
    ($model:ty) => {
        const _: () = {
            static EXPORT: $crate::Export<$model> = $crate::Export::new();

            #[unsafe(no_mangle)]
            extern "Rust" fn fmi2_export_factory() -> &'static dyn $crate::Factory {
                &EXPORT
            }
        };
    };
}
