//! A bank as bytes with all digits: magic, content, checksum. Learned patterns return bit for bit.

use crate::bank::pattern_bank::PatternBank;
use crate::fingerprint::Fingerprint;

const MAGIC: &[u8] = b"DEBURR-BANK-1\n";
const CHECKSUM: usize = 8;

/// The bank as bytes.
pub fn encode(bank: &PatternBank) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    // a bank holds nothing that postcard cannot write
    bytes.extend(postcard::to_allocvec(bank).unwrap_or_default());
    sign(&mut bytes);
    bytes
}

/// The bank from its bytes; none when this is no bank of this format.
///
/// # Errors
/// Message for the user if the bytes are damaged.
pub fn decode(bytes: &[u8]) -> Option<Result<PatternBank, String>> {
    let content = bytes.strip_prefix(MAGIC)?;
    Some(verify(bytes).and_then(|()| {
        let content = &content[..content.len() - CHECKSUM];
        let (bank, rest) = postcard::take_from_bytes(content).map_err(|error| error.to_string())?;
        if rest.is_empty() { Ok(bank) } else { Err(format!("`{}` bytes too many", rest.len())) }
    }))
}

/// Appends the checksum.
pub fn sign(bytes: &mut Vec<u8>) {
    let sum = checksum(bytes);
    bytes.extend(sum);
}

/// Checks the checksum at the end.
///
/// # Errors
/// Message for the user if it is wrong.
pub fn verify(bytes: &[u8]) -> Result<(), String> {
    let damaged = || "the checksum is wrong: the file is damaged or truncated".to_owned();
    let (content, sum) = bytes.split_at_checked(bytes.len().saturating_sub(CHECKSUM)).ok_or_else(damaged)?;
    if checksum(content) == sum { Ok(()) } else { Err(damaged()) }
}

fn checksum(bytes: &[u8]) -> [u8; CHECKSUM] {
    let mut print = Fingerprint::default();
    print.bytes(bytes);
    print.value().to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bank::pattern_bank::tests::numbered;

    #[test]
    fn a_bank_is_restored_bit_for_bit() {
        let bank = numbered(|k| (k as f64).sqrt() * 1e-3);
        assert_eq!(decode(&encode(&bank)), Some(Ok(bank)));
    }

    #[test]
    fn every_damaged_or_cut_file_is_rejected() {
        let bytes = encode(&numbered(|k| k as f64));
        for k in (0..bytes.len()).step_by(97).chain(bytes.len() - 9..bytes.len()) {
            let mut damaged = bytes.clone();
            damaged[k] ^= 0x10;
            assert!(decode(&damaged).is_none_or(|bank| bank.is_err()), "{k}");
            assert!(decode(&bytes[..k]).is_none_or(|bank| bank.is_err()), "{k}");
        }
        assert!(decode(&[bytes.clone(), vec![0]].concat()).unwrap().is_err());
        assert!(decode(b"").is_none() && decode(b"{}").is_none());
    }
}
