//! Recognises an armband by its advertisement.

use super::uuid::Uuid;

/// AD type "incomplete list of 128-bit service UUIDs": what a Myo sends. The complete list is accepted too.
const SOME_UUIDS_128: u8 = 0x06;
const ALL_UUIDS_128: u8 = 0x07;

/// Whether the advertising data list the Control service.
///
/// The name is ignored: the wearer can change it. Truncated data are read as far as they go.
#[must_use]
pub(super) fn offers_control(data: &[u8]) -> bool {
    structures(data)
        .filter(|(kind, _)| matches!(*kind, SOME_UUIDS_128 | ALL_UUIDS_128))
        .flat_map(|(_, uuids)| uuids.as_chunks::<16>().0)
        .any(|uuid| *uuid == Uuid::CONTROL.to_le_bytes())
}

/// The AD structures as (type, value). In the data a length byte, which counts type and value, comes
/// first; a length of zero ends them.
fn structures(mut data: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    core::iter::from_fn(move || {
        let (length, rest) = data.split_first()?;
        let (structure, rest) = rest.split_at_checked(usize::from(*length))?;
        data = rest;
        let (kind, value) = structure.split_first()?;
        Some((*kind, value))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    fn listing(kind: u8, uuids: &[Uuid]) -> Vec<u8> {
        let mut data = Vec::from([1 + 16 * uuids.len() as u8, kind]);
        data.extend(uuids.iter().flat_map(|uuid| uuid.to_le_bytes()));
        data
    }

    /// The payload of a real armband: a padded short name, flags, the list.
    fn captured() -> Vec<u8> {
        let mut data = b"\x09\x08Myo\0\0\0\0\0\x02\x01\x06".to_vec();
        data.extend(listing(0x06, &[Uuid::CONTROL]));
        data
    }

    #[test]
    fn an_armband_is_recognised_by_either_list() {
        assert_eq!(captured().len(), 31);
        assert!(offers_control(&captured()));
        let others = [Uuid::Vendor(2), Uuid::CONTROL];
        assert!(offers_control(&listing(0x07, &others)));
    }

    #[test]
    fn a_name_or_another_list_is_not_an_armband() {
        assert!(!offers_control(b"\x04\x09Myo"));
        assert!(!offers_control(&listing(0x06, &[Uuid::Vendor(2)])));
        assert!(!offers_control(&listing(0x15, &[Uuid::CONTROL])));
    }
}
