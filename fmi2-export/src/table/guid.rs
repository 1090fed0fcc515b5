//! The GUID: a constant hash of everything the model description and the state bytes are made of, so that it can be read
//! from a binary of any platform without running it.

use crate::model::{Info, Interface, Model};
use crate::table::enumeration::EnumType;
use crate::table::hash::{self, GUID, fnv1a};
use crate::table::units::Unit;
use crate::table::variable::{Kind, Real, Role, Variable};

/// GUID of a model.
pub const fn of<M: Model>() -> [u8; GUID] {
    let mut hash = info(Hash(hash::OFFSET), &M::INFO);
    let mut i = 0;
    while i < M::Vars::TABLE.len() {
        hash = row(hash, &M::Vars::TABLE[i]);
        i += 1;
    }
    // other variables or another state: the state bytes of before mean something else
    hash::guid(hash.number(size_of::<M::Vars>() as u64).number(size_of::<M>() as u64).0)
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
    hash.number(info.state_version as u64).real(info.stop_time).real(info.sample_period)
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

#[cfg(test)]
#[allow(unsafe_code)]
mod tests {
    use super::*;
    use crate::{Env, Error, Variable, units};
    use serde::{Deserialize, Serialize};
    use std::slice::from_ref;

    /// Models that differ in one thing each; the row is made of `$x`, an input without a description.
    macro_rules! model {
        ($name:ident, $vars:ident, $state:ty, |$x:ident| $row:expr, $info:expr) => {
            #[derive(Clone, Serialize, Deserialize)]
            struct $vars {
                x: f64,
            }
            impl Interface for $vars {
                const START: Self = Self { x: 0.0 };
                const TABLE: &'static [Variable<Self>] = {
                    const START: &$vars = &<$vars as Interface>::START;
                    const ROW: Variable<$vars> = {
                        // SAFETY: a field, in a constant.
                        let $x = unsafe { Variable::new_real("x", None, START, from_ref(&START.x)) };
                        $row
                    };
                    &[ROW]
                };
            }
            #[derive(Clone, Serialize, Deserialize)]
            struct $name($state);
            impl Model for $name {
                const INFO: Info = $info;
                type Vars = $vars;
                fn initialise(_: &mut $vars, _: &mut Env) -> Result<Self, Error> {
                    Ok(Self(Default::default()))
                }
                fn sample(&mut self, _: &mut $vars, _: &mut Env) -> Result<(), Error> {
                    Ok(())
                }
            }
        };
    }

    const INFO: Info = Info { name: "Model", identifier: "model", description: "x", ..Info::DEFAULT };
    model!(First, VarsA, (), |x| x.input().describe("x"), INFO);
    model!(Same, VarsB, (), |x| x.input().describe("x"), INFO);
    model!(Described, VarsC, (), |x| x.input().describe("y"), INFO);
    model!(Output, VarsD, (), |x| x.output().describe("x"), INFO);
    model!(InMetres, VarsE, (), |x| x.input().describe("x").unit(&units::METRE), INFO);
    model!(Limited, VarsF, (), |x| x.input().describe("x").range(0.0, 1.0), INFO);
    model!(Scaled, VarsG, (), |x| x.input().describe("x").nominal(2.0), INFO);
    model!(WithState, VarsH, [f64; 3], |x| x.input().describe("x"), INFO);
    model!(NewVersion, VarsI, (), |x| x.input().describe("x"), Info { version: "2", ..INFO });
    model!(NewState, VarsJ, (), |x| x.input().describe("x"), Info { state_version: 2, ..INFO });

    #[test]
    fn it_changes_with_everything_that_the_description_and_the_state_are_made_of() {
        assert_eq!(of::<First>(), of::<Same>());
        let all = [
            of::<First>(),
            of::<Described>(),
            of::<Output>(),
            of::<InMetres>(),
            of::<Limited>(),
            of::<Scaled>(),
            of::<WithState>(),
            of::<NewVersion>(),
            of::<NewState>(),
        ];
        for (i, guid) in all.iter().enumerate() {
            assert!(!all[..i].contains(guid), "model {i}");
        }
    }
}
