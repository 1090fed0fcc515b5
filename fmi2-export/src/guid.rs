//! The GUID: a constant hash of everything the model description and the state bytes are made of, so that it can be read
//! from a binary of any platform without running it.

use crate::enumeration::EnumType;
use crate::hash::{self, GUID, fnv1a};
use crate::model::{Info, Model};
use crate::units::Unit;
use crate::variable::{Kind, Real, Role, Variable};

/// GUID of a model.
pub const fn of<M: Model>() -> [u8; GUID] {
    let mut hash = info(Hash(hash::OFFSET), &M::INFO);
    let mut i = 0;
    while i < M::VARIABLES.len() {
        hash = row(hash, &M::VARIABLES[i]);
        i += 1;
    }
    // other variables or another state: the state bytes of before mean something else
    hash::guid(hash.number(size_of::<M::Vars>() as u64).number(size_of::<M::State>() as u64).0)
}

/// A hash under construction.
#[derive(Clone, Copy)]
struct Hash(u128);

impl Hash {
    const fn text(self, text: &str) -> Self {
        Self(fnv1a(self.number(text.len() as u64).0, text.as_bytes()))
    }

    const fn number(self, number: u64) -> Self {
        Self(fnv1a(self.0, &number.to_le_bytes()))
    }

    const fn real(self, number: f64) -> Self {
        self.number(number.to_bits())
    }
}

const fn info(hash: Hash, info: &Info) -> Hash {
    let hash = hash.text(env!("CARGO_PKG_VERSION")).text(info.name).text(info.identifier).text(info.description);
    let hash = hash.text(info.version).text(info.author).text(info.copyright).text(info.license);
    hash.number(info.state_version as u64).real(info.stop_time).real(info.step_size)
}

const fn row<V>(hash: Hash, row: &Variable<V>) -> Hash {
    let role = match row.role() {
        Role::Input => 0,
        Role::Output => 1,
        Role::Local => 2,
        Role::Parameter => 3,
        Role::Tunable => 4,
        Role::Calculated => 5,
    };
    let size = match row.size {
        Some(size) => size as u64,
        None => 0,
    };
    let hash = hash.text(row.name).text(row.description).text(row.kind.type_name()).number(role).number(size);
    match &row.kind {
        Kind::Real { start, real: facts, .. } => real(hash, start, facts),
        Kind::Integer { start, min, max, .. } => integer(hash, start, *min, *max),
        Kind::Boolean { start, .. } => boolean(hash, start),
        Kind::Text { start, .. } => hash.text(start),
        Kind::Choice { start, ty, .. } => enumeration(hash.number(*start as u64), ty),
    }
}

const fn real(hash: Hash, start: &[f64], real: &Real) -> Hash {
    let mut hash = hash.real(real.min).real(real.max).real(real.nominal).number(real.accepts_nan as u64);
    let mut i = 0;
    while i < start.len() {
        hash = hash.real(start[i]);
        i += 1;
    }
    hash = match real.display {
        Some(name) => hash.text(name),
        None => hash,
    };
    match real.unit {
        Some(facts) => unit(hash, facts),
        None => hash,
    }
}

const fn unit(hash: Hash, unit: &Unit) -> Hash {
    let mut hash = hash.text(unit.name).real(unit.factor).real(unit.offset);
    let mut i = 0;
    while i < unit.base.len() {
        hash = hash.number(unit.base[i] as u64);
        i += 1;
    }
    let mut i = 0;
    while i < unit.display.len() {
        hash = hash.text(unit.display[i].name).real(unit.display[i].factor);
        i += 1;
    }
    hash
}

const fn integer(hash: Hash, start: &[i32], min: i32, max: i32) -> Hash {
    let mut hash = hash.number(min as u64).number(max as u64);
    let mut i = 0;
    while i < start.len() {
        hash = hash.number(start[i] as u64);
        i += 1;
    }
    hash
}

const fn boolean(mut hash: Hash, start: &[bool]) -> Hash {
    let mut i = 0;
    while i < start.len() {
        hash = hash.number(start[i] as u64);
        i += 1;
    }
    hash
}

const fn enumeration(hash: Hash, ty: &EnumType) -> Hash {
    let mut hash = hash.text(ty.name).text(ty.description);
    let mut i = 0;
    while i < ty.items.len() {
        hash = hash.text(ty.items[i].name).text(ty.items[i].description);
        i += 1;
    }
    hash
}
