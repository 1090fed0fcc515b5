//! Fields of the variables by their offset: read and written without a call of an accessor.
//!
//! # Safety
//! A [`Place`] is made in one way only: from the start values of `V` and a field of them. What lies there in the start
//! values lies there in every `V`.
#![allow(unsafe_code)]

use std::marker::PhantomData;

/// Where a `T`, or the first one of an array, lies in `V`.
#[derive(Debug)]
pub struct Place<V, T> {
    /// Distance from the beginning of `V`, in bytes.
    offset: u32,
    /// It belongs to these types and to no others.
    types: PhantomData<fn(&V) -> T>,
}

impl<V, T> Clone for Place<V, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V, T> Copy for Place<V, T> {}

impl<V, T: Copy> Place<V, T> {
    /// The position of `part`, a field of `base`; a part outside of it does not compile.
    ///
    /// # Safety
    /// `part` is reached from `base` through fields and elements of arrays only, never through an enumeration: so it lies
    /// there in every `V`. The call is part of a constant.
    pub const unsafe fn of(base: &'static V, part: &'static [T]) -> Self {
        let base = std::ptr::from_ref(base).cast::<u8>();
        // SAFETY: a table is a constant, and a constant refuses pointers into different values.
        let offset = unsafe { part.as_ptr().cast::<u8>().offset_from(base) };
        let inside = offset >= 0 && offset as usize + size_of_val(part) <= size_of::<V>();
        assert!(inside && offset <= u32::MAX as isize, "the start values are no field of the variables");
        Self { offset: offset as u32, types: PhantomData }
    }

    /// The position of an element of an array.
    pub const fn element(self, element: usize) -> Self {
        let offset = self.offset as usize + element * size_of::<T>();
        assert!(offset + size_of::<T>() <= size_of::<V>(), "an array and its start values differ in length");
        Self { offset: offset as u32, types: PhantomData }
    }

    /// Distance from the beginning of `V`, in bytes.
    pub const fn offset(self) -> usize {
        self.offset as usize
    }

    /// The value.
    #[inline]
    pub fn get(self, vars: &V) -> T {
        // SAFETY: a `T` lies there, see above.
        unsafe { *std::ptr::from_ref(vars).byte_add(self.offset as usize).cast::<T>() }
    }

    /// Sets the value.
    #[inline]
    pub fn set(self, vars: &mut V, value: T) {
        // SAFETY: a `T` lies there, see above.
        unsafe { *std::ptr::from_mut(vars).byte_add(self.offset as usize).cast::<T>() = value }
    }
}

/// Numbers that lie side by side in `V`.
#[derive(Debug)]
pub struct Run<V> {
    first: Place<V, f64>,
    count: u32,
}

impl<V> Clone for Run<V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V> Copy for Run<V> {}

impl<V> Run<V> {
    /// No number.
    pub const EMPTY: Self = Self { first: Place { offset: 0, types: PhantomData }, count: 0 };

    /// One number.
    pub const fn of(first: Place<V, f64>) -> Self {
        Self { first, count: 1 }
    }

    /// The offset after it, in bytes.
    pub const fn end(self) -> usize {
        self.first.offset as usize + self.count as usize * size_of::<f64>()
    }

    /// With the number that lies at its end, if `place` does.
    pub const fn with(self, place: Place<V, f64>) -> Option<Self> {
        let joins = self.count > 0 && place.offset() == self.end();
        if joins { Some(Self { first: self.first, count: self.count + 1 }) } else { None }
    }

    /// The values.
    #[inline]
    pub fn get(self, vars: &V) -> &[f64] {
        if self.count == 0 {
            return &[];
        }
        // SAFETY: each of the numbers lies there, one behind the other, see above.
        unsafe {
            let first = std::ptr::from_ref(vars).byte_add(self.first.offset as usize).cast();
            std::slice::from_raw_parts(first, self.count as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Vars {
        name: &'static str,
        x: f64,
        pair: [f64; 2],
    }

    const START: &Vars = &Vars { name: "start", x: 1.0, pair: [2.0, 3.0] };
    const X: Place<Vars, f64> = // SAFETY: a field.
        unsafe { Place::of(START, std::slice::from_ref(&START.x)) };
    const SECOND: Place<Vars, f64> = // SAFETY: a field.
        unsafe { Place::of(START, &START.pair) }.element(1);

    #[test]
    fn a_place_is_that_field_of_every_value() {
        let mut vars = Vars { name: "other", x: 10.0, pair: [20.0, 30.0] };
        assert_eq!((X.get(START), SECOND.get(START)), (1.0, 3.0));
        assert_eq!((X.get(&vars), SECOND.get(&vars)), (10.0, 30.0));
        SECOND.set(&mut vars, 31.0);
        assert_eq!((vars.name, vars.x, vars.pair), ("other", 10.0, [20.0, 31.0]));
    }

    #[test]
    fn a_run_is_made_of_numbers_side_by_side() {
        let first = // SAFETY: a field.
            unsafe { Place::of(START, &START.pair) };
        let pair = Run::of(first).with(SECOND).unwrap();
        assert_eq!(pair.get(START), [2.0, 3.0]);
        assert!(Run::of(SECOND).with(first).is_none() && Run::EMPTY.with(first).is_none());
        assert!(Run::EMPTY.get(START).is_empty());
    }
}
