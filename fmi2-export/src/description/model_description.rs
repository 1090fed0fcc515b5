//! `modelDescription.xml` from the variable table (FMI 2.0.5, chapter 2.2, in schema order).

use crate::description::xml::{Writer, real};
use crate::exported::Exported;
use crate::host::logger::Category;
use crate::instance::start_period;
use crate::model::{Info, Interface};
use crate::table::enumeration::EnumType;
use crate::table::units::{self, Unit};
use crate::table::variable::{Kind, Role, Variable};

/// The document.
pub fn write<M: Exported>() -> String {
    let mut xml = Writer::new("<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
    head(&mut xml, &M::INFO, M::guid());
    capabilities(&mut xml, &M::INFO);
    unit_definitions(&mut xml, M::Vars::TABLE);
    type_definitions(&mut xml, M::Vars::TABLE);
    log_categories(&mut xml);
    default_experiment(&mut xml, &M::INFO, start_period::<M>());
    variables(&mut xml, M::Vars::TABLE);
    structure(&mut xml, M::Vars::TABLE);
    xml.finish()
}

fn head(xml: &mut Writer, info: &Info, guid: &str) {
    let attributes = [
        ("fmiVersion", "2.0"),
        ("modelName", info.name),
        ("guid", guid),
        ("description", info.description),
        ("author", info.author),
        ("version", info.version),
        ("copyright", info.copyright),
        ("license", info.license),
        ("generationTool", concat!("fmi2-export ", env!("CARGO_PKG_VERSION"))),
        ("variableNamingConvention", "structured"),
        ("numberOfEventIndicators", "0"),
    ];
    xml.open("fmiModelDescription", &attributes.into_iter().filter(|(_, text)| !text.is_empty()).collect::<Vec<_>>());
}

fn capabilities(xml: &mut Writer, info: &Info) {
    xml.empty(
        "ModelExchange",
        &[
            ("modelIdentifier", info.identifier),
            ("needsExecutionTool", "false"),
            ("completedIntegratorStepNotNeeded", "true"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
            ("providesDirectionalDerivative", "false"),
        ],
    );
    xml.empty(
        "CoSimulation",
        &[
            ("modelIdentifier", info.identifier),
            ("needsExecutionTool", "false"),
            ("canHandleVariableCommunicationStepSize", "true"),
            ("canInterpolateInputs", "true"),
            ("maxOutputDerivativeOrder", "0"),
            ("canRunAsynchronuously", "false"),
            ("canBeInstantiatedOnlyOncePerProcess", "false"),
            ("canNotUseMemoryManagementFunctions", "true"),
            ("canGetAndSetFMUstate", "true"),
            ("canSerializeFMUstate", "true"),
            ("providesDirectionalDerivative", "false"),
        ],
    );
}

fn unit_definitions<V>(xml: &mut Writer, table: &[Variable<V>]) {
    definitions(xml, "UnitDefinitions", used_units(table), |xml, unit| {
        xml.open("Unit", &[("name", unit.name)]);
        base_unit(xml, unit);
        for display in unit.display {
            xml.empty("DisplayUnit", &[("name", display.name), ("factor", &real(display.factor))]);
        }
        xml.close();
    });
}

/// A list of definitions; nothing where there are none.
fn definitions<T>(xml: &mut Writer, list: &'static str, items: Vec<T>, define: impl Fn(&mut Writer, T)) {
    if items.is_empty() {
        return;
    }
    xml.open(list, &[]);
    items.into_iter().for_each(|item| define(xml, item));
    xml.close();
}

fn base_unit(xml: &mut Writer, unit: &Unit) {
    let exponents: Vec<_> = units::BASE.iter().zip(unit.base).filter(|(_, exponent)| *exponent != 0).collect();
    let mut attributes: Vec<(&str, String)> = exponents.iter().map(|(name, e)| (**name, e.to_string())).collect();
    if unit.factor != 1.0 {
        attributes.push(("factor", real(unit.factor)));
    }
    if unit.offset != 0.0 {
        attributes.push(("offset", real(unit.offset)));
    }
    xml.empty("BaseUnit", &borrowed(&attributes));
}

fn type_definitions<V>(xml: &mut Writer, table: &[Variable<V>]) {
    definitions(xml, "TypeDefinitions", used_types(table), |xml, ty| {
        xml.open("SimpleType", &[("name", ty.name), ("description", ty.description)]);
        xml.open("Enumeration", &[]);
        for (i, item) in ty.items.iter().enumerate() {
            let number = (i + 1).to_string();
            xml.empty("Item", &[("name", item.name), ("value", &number), ("description", item.description)]);
        }
        xml.close();
        xml.close();
    });
}

fn log_categories(xml: &mut Writer) {
    xml.open("LogCategories", &[]);
    for category in Category::ALL {
        xml.empty("Category", &[("name", category.name()), ("description", category.description())]);
    }
    xml.close();
}

fn default_experiment(xml: &mut Writer, info: &Info, step_size: f64) {
    xml.empty(
        "DefaultExperiment",
        &[
            ("startTime", "0.0"),
            ("stopTime", &real(stop_time(info, step_size))),
            ("tolerance", "1e-6"),
            ("stepSize", &real(step_size)),
        ],
    );
}

/// Number of steps from which on FMPy simulates with a multiple of `stepSize`.
const STEPS_MAX: f64 = 1000.0;

/// The suggested stop time.
fn stop_time(info: &Info, step_size: f64) -> f64 {
    if info.stop_time > 0.0 {
        return info.stop_time;
    }
    let mut stop = STEPS_MAX * step_size;
    while stop / step_size > STEPS_MAX {
        stop = stop.next_down();
    }
    stop
}

fn variables<V>(xml: &mut Writer, table: &[Variable<V>]) {
    xml.open("ModelVariables", &[]);
    for (reference, (row, element)) in elements(table).enumerate() {
        let (causality, variability, initial) = attributes_of(row);
        let (name, reference) = (row.element_name(element), reference.to_string());
        let mut attributes = vec![("name", name.as_str()), ("valueReference", &reference)];
        attributes.extend([("description", row.description), ("causality", causality), ("variability", variability)]);
        attributes.extend(initial.map(|initial| ("initial", initial)));
        xml.open("ScalarVariable", &attributes);
        xml.empty(row.kind.type_name(), &borrowed(&type_attributes(row, element)));
        xml.close();
    }
    xml.close();
}

/// Causality, variability and initial of a row.
fn attributes_of<V>(row: &Variable<V>) -> (&'static str, &'static str, Option<&'static str>) {
    let is_real = matches!(row.kind, Kind::Real { .. });
    match row.role() {
        // discrete Real inputs make FMPy's `simulate_fmu(input=...)` quadratic in their samples
        Role::Input => ("input", if is_real { "continuous" } else { "discrete" }, None),
        Role::Output => ("output", "discrete", Some("exact")),
        Role::Local => ("local", "discrete", Some("exact")),
        Role::Parameter => ("parameter", "fixed", Some("exact")),
        Role::Tunable => ("parameter", "tunable", Some("exact")),
        Role::Calculated => ("calculatedParameter", "tunable", Some("calculated")),
    }
}

fn type_attributes<V>(row: &Variable<V>, element: usize) -> Vec<(&'static str, String)> {
    let mut attributes = Vec::new();
    let start = match &row.kind {
        Kind::Real { start, real: info, .. } => {
            attributes.extend(info.unit.map(|unit| ("unit", unit.name.to_owned())));
            attributes.extend(info.display.map(|name| ("displayUnit", name.to_owned())));
            let limits = [("min", info.min), ("max", info.max)];
            attributes.extend(limits.into_iter().filter(|(_, x)| x.is_finite()).map(|(key, x)| (key, real(x))));
            if info.nominal != 1.0 {
                attributes.push(("nominal", real(info.nominal)));
            }
            real(start[element])
        }
        Kind::Integer { start, min, max, .. } => {
            attributes.extend((*min > i32::MIN).then(|| ("min", min.to_string())));
            attributes.extend((*max < i32::MAX).then(|| ("max", max.to_string())));
            start[element].to_string()
        }
        Kind::Boolean { start, .. } => start[element].to_string(),
        Kind::Text { start, .. } => (*start).to_owned(),
        Kind::Choice { start, ty, .. } => {
            attributes.push(("declaredType", ty.name.to_owned()));
            start.to_string()
        }
    };
    if row.role() != Role::Calculated {
        attributes.push(("start", start));
    }
    attributes
}

fn structure<V>(xml: &mut Writer, table: &[Variable<V>]) {
    let indices = |role| {
        let all = elements(table).enumerate();
        all.filter(move |(_, (row, _))| row.role() == role).map(|(i, _)| (i + 1).to_string())
    };
    xml.open("ModelStructure", &[]);
    if indices(Role::Output).next().is_some() {
        xml.open("Outputs", &[]);
        // no direct feedthrough: at a communication point outputs follow from the samples before it, in event mode what a
        // sample writes belongs to the next super-dense instant, and between events nothing is computed
        indices(Role::Output).for_each(|index| xml.empty("Unknown", &[("index", &index), ("dependencies", "")]));
        xml.close();
    }
    if indices(Role::Calculated).next().is_some() {
        xml.open("InitialUnknowns", &[]);
        indices(Role::Calculated).for_each(|index| xml.empty("Unknown", &[("index", &index)]));
        xml.close();
    }
    xml.close();
}

/// All rows with their elements in the order of their value references.
fn elements<V>(table: &[Variable<V>]) -> impl Iterator<Item = (&Variable<V>, usize)> {
    table.iter().flat_map(|row| (0..row.len()).map(move |element| (row, element)))
}

fn used_units<V>(table: &[Variable<V>]) -> Vec<&'static Unit> {
    let mut used: Vec<&'static Unit> = Vec::new();
    for row in table {
        if let Kind::Real { real: info, .. } = &row.kind
            && let Some(unit) = info.unit
            && !used.iter().any(|known| known.name == unit.name)
        {
            used.push(unit);
        }
    }
    used
}

/// Enumeration types of a table, each once.
pub fn used_types<V>(table: &[Variable<V>]) -> Vec<&'static EnumType> {
    let mut used: Vec<&'static EnumType> = Vec::new();
    for row in table {
        if let Kind::Choice { ty, .. } = &row.kind
            && !used.iter().any(|known| known.name == ty.name)
        {
            used.push(ty);
        }
    }
    used
}

fn borrowed<'a>(attributes: &'a [(&'a str, String)]) -> Vec<(&'a str, &'a str)> {
    attributes.iter().map(|(key, value)| (*key, value.as_str())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_default_experiment_has_at_most_a_thousand_steps() {
        for k in 1..1000 {
            let period = 1e-5 * f64::from(k);
            let stop = stop_time(&Info::DEFAULT, period);
            assert!(stop / period <= STEPS_MAX && stop > 999.9 * period, "{period}");
        }
        assert_eq!(stop_time(&Info { stop_time: 2.0, ..Info::DEFAULT }, 1e-4), 2.0);
        assert_eq!(stop_time(&Info::DEFAULT, 1e-4), 0.1);
    }

    #[test]
    fn empty_facts_are_left_out() {
        let head_of = |info: &Info| {
            let mut xml = Writer::new("");
            head(&mut xml, info, "guid");
            xml.finish()
        };
        let known = Info { name: "Name", description: "x", ..Info::DEFAULT };
        assert!(!head_of(&known).contains("=\"\""));
        for missing in [" author=", " version=", " copyright=", " license="] {
            assert!(!head_of(&known).contains(missing), "{missing}");
        }
        assert!(head_of(&Info { author: "Someone", ..known }).contains(" author=\"Someone\""));
    }
}
