//! The whole state of an instance, and its form as bytes.

use crate::host::phase::{FmuType, Phase};
use crate::instance::clock::Clock;
use crate::instance::slope::Derivative;
use crate::model::Experiment;
use crate::table::hash::{self, GUID};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// Everything that changes in an instance: saved, restored and serialized as one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Snapshot<V, M> {
    pub fmu_type: FmuType,
    pub phase: Phase,
    pub vars: V,
    /// Which parameters the importer has set, by their value references.
    pub is_set: Vec<bool>,
    /// Made at the end of initialization.
    pub running: Option<Running<M>>,
    /// Start and stop time, once fmi2SetupExperiment has set them.
    pub experiment: Option<Experiment>,
    /// Derivatives of Real inputs for the next step.
    pub derivatives: Vec<Derivative>,
}

/// The part that exists between initialization and reset.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Running<M> {
    pub model: M,
    pub clock: Clock,
    /// The communication point reached, or the time set, as the importer counts, s.
    pub time: f64,
}

const MAGIC: &[u8; 8] = b"FMU2ST\x03\n";
const LENGTH: usize = 8;
const HEADER: usize = MAGIC.len() + GUID + LENGTH;
const CHECKSUM: usize = 16;
/// Sizes are multiples of this, so that importers which ask for the size once only are served too.
const BLOCK: usize = 256;

/// Magic, GUID, payload length, payload, zeros up to a full block, checksum.
pub fn to_bytes<T: Serialize>(guid: &str, content: &T) -> Result<Vec<u8>, String> {
    let payload = postcard::to_allocvec(content).map_err(|error| format!("the state cannot be written: {error}"))?;
    let mut bytes = Vec::with_capacity(HEADER + payload.len() + BLOCK);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(guid.as_bytes());
    bytes.extend_from_slice(&(payload.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&payload);
    bytes.resize((bytes.len() + CHECKSUM).next_multiple_of(BLOCK) - CHECKSUM, 0);
    let sum = hash::fnv1a(hash::OFFSET, &bytes);
    bytes.extend_from_slice(&sum.to_le_bytes());
    Ok(bytes)
}

/// The content of state bytes of this very FMU.
///
/// # Errors
/// Says what is wrong with bytes that are foreign, damaged, too short or too long.
pub fn from_bytes<T: DeserializeOwned>(guid: &str, bytes: &[u8]) -> Result<T, String> {
    if bytes.len() < HEADER + CHECKSUM || bytes[..MAGIC.len()] != *MAGIC {
        return Err(format!("these {} bytes are no state of an FMU of this kind", bytes.len()));
    }
    let (body, sum) = bytes.split_at(bytes.len() - CHECKSUM);
    if hash::fnv1a(hash::OFFSET, body).to_le_bytes() != sum {
        return Err("the state bytes are damaged or not complete (checksum)".to_owned());
    }
    let (theirs, rest) = body[MAGIC.len()..].split_at(GUID);
    if theirs != guid.as_bytes() {
        let theirs = String::from_utf8_lossy(theirs);
        return Err(format!("the state bytes are of another FMU or version: GUID `{theirs}`, this one is `{guid}`"));
    }
    let (length, padded) = rest.split_at(LENGTH);
    let length = length.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte));
    let payload = usize::try_from(length).ok().and_then(|length| padded.get(..length));
    let payload = payload.ok_or("the state bytes are damaged (length)")?;
    match postcard::take_from_bytes(payload) {
        Ok((content, [])) => Ok(content),
        Ok(_) => Err("the state bytes are damaged (too long)".to_owned()),
        Err(error) => Err(format!("the state bytes are damaged: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OURS: &str = "01234567-89ab-cdef-0011-223344556677";

    fn sample() -> Vec<f64> {
        (0..40).map(f64::from).collect()
    }

    #[test]
    fn bytes_give_the_content_back_in_full_blocks() {
        let bytes = to_bytes(OURS, &sample()).unwrap();
        assert_eq!(bytes.len() % BLOCK, 0);
        assert_eq!(from_bytes::<Vec<f64>>(OURS, &bytes), Ok(sample()));
    }

    #[test]
    fn every_truncation_extension_and_flipped_bit_is_refused() {
        let bytes = to_bytes(OURS, &sample()).unwrap();
        for end in 0..bytes.len() {
            assert!(from_bytes::<Vec<f64>>(OURS, &bytes[..end]).is_err(), "{end} bytes");
        }
        for extra in [1, 16, 256] {
            let longer = [&bytes[..], &vec![0; extra]].concat();
            assert!(from_bytes::<Vec<f64>>(OURS, &longer).is_err(), "{extra} bytes more");
        }
        for bit in 0..bytes.len() * 8 {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(from_bytes::<Vec<f64>>(OURS, &damaged).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn bytes_of_another_fmu_are_refused_by_name() {
        let bytes = to_bytes("ffffffff-89ab-cdef-0011-223344556677", &sample()).unwrap();
        assert!(from_bytes::<Vec<f64>>(OURS, &bytes).unwrap_err().contains("another FMU"));
    }
}
