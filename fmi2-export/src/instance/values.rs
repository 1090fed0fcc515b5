//! Getting and setting values: directly where nothing is wrong, otherwise with the reason.

use crate::exported::Exported;
use crate::host::phase::{Function, Phase};
use crate::instance::access::{Refusal, Scalar, Value, forbidden, wrong_type};
use crate::instance::{Instance, parameters_set};
use crate::table::variable::{Kind, Role, Variable};

impl<M: Exported> Instance<M> {
    /// fmi2SetReal of inputs, when nothing is wrong with it; otherwise `false`, and nothing has changed.
    #[inline]
    pub fn set_inputs(&mut self, references: &[u32], values: &[f64]) -> bool {
        let input = |reference: u32| M::INDEX.entries.get(reference as usize)?.input;
        let fits = |(&reference, value): (&u32, &f64)| input(reference).is_some() && value.is_finite();
        if !Function::SetReal.is_allowed(self.now.phase) {
            return false;
        }
        let mut set = |reference, value| input(reference).map(|place| place.set(&mut self.now.vars, value)).is_some();
        // most importers set one variable at a time
        if let (&[reference], &[value]) = (references, values) {
            return value.is_finite() && set(reference, value);
        }
        let all = || references.iter().zip(values);
        all().all(fits) && all().all(|(&reference, &value)| set(reference, value))
    }

    /// fmi2GetReal, when nothing is wrong with it; otherwise `false`, and nothing was written.
    #[inline]
    pub fn get_reals(&self, references: &[u32], values: &mut [f64]) -> bool {
        let read = |&reference: &u32| Some(M::INDEX.entries.get(reference as usize)?.real?.get(&self.now.vars));
        let give = |(reference, value): (&u32, &mut f64)| read(reference).map(|read| *value = read).is_some();
        if !Function::GetReal.is_allowed(self.now.phase) {
            return false;
        }
        // most importers get one variable at a time
        if let ([reference], [value]) = (references, &mut *values) {
            return give((reference, value));
        }
        references.iter().all(|reference| read(reference).is_some()) && references.iter().zip(values).all(give)
    }

    /// All or nothing: every reference is checked before the first value is given.
    pub(super) fn get<T: Scalar<M::Vars>>(
        &self,
        references: &[u32],
        mut give: impl FnMut(usize, T),
    ) -> Result<(), Refusal> {
        let read = |reference: &u32| {
            let (row, element) = self.entry(*reference)?;
            T::read(row, &self.now.vars, element).ok_or_else(|| wrong_type(row, T::KIND))
        };
        references.iter().try_for_each(|reference| read(reference).map(|_| ()))?;
        references.iter().enumerate().try_for_each(|(i, reference)| read(reference).map(|value| give(i, value)))
    }

    /// All or nothing: every value is checked before the first is written.
    pub(super) fn set<T: Value<M::Vars>>(
        &mut self,
        references: &[u32],
        value_of: impl Fn(usize) -> T,
    ) -> Result<(), Refusal> {
        for (i, &reference) in references.iter().enumerate() {
            let (value, (row, element)) = (value_of(i), self.entry(reference)?);
            if !T::fits(row) {
                return Err(wrong_type(row, T::KIND));
            }
            self.may_set(row, || value.equals(row, &self.now.vars, element))
                .map_err(|reason| forbidden(row, element, value, reason))?;
            value.verify(row, element)?;
        }
        let (mut parameters, running) = (false, self.now.phase.is_running());
        for (i, &reference) in references.iter().enumerate() {
            let (value, (row, element)) = (value_of(i), self.entry(reference)?);
            value.write(row, &mut self.now.vars, element);
            parameters |= row.role().is_parameter();
            // what may only be written again changes nothing
            let counts = !running || row.role() == Role::Tunable && self.now.phase != Phase::ContinuousTime;
            self.now.is_set[reference as usize] |= row.role().is_parameter() && counts;
        }
        if parameters {
            parameters_set::<M>(&mut self.now);
            if running {
                self.check_computed()?;
            }
        }
        Ok(())
    }

    /// Whether a variable may be set in this phase, or why not.
    fn may_set(&self, row: &Variable<M::Vars>, unchanged: impl Fn() -> bool) -> Result<(), &'static str> {
        let (running, between_events) = (self.now.phase.is_running(), self.now.phase == Phase::ContinuousTime);
        match row.role() {
            Role::Input if !between_events || matches!(row.kind, Kind::Real { .. }) => Ok(()),
            Role::Tunable if !between_events => Ok(()),
            // some importers write all that is no Real input again between events
            Role::Input | Role::Tunable if unchanged() => Ok(()),
            Role::Input => Err("an input that is no Real changes in event mode, not in continuous-time mode"),
            Role::Tunable => Err("a parameter changes in event mode, not in continuous-time mode"),
            // and fixed parameters after initialization
            Role::Parameter if !running || unchanged() => Ok(()),
            Role::Parameter => Err("it is fixed after initialization"),
            Role::Calculated => Err("it is calculated from other parameters"),
            Role::Output | Role::Local if !running => Ok(()),
            Role::Output | Role::Local => Err("it is written by the FMU"),
        }
    }
}
