//! A short run of the FMU, with its inputs and what must come of them: the layered standard FMI-LS-REF.

use std::ffi::{CString, c_char, c_double, c_int, c_uint, c_void};
use std::fmt::Write as _;
use std::path::Path;
use std::ptr::null;

use anyhow::{Context, Result, ensure};
use libloading::Library;

use super::markup::escaped;
use crate::interface::{Interface, Part, Quantity, Type};

/// Folder of the standard inside an FMU.
pub const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";

const MANIFEST: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiReferences xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest" fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref" fmi-ls:fmi-ls-version="1.0.0-alpha.1" fmi-ls:fmi-ls-description="Layered Standard providing information on related files included in an FMU.">
  <Related source="short-run.exp" role="experiment/smoke-test" type="application/x-ma-ls-experiments" description="A short run with moving inputs"/>
  <Related source="inputs.csv" role="other" type="text/csv" description="Inputs at the beginning of each communication step"/>
  <Related source="outputs.csv" role="result" type="text/csv" description="Outputs at the end of each communication step"/>
</fmiReferences>
"#;

/// Communication steps of the run, and the step with the first request. Each request (a Boolean that starts false, an
/// enumeration) is made for `REQUEST` steps, and the next one follows `PAUSE` steps after it.
const STEPS: usize = 100;
const EVENT: usize = 10;
const REQUEST: usize = 4;
const PAUSE: usize = 4;

/// Real outputs agree when they differ by less than this part of the largest value of their column: they are written with 9
/// significant digits, as the last ones may depend on the C library of the machine.
const TOLERANCE: f64 = 1e-8;

const CO_SIMULATION: c_int = 1;
const WARNING: c_int = 1;

/// Files of the run by their paths inside the FMU, with the parameters that the FMU starts with. Real inputs move a
/// little. One after the other, Booleans that start false are true and enumerations have their second item for some
/// steps.
///
/// # Errors
/// When the library cannot be loaded, or when the model cannot run so.
pub fn files(library: &Path, interface: &Interface, resources: &Path) -> Result<Vec<(String, String)>> {
    let run = Run::of(interface)?;
    let (inputs, outputs) = run.record(library, resources)?;
    let stop = run.step * STEPS as f64;
    let experiments = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Experiments name=\"{0}\">\n  <Experiment name=\"short run\" \
         startTime=\"0.0\" stopTime=\"{stop:?}\" stepSize=\"{1:?}\" tolerance=\"{TOLERANCE:?}\" description=\"Real inputs move a \
         little, requests follow one after the other; parameters have their start values\">\n    <Stimuli source=\"inputs.csv\" type=\"text/csv\"/>\n    \
         <References source=\"outputs.csv\" type=\"text/csv\"/>\n  </Experiment>\n</Experiments>\n",
        escaped(run.name),
        run.step
    );
    let files = [
        ("fmi-ls-manifest.xml", MANIFEST.to_owned()),
        ("short-run.exp", experiments),
        ("inputs.csv", inputs),
        ("outputs.csv", outputs),
    ];
    Ok(files.into_iter().map(|(name, text)| (format!("{FOLDER}/{name}"), text)).collect())
}

/// Model and ports of the reference run, from the model description; `step` in s.
struct Run<'a> {
    name: &'a str,
    guid: &'a str,
    step: f64,
    inputs: Vec<Port<'a>>,
    outputs: Vec<Port<'a>>,
}

/// An input or an output that is no String.
struct Port<'a> {
    name: &'a str,
    reference: c_uint,
    kind: Kind,
    start: f64,
    /// Which of the requests this input is, from 0.
    request: Option<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Real,
    /// With the number of items, where it is an enumeration.
    Integer(Option<usize>),
    Boolean,
}

impl<'a> Run<'a> {
    fn of(interface: &'a Interface) -> Result<Self> {
        let ports = |parts| interface.of(parts).filter_map(|variable| port(interface, variable)).collect::<Vec<_>>();
        let mut inputs = ports(&[Part::Input]);
        let requests = inputs.iter_mut().filter(|port| port.is_request());
        requests.enumerate().for_each(|(number, port)| port.request = Some(number));
        Ok(Self {
            name: &interface.name,
            guid: &interface.guid,
            step: interface.step.parse().with_context(|| format!("the step `{}` is no number", interface.step))?,
            inputs,
            outputs: ports(&[Part::Output]),
        })
    }

    /// Inputs and outputs of all steps, as CSV.
    fn record(&self, library: &Path, resources: &Path) -> Result<(String, String)> {
        let instance = Instance::new(library, self.guid, resources)?;
        let (mut inputs, mut outputs) = (head(&self.inputs), head(&self.outputs));
        for k in 0..STEPS {
            let time = k as f64 * self.step;
            let values: Vec<_> = self.inputs.iter().enumerate().map(|(i, port)| port.value(i, k)).collect();
            self.inputs.iter().zip(&values).try_for_each(|(port, value)| instance.set(port, *value))?;
            instance.step(time, self.step)?;
            let results = self.outputs.iter().map(|port| instance.get(port).map(|value| port.written(value)));
            let results = results.collect::<Result<Vec<_>>>()?;
            line(&mut inputs, time, &self.inputs, &values);
            line(&mut outputs, (k + 1) as f64 * self.step, &self.outputs, &results);
        }
        Ok((inputs, outputs))
    }
}

fn port<'a>(interface: &Interface, variable: &'a Quantity) -> Option<Port<'a>> {
    let kind = match &variable.kind {
        Type::Real => Kind::Real,
        Type::Boolean => Kind::Boolean,
        Type::Integer => Kind::Integer(None),
        Type::Choice(name) => {
            let choice = interface.choices.iter().find(|choice| choice.name == *name);
            Kind::Integer(choice.map(|choice| choice.items.len()))
        }
        Type::Text => return None,
    };
    let start = match variable.start.as_str() {
        "true" => 1.0,
        "false" | "" => 0.0,
        number => number.parse().ok()?,
    };
    Some(Port { name: &variable.name, reference: variable.reference, kind, start, request: None })
}

impl Port<'_> {
    /// Value of the input number `i` in the step `k`.
    fn value(&self, i: usize, k: usize) -> f64 {
        // sums and products only: they are the same on every platform
        // odd numbers move every input at every step
        let saw = (k * (2 * i + 3) % 16) as f64 / 16.0 - 0.5;
        match self.kind {
            Kind::Real => self.start + 1e-6 * saw,
            _ if !self.requested(k) => self.start,
            Kind::Boolean => 1.0,
            Kind::Integer(_) => self.start + 1.0,
        }
    }

    /// Whether the input can make a request: a Boolean that starts false, or an enumeration that has a next item.
    fn is_request(&self) -> bool {
        match self.kind {
            Kind::Real | Kind::Integer(None) => false,
            Kind::Boolean => self.start == 0.0,
            Kind::Integer(Some(items)) => self.start < items as f64,
        }
    }

    /// Whether its request is made in the step `k`.
    fn requested(&self, k: usize) -> bool {
        self.request.is_some_and(|number| {
            let begin = EVENT + number * (REQUEST + PAUSE);
            (begin..begin + REQUEST).contains(&k)
        })
    }

    /// Value of an output as it is written.
    fn written(&self, value: f64) -> f64 {
        if self.kind == Kind::Real { rounded(value) } else { value }
    }
}

fn head(ports: &[Port]) -> String {
    let mut text = "time".to_owned();
    ports.iter().for_each(|port| _ = write!(text, ",{}", port.name));
    text + "\n"
}

fn line(text: &mut String, time: f64, ports: &[Port], values: &[f64]) {
    _ = write!(text, "{time:?}");
    for (port, value) in ports.iter().zip(values) {
        _ = if port.kind == Kind::Real { write!(text, ",{value:?}") } else { write!(text, ",{value}") };
    }
    text.push('\n');
}

/// A number with 9 significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

type Get<T> = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *mut T) -> c_int;
type Set<T> = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *const T) -> c_int;

/// An instance for co-simulation that can be stepped.
struct Instance {
    component: *mut c_void,
    library: Library,
}

impl Instance {
    fn new(library: &Path, guid: &str, resources: &Path) -> Result<Self> {
        type Instantiate = unsafe extern "C" fn(
            *const c_char,
            c_int,
            *const c_char,
            *const c_char,
            *const c_void,
            c_int,
            c_int,
        ) -> *mut c_void;
        type Setup = unsafe extern "C" fn(*mut c_void, c_int, c_double, c_double, c_int, c_double) -> c_int;
        type Enter = unsafe extern "C" fn(*mut c_void) -> c_int;
        // SAFETY: the library was built a moment ago from the caller's own sources, with the functions of FMI 2.0.
        unsafe {
            let library = Library::new(library).with_context(|| format!("cannot load `{}`", library.display()))?;
            let (guid, resources) = (CString::new(guid)?, CString::new(resources.to_string_lossy().as_bytes())?);
            let instantiate = library.get::<Instantiate>(b"fmi2Instantiate\0")?;
            let name = c"reference".as_ptr();
            let component = instantiate(name, CO_SIMULATION, guid.as_ptr(), resources.as_ptr(), null(), 0, 0);
            ensure!(!component.is_null(), "`fmi2Instantiate` failed");
            let setup = library.get::<Setup>(b"fmi2SetupExperiment\0")?(component, 0, 0.0, 0.0, 0, 0.0);
            ensure!(setup <= WARNING, "`fmi2SetupExperiment` failed");
            for name in ["fmi2EnterInitializationMode", "fmi2ExitInitializationMode"] {
                ensure!(library.get::<Enter>(name.as_bytes())?(component) <= WARNING, "`{name}` failed");
            }
            Ok(Self { component, library })
        }
    }

    fn step(&self, time: f64, step: f64) -> Result<()> {
        type DoStep = unsafe extern "C" fn(*mut c_void, c_double, c_double, c_int) -> c_int;
        // SAFETY: as above, and the instance lives.
        let status = unsafe { self.library.get::<DoStep>(b"fmi2DoStep\0")?(self.component, time, step, 1) };
        ensure!(status <= WARNING, "`fmi2DoStep` failed at {time} s");
        Ok(())
    }

    fn set(&self, port: &Port, value: f64) -> Result<()> {
        let (c, reference, whole) = (self.component, &raw const port.reference, value as c_int);
        // SAFETY: as above, with one reference and one value.
        let status = unsafe {
            match port.kind {
                Kind::Real => self.library.get::<Set<c_double>>(b"fmi2SetReal\0")?(c, reference, 1, &raw const value),
                Kind::Integer(_) => {
                    self.library.get::<Set<c_int>>(b"fmi2SetInteger\0")?(c, reference, 1, &raw const whole)
                }
                Kind::Boolean => {
                    self.library.get::<Set<c_int>>(b"fmi2SetBoolean\0")?(c, reference, 1, &raw const whole)
                }
            }
        };
        ensure!(status <= WARNING, "`{}` = {value} was rejected", port.name);
        Ok(())
    }

    fn get(&self, port: &Port) -> Result<f64> {
        let (c, reference, mut value, mut whole) = (self.component, &raw const port.reference, 0.0, 0);
        // SAFETY: as above, with one reference and a place for one value.
        let status = unsafe {
            match port.kind {
                Kind::Real => self.library.get::<Get<c_double>>(b"fmi2GetReal\0")?(c, reference, 1, &raw mut value),
                Kind::Integer(_) => {
                    self.library.get::<Get<c_int>>(b"fmi2GetInteger\0")?(c, reference, 1, &raw mut whole)
                }
                Kind::Boolean => self.library.get::<Get<c_int>>(b"fmi2GetBoolean\0")?(c, reference, 1, &raw mut whole),
            }
        };
        ensure!(status <= WARNING, "`{}` cannot be read", port.name);
        Ok(if port.kind == Kind::Real { value } else { f64::from(whole) })
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        type Free = unsafe extern "C" fn(*mut c_void);
        // SAFETY: as above, and nothing uses the instance any more.
        unsafe {
            if let Ok(free) = self.library.get::<Free>(b"fmi2FreeInstance\0") {
                free(self.component);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;

    const DESCRIPTION: &str = "<fmiModelDescription modelName=\"m\" guid=\"g\"><TypeDefinitions>\
        <SimpleType name=\"Mode\"><Enumeration><Item/><Item/></Enumeration></SimpleType></TypeDefinitions>\
        <DefaultExperiment stepSize=\"1e-3\"/><ModelVariables>\
        <ScalarVariable name=\"x\" valueReference=\"0\" causality=\"input\"><Real start=\"2.0\"/></ScalarVariable>\
        <ScalarVariable name=\"on\" valueReference=\"1\" causality=\"input\"><Boolean start=\"false\"/></ScalarVariable>\
        <ScalarVariable name=\"mode\" valueReference=\"2\" causality=\"input\">\
        <Enumeration declaredType=\"Mode\" start=\"1\"/></ScalarVariable>\
        <ScalarVariable name=\"t\" valueReference=\"3\" causality=\"output\"><String start=\"\"/></ScalarVariable>\
        <ScalarVariable name=\"y\" valueReference=\"4\" causality=\"output\"><Real start=\"0.0\"/></ScalarVariable>\
        </ModelVariables></fmiModelDescription>";

    #[test]
    fn inputs_move_and_strings_are_left_out() {
        let interface = Interface::read(DESCRIPTION).unwrap();
        let run = Run::of(&interface).unwrap();
        assert_eq!((head(&run.inputs), head(&run.outputs)), ("time,x,on,mode\n".into(), "time,y\n".into()));
        let at = |k| run.inputs.iter().enumerate().map(|(i, port)| port.value(i, k)).collect::<Vec<_>>();
        assert_eq!(at(0), [2.0 - 0.5e-6, 0.0, 1.0]);
        assert_eq!(at(EVENT)[1..], [1.0, 1.0]);
        assert_eq!(at(EVENT + REQUEST)[1..], [0.0, 1.0]);
        assert_eq!(at(EVENT + REQUEST + PAUSE)[1..], [0.0, 2.0]);
        assert_eq!(at(STEPS - 1)[1..], [0.0, 1.0]);
        assert!((0..STEPS).all(|k| (at(k)[0] - 2.0).abs() < 0.6e-6 && at(k)[0] != at(k + 1)[0]));
        let mut text = String::new();
        line(&mut text, 0.1, &run.inputs, &[1e-7, 1.0, 2.0]);
        assert_eq!(text, "0.1,1e-7,1,2\n");
    }

    #[test]
    fn no_real_input_stands_still_whatever_its_index() {
        let port = Port { name: "x", reference: 0, kind: Kind::Real, start: 0.0, request: None };
        for i in 0..64 {
            assert!((0..STEPS).all(|k| port.value(i, k) != port.value(i, k + 1)), "{i}");
        }
    }

    #[test]
    fn outputs_have_nine_significant_digits() {
        assert_eq!([0.1 + 0.2, 1.0 / 3.0, -2e-7 / 3.0].map(rounded), [0.3, 0.333333333, -6.66666667e-8]);
        assert!([1.0 / 3.0, 1e300 / 7.0].iter().all(|value| (rounded(*value) / value - 1.0).abs() < TOLERANCE));
    }

    #[test]
    fn every_role_is_one_of_the_standard_and_every_file_has_one() {
        let document = Document::parse(MANIFEST).unwrap();
        let related: Vec<_> = document.descendants().filter(|node| node.has_tag_name("Related")).collect();
        let values = |name| related.iter().map(|node| node.attribute(name).unwrap()).collect::<Vec<_>>();
        assert_eq!(values("source"), ["short-run.exp", "inputs.csv", "outputs.csv"]);
        assert_eq!(values("role"), ["experiment/smoke-test", "other", "result"]);
    }

    #[test]
    fn what_is_no_library_is_told() {
        let interface = Interface::read(DESCRIPTION).unwrap();
        let error = files(Path::new("/no/such/library"), &interface, Path::new("")).unwrap_err().to_string();
        assert_eq!(error, "cannot load `/no/such/library`");
    }
}
