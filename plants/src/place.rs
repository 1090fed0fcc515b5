//! A memory location that is read, set or added to.

use std::ptr::NonNull;

/// Address of a number with its scale and offset: reads give `scale * memory + offset`.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pointer: NonNull<f64>,
    scale: f64,
    offset: f64,
    /// 0: a fixed location, otherwise a signal, whose sample of plant step k is `k * stride` further on
    stride: usize,
    /// writes add to the stored value
    add: bool,
    /// plant steps for which there is a sample
    steps: usize,
}

// SAFETY: the creator of a place guarantees its memory, see `Place::new`.
unsafe impl Send for Place {}
// SAFETY: as above.
unsafe impl Sync for Place {}

impl Place {
    /// A location in a block of `count` numbers, of which `pointer` is the first that is used.
    ///
    /// # Safety
    /// The block can be read, and written if [`Place::put`] or [`Place::clear`] are called, as long as any copy of the
    /// location is in use, and one thread at a time uses it.
    pub unsafe fn new(
        pointer: NonNull<f64>,
        count: usize,
        (scale, offset): (f64, f64),
        stride: usize,
        add: bool,
    ) -> Self {
        let steps = if stride == 0 { usize::MAX } else { count.div_ceil(stride) };
        Self { pointer, scale, offset, stride, add, steps }
    }

    /// Plant steps for which there is a sample.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Whether it is a signal, which is never written.
    pub fn is_signal(&self) -> bool {
        self.stride != 0
    }

    /// Whether writes add to the stored value.
    pub fn adds(&self) -> bool {
        self.add
    }

    /// Value at plant step `k`.
    ///
    /// # Panics
    /// When there is no sample for this step.
    pub fn sample(&self, k: usize) -> f64 {
        assert!(k < self.steps, "sample {k} of {}", self.steps);
        // SAFETY: k < steps, so the address is inside the block.
        let value = unsafe { self.pointer.add(k * self.stride).read() };
        self.scale * value + self.offset
    }

    /// Writes `scale * value + offset`, or adds it.
    pub fn put(&self, value: f64) {
        // SAFETY: the first number of a block that can be written.
        unsafe {
            let before = if self.add { self.pointer.read() } else { 0.0 };
            self.pointer.write(before + (self.scale * value + self.offset));
        }
    }

    /// Writes zero.
    pub fn clear(&self) {
        // SAFETY: as in `put`.
        unsafe { self.pointer.write(0.0) }
    }
}
