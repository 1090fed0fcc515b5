//! FNV-1a with 128 bits: identifies descriptions (GUID) and guards state bytes.

/// Hash of `bytes`, continued from `seed`; start with [`OFFSET`].
pub const fn fnv1a(mut seed: u128, bytes: &[u8]) -> u128 {
    let mut i = 0;
    while i < bytes.len() {
        seed = (seed ^ bytes[i] as u128).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        i += 1;
    }
    seed
}

/// The offset basis of FNV-1a-128.
pub const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;

/// Number of characters of a [`guid`].
pub const GUID: usize = 36;

/// A hash as 8-4-4-4-12 hexadecimal digits, without braces: importers make folders of it.
pub const fn guid(hash: u128) -> [u8; GUID] {
    let mut text = [b'-'; GUID];
    let (mut digit, mut at) = (0, 0);
    while digit < 32 {
        if matches!(digit, 8 | 12 | 16 | 20) {
            at += 1;
        }
        text[at] = b"0123456789abcdef"[(hash >> (4 * (31 - digit))) as usize % 16];
        digit += 1;
        at += 1;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_test_vectors() {
        assert_eq!(fnv1a(OFFSET, b""), OFFSET);
        assert_eq!(fnv1a(OFFSET, b"a"), 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
        assert_eq!(fnv1a(OFFSET, b"foobar"), 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18);
    }

    #[test]
    fn guid_has_the_usual_shape() {
        assert_eq!(&guid(0x0123_4567_89ab_cdef_0011_2233_4455_6677), b"01234567-89ab-cdef-0011-223344556677");
    }
}
