//! Flash record of the bound armband: any 16 bytes.

use shared::myo::binding::{RECORD_BYTES, from_record, to_record};

use crate::input::Input;

/// Takes a record, unchanged and with its checksum made right.
pub fn run(data: &[u8]) {
    let mut record: [u8; RECORD_BYTES] = Input(data).array();
    check(&record);
    let (content, checksum) = record.split_at_mut(RECORD_BYTES - 4);
    let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(content);
    checksum.copy_from_slice(&sum.to_le_bytes());
    check(&record);
}

fn check(record: &[u8; RECORD_BYTES]) {
    if let Some(armband) = from_record(record) {
        assert_eq!(to_record(armband), *record, "what is read is written back");
        assert!(record.starts_with(b"MyoB\x01"));
    }
}
