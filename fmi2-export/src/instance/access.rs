//! Typed reading, checking and writing of a variable.

use crate::host::phase::Status;
use crate::table::index::Entry;
use crate::table::variable::{Kind, Real, Variable};
use std::fmt::{Debug, Display};

/// Reason and status of a rejected call. Boxed, so that the result of a good call fits a register.
#[derive(Debug)]
pub struct Refusal(Box<(Status, String)>);

impl Refusal {
    pub fn error(text: impl Into<String>) -> Self {
        Self(Box::new((Status::Error, text.into())))
    }

    pub fn discard(text: impl Into<String>) -> Self {
        Self(Box::new((Status::Discard, text.into())))
    }

    pub fn status(&self) -> Status {
        self.0.0
    }

    pub fn text(&self) -> &str {
        &self.0.1
    }
}

/// A value of one of the types that cross the C API.
pub trait Value<V>: Copy + Display {
    /// Type in the names of the accessing functions, such as `Real` in `fmi2GetReal`; for messages.
    const KIND: &'static str;
    /// Whether the variable is of this type.
    fn fits(row: &Variable<V>) -> bool;
    /// Whether the variable has this value now.
    fn equals(self, row: &Variable<V>, vars: &V, element: usize) -> bool;
    /// Whether the variable takes the value; its type has been checked.
    fn verify(self, row: &Variable<V>, element: usize) -> Result<(), Refusal>;
    /// Writes a verified value.
    fn write(self, row: &Variable<V>, vars: &mut V, element: usize);
}

/// A value that is copied out of the variables.
pub trait Scalar<V>: Value<V> {
    /// The present value, or `None` when the variable is of another type.
    fn read(row: &Variable<V>, vars: &V, element: usize) -> Option<Self>;
}

impl<V> Value<V> for f64 {
    const KIND: &'static str = "Real";

    fn fits(row: &Variable<V>) -> bool {
        matches!(row.kind, Kind::Real { .. })
    }

    fn equals(self, row: &Variable<V>, vars: &V, element: usize) -> bool {
        Self::read(row, vars, element) == Some(self)
    }

    #[inline]
    fn verify(self, row: &Variable<V>, element: usize) -> Result<(), Refusal> {
        match &row.kind {
            Kind::Real { real, .. } if !self.is_finite() => refuse_not_finite(self, row, element, real),
            Kind::Real { real, .. } if row.role().is_parameter() && !(real.min <= self && self <= real.max) => {
                refuse_real(self, row, element, real)
            }
            _ => Ok(()),
        }
    }

    fn write(self, row: &Variable<V>, vars: &mut V, element: usize) {
        if let Kind::Real { place, .. } = row.kind {
            place.element(element).set(vars, self);
        }
    }
}

impl<V> Scalar<V> for f64 {
    fn read(row: &Variable<V>, vars: &V, element: usize) -> Option<Self> {
        match row.kind {
            Kind::Real { place, .. } => Some(place.element(element).get(vars)),
            _ => None,
        }
    }
}

impl<V> Value<V> for i32 {
    const KIND: &'static str = "Integer";

    fn fits(row: &Variable<V>) -> bool {
        matches!(row.kind, Kind::Integer { .. } | Kind::Choice { .. })
    }

    fn equals(self, row: &Variable<V>, vars: &V, element: usize) -> bool {
        Self::read(row, vars, element) == Some(self)
    }

    fn verify(self, row: &Variable<V>, element: usize) -> Result<(), Refusal> {
        match &row.kind {
            Kind::Integer { min, max, .. } if row.role().is_parameter() && (self < *min || self > *max) => {
                Err(out_of_range(&row.element_name(element), self, *min, *max, ""))
            }
            Kind::Choice { ty, .. } if self < 1 || self as usize > ty.items.len() => {
                let items = ty.items.iter().zip(1..).map(|(item, number)| format!("{number} {}", item.name));
                let items = items.collect::<Vec<_>>().join(", ");
                Err(Refusal::discard(format!("`{}` = {self} is no item of `{}` ({items})", row.name, ty.name)))
            }
            _ => Ok(()),
        }
    }

    fn write(self, row: &Variable<V>, vars: &mut V, element: usize) {
        match row.kind {
            Kind::Integer { place, .. } => place.element(element).set(vars, self),
            Kind::Choice { set, .. } => set(vars, self),
            _ => (),
        }
    }
}

impl<V> Scalar<V> for i32 {
    fn read(row: &Variable<V>, vars: &V, element: usize) -> Option<Self> {
        match row.kind {
            Kind::Integer { place, .. } => Some(place.element(element).get(vars)),
            Kind::Choice { get, .. } => Some(get(vars)),
            _ => None,
        }
    }
}

impl<V> Value<V> for bool {
    const KIND: &'static str = "Boolean";

    fn fits(row: &Variable<V>) -> bool {
        matches!(row.kind, Kind::Boolean { .. })
    }

    fn equals(self, row: &Variable<V>, vars: &V, element: usize) -> bool {
        Self::read(row, vars, element) == Some(self)
    }

    fn verify(self, _: &Variable<V>, _: usize) -> Result<(), Refusal> {
        Ok(())
    }

    fn write(self, row: &Variable<V>, vars: &mut V, element: usize) {
        if let Kind::Boolean { place, .. } = row.kind {
            place.element(element).set(vars, self);
        }
    }
}

impl<V> Scalar<V> for bool {
    fn read(row: &Variable<V>, vars: &V, element: usize) -> Option<Self> {
        match row.kind {
            Kind::Boolean { place, .. } => Some(place.element(element).get(vars)),
            _ => None,
        }
    }
}

#[cold]
fn refuse_real<V>(value: f64, row: &Variable<V>, element: usize, real: &Real) -> Result<(), Refusal> {
    let unit = real.unit.map_or(String::new(), |unit| format!(" {}", unit.name));
    Err(out_of_range(&row.element_name(element), value, real.min, real.max, &unit))
}

#[cold]
fn refuse_not_finite<V>(value: f64, row: &Variable<V>, element: usize, real: &Real) -> Result<(), Refusal> {
    let name = row.element_name(element);
    if real.accepts_nan { Ok(()) } else { Err(Refusal::error(format!("`{name}` = {value} is not finite"))) }
}

#[cold]
fn out_of_range<T: Debug>(name: &str, value: T, min: T, max: T, unit: &str) -> Refusal {
    Refusal::discard(format!("`{name}` = {value:?}{unit} is outside {min:?} .. {max:?}{unit}; the old value stays"))
}

impl<V> Value<V> for &str {
    const KIND: &'static str = "String";

    fn fits(row: &Variable<V>) -> bool {
        matches!(row.kind, Kind::Text { .. })
    }

    fn equals(self, row: &Variable<V>, vars: &V, _: usize) -> bool {
        match row.kind {
            Kind::Text { get, .. } => get(vars) == self,
            _ => false,
        }
    }

    fn verify(self, _: &Variable<V>, _: usize) -> Result<(), Refusal> {
        Ok(())
    }

    fn write(self, row: &Variable<V>, vars: &mut V, _: usize) {
        if let Kind::Text { set, .. } = row.kind {
            set(vars, self);
        }
    }
}

// what a good call never builds is kept out of its way

/// There is no such value reference.
#[cold]
pub fn unknown(reference: u32, count: usize) -> Refusal {
    Refusal::error(format!("there is no variable with the value reference {reference} (0 .. {})", count - 1))
}

/// The model has computed a value that may not leave it.
#[cold]
pub fn not_finite<V>(entry: &Entry<V>, value: f64) -> Refusal {
    let (row, element) = entry.position();
    Refusal::error(format!("the model computed `{}` = {value}", row.element_name(element)))
}

/// The variable may not be set now.
#[cold]
pub fn forbidden<V>(row: &Variable<V>, element: usize, value: impl Display, reason: &str) -> Refusal {
    Refusal::error(format!("`{}` = {value}: {reason}", row.element_name(element)))
}

/// The variable is of another type than the function.
#[cold]
pub fn wrong_type<V>(row: &Variable<V>, kind: &str) -> Refusal {
    let own = row.kind.type_name();
    let hint = match own {
        "Enumeration" => "Integer",
        own => own,
    };
    Refusal::error(format!("`{}` is of type {own}, not {kind}; hint: fmi2Get{hint}, fmi2Set{hint}", row.name))
}
