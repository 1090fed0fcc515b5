//! A bank as the paper stores it: 18 bytes for each sample, six pulses, distance, flags and feed.
//!
//! All numbers are little endian. Header: magic, fingerprint of the path (u64), pulses (6 f64), period (f64), delay
//! (u16), number of patterns (u16), and for each its factor (f64) and number of samples (u32). Then the records, then a
//! checksum.

use crate::bank::bank_file::{sign, verify};
use crate::bank::pattern_bank::{Identity, PatternBank};
use crate::learning::pattern::{Pattern, Sample};
use crate::path::kinematics::{AXES, Joints};
use crate::path::programmed_path::ProgrammedPath;

const MAGIC: &[u8] = b"DEBURR-RECORDS-1\n";
/// Bytes of a record.
pub const RECORD: usize = 18;
/// Unit of distance (m) and of feed (m/s): 0.01 mm and 0.01 mm/s.
const UNIT: f64 = 1e-5;
/// Flags: two bits for the phase, the others for the block.
const PHASE_BITS: u32 = 2;

/// The bank as bytes.
///
/// # Errors
/// Message for the user if a number does not fit into its 16 bits.
pub fn encode(bank: &PatternBank, path: &ProgrammedPath) -> Result<Vec<u8>, String> {
    let Identity { path: print, pulses, period, io_delay, factors } = bank.identity();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(print.to_le_bytes());
    pulses.iter().chain([period]).for_each(|value| bytes.extend(value.to_le_bytes()));
    bytes.extend(io_delay.to_le_bytes());
    bytes.extend(fit::<u16>(bank.patterns().len() as f64, "number of patterns")?.to_le_bytes());
    for (pattern, factor) in bank.patterns().iter().zip(factors) {
        bytes.extend(factor.to_le_bytes());
        bytes.extend(fit::<u32>(pattern.len() as f64, "number of samples")?.to_le_bytes());
    }
    for pattern in bank.patterns() {
        for (k, sample) in pattern.samples.iter().enumerate() {
            bytes.extend(record(sample, phase(pattern, k), path)?);
        }
    }
    sign(&mut bytes);
    Ok(bytes)
}

/// Identity and compensations of all samples from their bytes; none when these are no records.
///
/// # Errors
/// Message for the user if the bytes are damaged, or another path or feed is in them than that of `bank`.
pub fn decode(bytes: &[u8], bank: &PatternBank, path: &ProgrammedPath) -> Option<Result<PatternBank, String>> {
    bytes.strip_prefix(MAGIC).map(|rest| verify(bytes).and_then(|()| read(Bytes(rest), bank, path)))
}

fn read(mut from: Bytes, bank: &PatternBank, path: &ProgrammedPath) -> Result<PatternBank, String> {
    let print = u64::from_le_bytes(from.take()?);
    let mut pulses = [0.0; AXES];
    for pulse in &mut pulses {
        *pulse = f64::from_le_bytes(from.take()?);
    }
    let period = f64::from_le_bytes(from.take()?);
    let io_delay = u16::from_le_bytes(from.take()?);
    let count = u16::from_le_bytes(from.take()?);
    let mut factors = Vec::new();
    let mut lengths = Vec::new();
    for _ in 0..count {
        factors.push(f64::from_le_bytes(from.take()?));
        lengths.push(u32::from_le_bytes(from.take()?) as usize);
    }
    bank.identity().accepts(&Identity { path: print, pulses, period, io_delay, factors })?;
    let mut read = bank.clone();
    for (index, length) in lengths.into_iter().enumerate() {
        let pattern = read.pattern_mut(index);
        if pattern.len() != length {
            return Err(format!("pattern {} has `{length}` samples, must have `{}`", index + 1, pattern.len()));
        }
        for k in 0..length {
            let bytes: [u8; RECORD] = from.take()?;
            let compensation = joints(&bytes);
            let sample = Sample { compensation, ..pattern.samples[k] };
            if !alike(&record(&sample, phase(pattern, k), path)?, &bytes) {
                return Err(format!(
                    "sample {} of pattern {} is at another position or speed than planned",
                    k + 1,
                    index + 1
                ));
            }
            pattern.samples[k] = sample;
        }
        read.learned(index);
    }
    Ok(read)
}

/// 18 bytes of one sample.
fn record(sample: &Sample, phase: u32, path: &ProgrammedPath) -> Result<[u8; RECORD], String> {
    let position = path.locate(sample.point.distance);
    let mut bytes = [0; RECORD];
    for (i, value) in sample.compensation.iter().enumerate() {
        bytes[2 * i..2 * i + 2].copy_from_slice(&fit::<i16>(value.round(), "compensation in pulses")?.to_le_bytes());
    }
    let distance = fit::<u16>((position.distance / UNIT).round(), "distance in its block in 0.01 mm")?;
    let flags = fit::<u16>(((position.block as u32) << PHASE_BITS | phase).into(), "number of the block")?;
    let feed = fit::<u16>((sample.point.speed / UNIT).round(), "feed in 0.01 mm/s")?;
    for (i, value) in [distance, flags, feed].into_iter().enumerate() {
        bytes[12 + 2 * i..14 + 2 * i].copy_from_slice(&value.to_le_bytes());
    }
    Ok(bytes)
}

/// Whether two records are of the same position and feed, except rounding.
fn alike(a: &[u8; RECORD], b: &[u8; RECORD]) -> bool {
    let word = |bytes: &[u8; RECORD], at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    word(a, 14) == word(b, 14) && [12, 16].iter().all(|&at| word(a, at).abs_diff(word(b, at)) <= 1)
}

fn joints(bytes: &[u8; RECORD]) -> Joints {
    std::array::from_fn(|i| f64::from(i16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]])))
}

/// 0 before the start, 1 on the path, 2 after its end.
fn phase(pattern: &Pattern, k: usize) -> u32 {
    u32::from(k >= pattern.lead_in) + u32::from(k >= pattern.lead_in + pattern.run)
}

/// A whole number in the type of the file.
fn fit<T: TryFrom<i64>>(value: f64, what: &str) -> Result<T, String> {
    T::try_from(value as i64)
        .map_err(|_| format!("{what} is `{value}`, which does not fit; hint: `expert.bank.format` = Full"))
}

/// Bytes of a file that are not yet read.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (head, rest) = self.0.split_first_chunk().ok_or("it is truncated")?;
        self.0 = rest;
        Ok(*head)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bank::pattern_bank::tests::{numbered, path};

    #[test]
    fn whole_pulses_are_restored_with_18_bytes_a_sample() {
        let bank = numbered(|k| (k % 900) as f64 - 400.0);
        let bytes = encode(&bank, &path()).unwrap();
        let samples: usize = bank.patterns().iter().map(Pattern::len).sum();
        let header = MAGIC.len() + 8 + 7 * 8 + 4 + 5 * 12;
        assert_eq!(bytes.len(), header + RECORD * samples + 8);
        let empty = PatternBank::plan(&crate::interface::Parameters::START, &path()).unwrap();
        assert_eq!(decode(&bytes, &empty, &path()), Some(Ok(bank)));
    }

    #[test]
    fn what_does_not_fit_into_16_bits_is_reported() {
        let message = encode(&numbered(|k| 60.0 * k as f64), &path()).map(|bytes| bytes.len()).unwrap_err();
        assert!(message.contains("compensation in pulses is `3") && message.contains("hint:"), "{message}");
    }

    #[test]
    fn damaged_and_cut_records_are_rejected() {
        let bank = numbered(|k| k as f64);
        let bytes = encode(&bank, &path()).unwrap();
        for k in (0..bytes.len()).step_by(61) {
            let mut damaged = bytes.clone();
            damaged[k] ^= 1;
            assert!(decode(&damaged, &bank, &path()).is_none_or(|bank| bank.is_err()), "{k}");
            assert!(decode(&bytes[..k], &bank, &path()).is_none_or(|bank| bank.is_err()), "{k}");
        }
    }

    #[test]
    fn a_record_may_differ_by_a_unit_of_rounding_and_no_more() {
        let bank = numbered(|k| k as f64);
        let bytes = encode(&bank, &path()).unwrap();
        // distance and feed of the last record but one, then the flags of its block and phase
        let at = bytes.len() - 8 - 2 * RECORD;
        let changed = |word: usize, by: i16| {
            let mut bytes = bytes[..bytes.len() - 8].to_vec();
            let position = at + 12 + 2 * word;
            let value = u16::from_le_bytes([bytes[position], bytes[position + 1]]).wrapping_add_signed(by);
            bytes[position..position + 2].copy_from_slice(&value.to_le_bytes());
            sign(&mut bytes);
            decode(&bytes, &bank, &path()).unwrap()
        };
        for word in [0, 2] {
            assert!(changed(word, 1).is_ok() && changed(word, 2).is_err(), "{word}");
        }
        assert!(changed(0, -1).is_ok() && changed(0, -2).is_err());
        let message = changed(1, 1).unwrap_err();
        let (sample, pattern) = (bank.patterns()[4].len() - 1, 5);
        assert_eq!(
            message,
            format!("sample {sample} of pattern {pattern} is at another position or speed than planned")
        );
    }

    #[test]
    fn the_phase_is_before_on_and_after_the_path() {
        let bank = numbered(|k| k as f64);
        let pattern = &bank.patterns()[0];
        let end = pattern.lead_in + pattern.run;
        let phases = [0, pattern.lead_in - 1, pattern.lead_in, end - 1, end, pattern.len() - 1];
        assert_eq!(phases.map(|k| phase(pattern, k)), [0, 0, 1, 1, 2, 2]);
    }
}
