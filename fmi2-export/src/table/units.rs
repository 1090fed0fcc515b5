//! Physical units: SI base exponents, and the display units a tool may offer.

/// A unit as FMI 2.0 defines it: `base value = factor * value + offset`.
#[derive(Debug)]
pub struct Unit {
    /// Name in the description, for instance `m/s`.
    pub name: &'static str,
    /// Exponents of kg, m, s, A, K, mol, cd, rad.
    pub base: [i32; 8],
    /// Factor to the base unit.
    pub factor: f64,
    /// Offset to the base unit.
    pub offset: f64,
    /// Units a tool may show instead.
    pub display: &'static [DisplayUnit],
}

/// A unit for display: `shown value = factor * value`.
#[derive(Debug)]
pub struct DisplayUnit {
    /// Name, for instance `um`.
    pub name: &'static str,
    /// Shown value per value.
    pub factor: f64,
}

/// Names of the SI base units in the order of [`Unit::base`].
pub(crate) const BASE: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];

impl Unit {
    /// A coherent SI unit from its exponents of kg, m, s, A and rad.
    pub const fn si(name: &'static str, [kg, m, s, a, rad]: [i32; 5], display: &'static [DisplayUnit]) -> Self {
        Self { name, base: [kg, m, s, a, 0, 0, 0, rad], factor: 1.0, offset: 0.0, display }
    }
}

const fn shown(name: &'static str, factor: f64) -> DisplayUnit {
    DisplayUnit { name, factor }
}

const PER_TURN: f64 = 1.0 / std::f64::consts::TAU;

/// A ratio.
pub const ONE: Unit = Unit::si("1", [0, 0, 0, 0, 0], &[shown("%", 100.0)]);
/// Length.
pub const METRE: Unit = Unit::si("m", [0, 1, 0, 0, 0], &[shown("mm", 1e3), shown("um", 1e6), shown("nm", 1e9)]);
/// Time.
pub const SECOND: Unit = Unit::si("s", [0, 0, 1, 0, 0], &[shown("ms", 1e3), shown("us", 1e6)]);
/// Mass.
pub const KILOGRAM: Unit = Unit::si("kg", [1, 0, 0, 0, 0], &[]);
/// Electric current.
pub const AMPERE: Unit = Unit::si("A", [0, 0, 0, 1, 0], &[shown("mA", 1e3)]);
/// Plane angle.
pub const RADIAN: Unit = Unit::si("rad", [0, 0, 0, 0, 1], &[shown("deg", 180.0 / std::f64::consts::PI)]);
/// Frequency.
pub const HERTZ: Unit = Unit::si("Hz", [0, 0, -1, 0, 0], &[shown("kHz", 1e-3)]);
/// Angular velocity and control bandwidth.
pub const RADIAN_PER_SECOND: Unit =
    Unit::si("rad/s", [0, 0, -1, 0, 1], &[shown("Hz", PER_TURN), shown("rpm", 60.0 * PER_TURN)]);
/// Angular acceleration.
pub const RADIAN_PER_SECOND_SQUARED: Unit = Unit::si("rad/s2", [0, 0, -2, 0, 1], &[]);
/// Velocity.
pub const METRE_PER_SECOND: Unit =
    Unit::si("m/s", [0, 1, -1, 0, 0], &[shown("mm/s", 1e3), shown("um/s", 1e6), shown("mm/min", 6e4)]);
/// Acceleration.
pub const METRE_PER_SECOND_SQUARED: Unit = Unit::si("m/s2", [0, 1, -2, 0, 0], &[]);
/// Force.
pub const NEWTON: Unit = Unit::si("N", [1, 1, -2, 0, 0], &[shown("mN", 1e3)]);
/// Rate of a force.
pub const NEWTON_PER_SECOND: Unit = Unit::si("N/s", [1, 1, -3, 0, 0], &[]);
/// Stiffness.
pub const NEWTON_PER_METRE: Unit = Unit::si("N/m", [1, 0, -2, 0, 0], &[shown("N/mm", 1e-3), shown("N/um", 1e-6)]);
/// Force constant of a linear motor.
pub const NEWTON_PER_AMPERE: Unit = Unit::si("N/A", [1, 1, -2, -1, 0], &[]);
/// Torque.
pub const NEWTON_METRE: Unit = Unit::si("N.m", [1, 2, -2, 0, 0], &[shown("mN.m", 1e3)]);
