//! Fingerprint of numbers: identifies the path and the machine to which a stored bank belongs.

/// FNV-1a over the bits of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// Takes one number in.
    pub fn add(&mut self, value: f64) {
        // both zeros are one number
        self.bytes(&(value + 0.0).to_bits().to_le_bytes());
    }

    /// Takes bytes in.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// 64-bit hash of all numbers and bytes added so far.
    pub fn value(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_known_values_of_fnv_1a() {
        for (text, value) in
            [("", 0xcbf2_9ce4_8422_2325), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)]
        {
            let mut print = Fingerprint::default();
            print.bytes(text.as_bytes());
            assert_eq!(print.value(), value);
        }
    }

    #[test]
    fn every_bit_of_a_number_counts_but_the_sign_of_zero() {
        let print = |value: f64| {
            let mut print = Fingerprint::default();
            print.add(value);
            print.value()
        };
        assert_eq!(print(0.0), print(-0.0));
        assert_ne!(print(1.0), print(1.0 + f64::EPSILON));
    }
}
