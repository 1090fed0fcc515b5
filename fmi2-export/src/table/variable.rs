//! The variable table: one row per variable, written once, checked when it is compiled.

use crate::table::enumeration::EnumType;
use crate::table::place::Place;
use crate::table::units::Unit;

/// Whether local variables become outputs, for tools that connect outputs only: a choice of the packer.
const ALL_OUTPUTS: bool = match option_env!("FMI2_EXPORT_OUTPUTS") {
    Some(choice) => crate::table::text::same(choice, "all"),
    None => false,
};

/// Whether the library can write its files. A packer that has them from another library of the same model leaves them out.
pub const HAS_FILES: bool = match option_env!("FMI2_EXPORT_FILES") {
    Some(choice) => !crate::table::text::same(choice, "none"),
    None => true,
};

/// One row of the table: name, accessors, role, unit, range, start value and text.
///
/// Made by [`interface`](macro@crate::interface) with the constructors and methods below.
#[derive(Debug)]
pub struct Variable<V: 'static> {
    pub(crate) name: &'static str,
    pub(crate) role: Option<Role>,
    pub(crate) description: &'static str,
    /// Description of the group of the variable; empty without a group.
    pub(crate) head: &'static str,
    /// Where the start value comes from.
    pub(crate) source: &'static str,
    /// The value of the paper, where it differs from the start value.
    pub(crate) paper: Option<f64>,
    /// The same of a String; empty where it does not differ.
    pub(crate) paper_text: &'static str,
    pub(crate) tier: Tier,
    /// Number of elements when the variable is an array.
    pub(crate) size: Option<usize>,
    pub(crate) kind: Kind<V>,
}

/// How many users need a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tier {
    /// To be set on every machine.
    Essential,
    Normal,
    /// For specialists; listed last, its name starts with `expert.`.
    Expert,
}

/// Causality and variability in one: the combinations a sampled controller needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    Input,
    Output,
    Local,
    Parameter,
    Tunable,
    Calculated,
}

impl Role {
    pub const fn is_parameter(self) -> bool {
        matches!(self, Role::Parameter | Role::Tunable)
    }
}

/// Where a variable lies in `V`, or its accessors.
#[derive(Debug)]
pub(crate) enum Kind<V: 'static> {
    Real { place: Place<V, f64>, start: &'static [f64], real: Real },
    Integer { place: Place<V, i32>, start: &'static [i32], min: i32, max: i32 },
    Boolean { place: Place<V, bool>, start: &'static [bool] },
    Text { get: fn(&V) -> &str, set: fn(&mut V, &str), start: &'static str },
    Choice { get: fn(&V) -> i32, set: fn(&mut V, i32), start: i32, ty: &'static EnumType },
}

/// Attributes that only a Real has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Real {
    pub min: f64,
    pub max: f64,
    pub nominal: f64,
    pub unit: Option<&'static Unit>,
    pub display: Option<&'static str>,
    pub accepts_nan: bool,
}

impl<V> Clone for Kind<V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V> Copy for Kind<V> {}

impl<V> Clone for Variable<V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V> Copy for Variable<V> {}

impl<V> Kind<V> {
    pub const fn type_name(&self) -> &'static str {
        match self {
            Kind::Real { .. } => "Real",
            Kind::Integer { .. } => "Integer",
            Kind::Boolean { .. } => "Boolean",
            Kind::Text { .. } => "String",
            Kind::Choice { .. } => "Enumeration",
        }
    }
}

/// Constructors for the declaration.
///
/// # Safety
/// Those of numbers take a field of `base`, the start values of `V`, as `start`: from the two follows where the field lies.
/// It is reached through fields and elements of arrays only, and the call is part of a constant, as
/// [`interface`](macro@crate::interface) makes it.
#[doc(hidden)]
#[allow(unsafe_code, clippy::missing_safety_doc, reason = "stated above for all of them")]
impl<V> Variable<V> {
    const fn new(name: &'static str, size: Option<usize>, kind: Kind<V>) -> Self {
        Self {
            name,
            role: None,
            description: "",
            head: "",
            source: "",
            paper: None,
            paper_text: "",
            tier: Tier::Normal,
            size,
            kind,
        }
    }

    pub const unsafe fn new_real(
        name: &'static str,
        size: Option<usize>,
        base: &'static V,
        start: &'static [f64],
    ) -> Self {
        let (min, max) = (f64::NEG_INFINITY, f64::INFINITY);
        let real = Real { min, max, nominal: 1.0, unit: None, display: None, accepts_nan: false };
        // SAFETY: the caller keeps the same promise.
        Self::new(name, size, Kind::Real { place: unsafe { Place::of(base, start) }, start, real })
    }

    pub const unsafe fn new_integer(
        name: &'static str,
        size: Option<usize>,
        base: &'static V,
        start: &'static [i32],
    ) -> Self {
        // SAFETY: as above.
        let place = unsafe { Place::of(base, start) };
        Self::new(name, size, Kind::Integer { place, start, min: i32::MIN, max: i32::MAX })
    }

    pub const unsafe fn new_boolean(
        name: &'static str,
        size: Option<usize>,
        base: &'static V,
        start: &'static [bool],
    ) -> Self {
        // SAFETY: as above.
        Self::new(name, size, Kind::Boolean { place: unsafe { Place::of(base, start) }, start })
    }

    pub const fn new_text(name: &'static str, get: fn(&V) -> &str, set: fn(&mut V, &str)) -> Self {
        Self::new(name, None, Kind::Text { get, set, start: "" })
    }

    pub const fn new_choice(
        name: &'static str,
        ty: &'static EnumType,
        start: i32,
        get: fn(&V) -> i32,
        set: fn(&mut V, i32),
    ) -> Self {
        Self::new(name, None, Kind::Choice { get, set, start, ty })
    }
}

macro_rules! roles {
    ($($(#[$doc:meta])+ $name:ident: $role:ident;)+) => {
        impl<V> Variable<V> {
            $($(#[$doc])+ pub const fn $name(self) -> Self {
                self.with_role(Role::$role)
            })+
        }
    };
}

roles! {
    /// An input, set by the importer before a step.
    input: Input;
    /// An output, held between samples.
    output: Output;
    /// A parameter that is fixed after initialization.
    parameter: Parameter;
    /// A parameter that may also change between steps.
    tunable: Tunable;
    /// A parameter computed from others by [`Model::calculate`](crate::Model::calculate).
    calculated: Calculated;
}

impl<V> Variable<V> {
    /// One line that says what the variable is.
    pub const fn describe(mut self, text: &'static str) -> Self {
        self.description = text;
        self
    }

    /// Sets the description of the group of the variable.
    pub const fn head(mut self, text: &'static str) -> Self {
        self.head = text;
        self
    }

    /// Where the start value comes from: a paper, a derivation, a choice with its reason.
    pub const fn source(mut self, text: &'static str) -> Self {
        self.source = text;
        self
    }

    /// Sets the value of the paper that the model follows: item number of an enumeration, 0 or 1 of a Boolean.
    pub const fn paper(mut self, value: f64) -> Self {
        self.paper = Some(value);
        self
    }

    /// Sets the value of a String that the paper gives.
    pub const fn paper_text(mut self, text: &'static str) -> Self {
        self.paper_text = text;
        self
    }

    /// A parameter that is set on every machine.
    pub const fn essential(mut self) -> Self {
        self.tier = Tier::Essential;
        self
    }

    /// A parameter for specialists.
    pub const fn expert(mut self) -> Self {
        self.tier = Tier::Expert;
        self
    }

    /// Unit of a Real.
    pub const fn unit(mut self, unit: &'static Unit) -> Self {
        self.real("only a Real has a unit").unit = Some(unit);
        self
    }

    /// Display unit of a Real, one of its unit's.
    pub const fn display(mut self, name: &'static str) -> Self {
        self.real("only a Real has a display unit").display = Some(name);
        self
    }

    /// Allowed values of a Real parameter, limits included; others are rejected. For other variables it is information
    /// for the environment, which scales plots and checks wirings by it.
    pub const fn range(mut self, min: f64, max: f64) -> Self {
        let real = self.real("`range` is for a Real; an Integer has `range_int`");
        real.min = min;
        real.max = max;
        self
    }

    /// Usual magnitude of a Real, for the importer's tolerances and plots.
    pub const fn nominal(mut self, magnitude: f64) -> Self {
        self.real("only a Real has a nominal value").nominal = magnitude;
        self
    }

    /// Lets NaN and infinities of a Real input reach the model, which answers with a fault of its
    /// own; without it they are an fmi2Error.
    pub const fn accepts_nan(mut self) -> Self {
        self.real("only a Real can be NaN").accepts_nan = true;
        self
    }

    /// Allowed values of an Integer parameter, or those to expect of another variable; limits included. See
    /// [`range`](Self::range).
    pub const fn range_int(mut self, low: i32, high: i32) -> Self {
        match &mut self.kind {
            Kind::Integer { min, max, .. } => {
                *min = low;
                *max = high;
            }
            _ => panic!("`range_int` is for an Integer"),
        }
        self
    }

    /// Start value of a String.
    pub const fn start_text(mut self, text: &'static str) -> Self {
        match &mut self.kind {
            Kind::Text { start, .. } => *start = text,
            _ => panic!("only a String takes its start value from the table"),
        }
        self
    }

    /// An internal quantity worth plotting; an output where the crate is compiled with `FMI2_EXPORT_OUTPUTS=all`.
    pub const fn local(self) -> Self {
        self.with_role(if ALL_OUTPUTS { Role::Output } else { Role::Local })
    }

    const fn with_role(mut self, role: Role) -> Self {
        assert!(self.role.is_none(), "a variable has one role: input, output, local, parameter, tunable or calculated");
        self.role = Some(role);
        self
    }

    const fn real(&mut self, message: &'static str) -> &mut Real {
        match &mut self.kind {
            Kind::Real { real, .. } => real,
            _ => panic!("{}", message),
        }
    }

    /// The row without the texts that only the files need.
    pub(crate) const fn without_texts(self) -> Self {
        Self { description: "", head: "", source: "", paper: None, paper_text: "", ..self }
    }

    /// Number of value references the variable takes.
    pub(crate) const fn len(&self) -> usize {
        match self.size {
            Some(size) => size,
            None => 1,
        }
    }

    /// Role of a checked variable.
    pub(crate) const fn role(&self) -> Role {
        match self.role {
            Some(role) => role,
            None => panic!("a variable needs a role: input, output, local, parameter, tunable or calculated"),
        }
    }

    /// FMI name of an element.
    pub(crate) fn element_name(&self, element: usize) -> String {
        match self.size {
            Some(_) => format!("{}[{}]", self.name, element + 1),
            None => self.name.to_owned(),
        }
    }
}
