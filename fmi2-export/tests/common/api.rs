//! The C types of FMI 2.0 and a loaded library with its 44 functions, written from the standard's
//! headers and not from the sources of this crate.

use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

pub type Status = c_int;
pub const OK: Status = 0;
pub const WARNING: Status = 1;
pub const DISCARD: Status = 2;
pub const ERROR: Status = 3;

pub const MODEL_EXCHANGE: c_int = 0;
pub const CO_SIMULATION: c_int = 1;
pub const DO_STEP_STATUS: c_int = 0;
pub const PENDING_STATUS: c_int = 1;
pub const LAST_SUCCESSFUL_TIME: c_int = 2;
pub const TERMINATED: c_int = 3;

pub type Component = *mut c_void;
pub type State = *mut c_void;
pub type Text = *const c_char;

/// The logger is variadic in C; the FMU sends ready texts, so that five arguments always arrive.
pub type LoggerFunction = unsafe extern "C" fn(*mut c_void, Text, Status, Text, Text);

#[repr(C)]
pub struct Callbacks {
    pub logger: Option<LoggerFunction>,
    pub allocate: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    pub free: Option<unsafe extern "C" fn(*mut c_void)>,
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    pub environment: *mut c_void,
}

/// Result of `fmi2NewDiscreteStates`: `fmi2EventInfo`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventInfo {
    pub new_discrete_states_needed: c_int,
    pub terminate_simulation: c_int,
    pub nominals_changed: c_int,
    pub values_changed: c_int,
    pub next_event_time_defined: c_int,
    pub next_event_time: f64,
}

macro_rules! api {
    ($($field:ident $symbol:ident($($argument:ty),*) $(-> $result:ty)?;)+) => {
        /// A loaded FMU: all its functions by pointer.
        #[allow(non_snake_case)]
        pub struct Fmu {
            $(pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)+
            export_file: unsafe extern "C" fn(Text) -> Text,
            pub guid: CString,
            pub description: String,
            /// Unloads the functions when it is dropped, so it stays with them.
            _library: Library,
        }

        impl Fmu {
            /// Names of the functions of the C API.
            pub const FUNCTIONS: &[&str] = &[$(stringify!($symbol)),+];

            /// Loads a library and looks up every function.
            pub fn load(path: &Path) -> Self {
                let mut fmu = Self::load_described(path, String::new());
                fmu.description = fmu.file("modelDescription.xml").expect("an FMU describes itself");
                fmu.guid = guid(&fmu.description);
                fmu
            }

            /// The same for a library whose description is known, as it is to an importer: the library is not asked.
            pub fn load_described(path: &Path, description: String) -> Self {
                // SAFETY: the library is an FMU built by cargo; the types are those of the headers.
                unsafe {
                    let library = Library::new(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                    Self {
                        $($field: *library.get(concat!(stringify!($symbol), "\0").as_bytes()).unwrap(),)+
                        export_file: *library.get(b"fmi2_export_file\0").unwrap(),
                        guid: guid(&description),
                        description,
                        _library: library,
                    }
                }
            }
        }
    };
}

api! {
    get_types_platform fmi2GetTypesPlatform() -> Text;
    get_version fmi2GetVersion() -> Text;
    set_debug_logging fmi2SetDebugLogging(Component, c_int, usize, *const Text) -> Status;
    instantiate fmi2Instantiate(Text, c_int, Text, Text, *const Callbacks, c_int, c_int) -> Component;
    free_instance fmi2FreeInstance(Component);
    setup_experiment fmi2SetupExperiment(Component, c_int, f64, f64, c_int, f64) -> Status;
    enter_initialization_mode fmi2EnterInitializationMode(Component) -> Status;
    exit_initialization_mode fmi2ExitInitializationMode(Component) -> Status;
    terminate fmi2Terminate(Component) -> Status;
    reset fmi2Reset(Component) -> Status;
    get_real fmi2GetReal(Component, *const c_uint, usize, *mut f64) -> Status;
    get_integer fmi2GetInteger(Component, *const c_uint, usize, *mut c_int) -> Status;
    get_boolean fmi2GetBoolean(Component, *const c_uint, usize, *mut c_int) -> Status;
    get_string fmi2GetString(Component, *const c_uint, usize, *mut Text) -> Status;
    set_real fmi2SetReal(Component, *const c_uint, usize, *const f64) -> Status;
    set_integer fmi2SetInteger(Component, *const c_uint, usize, *const c_int) -> Status;
    set_boolean fmi2SetBoolean(Component, *const c_uint, usize, *const c_int) -> Status;
    set_string fmi2SetString(Component, *const c_uint, usize, *const Text) -> Status;
    get_fmu_state fmi2GetFMUstate(Component, *mut State) -> Status;
    set_fmu_state fmi2SetFMUstate(Component, State) -> Status;
    free_fmu_state fmi2FreeFMUstate(Component, *mut State) -> Status;
    serialized_size fmi2SerializedFMUstateSize(Component, State, *mut usize) -> Status;
    serialize fmi2SerializeFMUstate(Component, State, *mut c_char, usize) -> Status;
    deserialize fmi2DeSerializeFMUstate(Component, *const c_char, usize, *mut State) -> Status;
    get_directional_derivative fmi2GetDirectionalDerivative(Component, *const c_uint, usize, *const c_uint, usize, *const f64, *mut f64) -> Status;
    set_input_derivatives fmi2SetRealInputDerivatives(Component, *const c_uint, usize, *const c_int, *const f64) -> Status;
    get_output_derivatives fmi2GetRealOutputDerivatives(Component, *const c_uint, usize, *const c_int, *mut f64) -> Status;
    do_step fmi2DoStep(Component, f64, f64, c_int) -> Status;
    cancel_step fmi2CancelStep(Component) -> Status;
    get_status fmi2GetStatus(Component, c_int, *mut Status) -> Status;
    get_real_status fmi2GetRealStatus(Component, c_int, *mut f64) -> Status;
    get_integer_status fmi2GetIntegerStatus(Component, c_int, *mut c_int) -> Status;
    get_boolean_status fmi2GetBooleanStatus(Component, c_int, *mut c_int) -> Status;
    get_string_status fmi2GetStringStatus(Component, c_int, *mut Text) -> Status;
    enter_event_mode fmi2EnterEventMode(Component) -> Status;
    new_discrete_states fmi2NewDiscreteStates(Component, *mut EventInfo) -> Status;
    enter_continuous_time_mode fmi2EnterContinuousTimeMode(Component) -> Status;
    completed_integrator_step fmi2CompletedIntegratorStep(Component, c_int, *mut c_int, *mut c_int) -> Status;
    set_time fmi2SetTime(Component, f64) -> Status;
    set_continuous_states fmi2SetContinuousStates(Component, *const f64, usize) -> Status;
    get_derivatives fmi2GetDerivatives(Component, *mut f64, usize) -> Status;
    get_event_indicators fmi2GetEventIndicators(Component, *mut f64, usize) -> Status;
    get_continuous_states fmi2GetContinuousStates(Component, *mut f64, usize) -> Status;
    get_nominals fmi2GetNominalsOfContinuousStates(Component, *mut f64, usize) -> Status;
}

impl Fmu {
    /// The FMU with a variable of every kind and every failure.
    pub fn probe() -> Self {
        Self::load(&example("probe"))
    }

    /// A generated file of the FMU, or `None`.
    pub fn file(&self, path: &str) -> Option<String> {
        let path = CString::new(path).unwrap();
        // SAFETY: the answer is NULL or a C string that lives as long as the library.
        unsafe {
            let text = (self.export_file)(path.as_ptr());
            (!text.is_null()).then(|| CStr::from_ptr(text).to_str().unwrap().to_owned())
        }
    }

    /// Value reference of a variable, read from the model description.
    pub fn reference(&self, name: &str) -> u32 {
        let head = format!("<ScalarVariable name=\"{name}\" valueReference=\"");
        between(&self.description, &head, "\"").parse().unwrap()
    }

    /// Number of value references.
    pub fn count(&self) -> u32 {
        self.description.matches("<ScalarVariable ").count() as u32
    }
}

fn guid(description: &str) -> CString {
    let guid = description.split_once("guid=\"").map_or("", |(_, tail)| between(tail, "", "\""));
    CString::new(guid).unwrap()
}

/// The text between the first `start` and the next `end`.
pub fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let (_, tail) = text.split_once(start).unwrap_or_else(|| panic!("no `{start}`"));
    tail.split_once(end).unwrap().0
}

/// The C library that cargo built from an example, next to this test.
pub fn example(name: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let profile = test.ancestors().nth(2).unwrap();
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = profile.join("examples").join(format!("{prefix}{name}{suffix}"));
    let built = changed(&library);
    let folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let package = folders.into_iter().find(|folder| folder.join("src/c_api").is_dir()).unwrap();
    let example = package.join(format!("examples/{name}.rs"));
    let newest = files(&package.join("src")).iter().chain([&example]).filter_map(|file| changed(file)).max();
    assert!(
        built >= newest,
        "`{}` is missing or older than its sources\nhint: `cargo test --test` builds no examples; run `cargo test -p \
         fmi2-export` or `cargo build -p fmi2-export --examples`",
        library.display()
    );
    library
}

/// All files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let inside = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    inside.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

fn changed(file: &Path) -> Option<SystemTime> {
    std::fs::metadata(file).ok()?.modified().ok()
}
