//! The client of attributes (`ble_gattc.h`): one request at a time.

use super::calls::answer;
use super::events::HANDLE;
use super::{SoftDevice, wrong};
use crate::air::AirRequest;
use crate::memory::Memory;
use crate::refusal::What;

/// A write that is answered (`BLE_GATT_OP_WRITE_REQ`).
const WRITE_REQUEST: u8 = 1;

impl SoftDevice {
    pub(super) fn read_attribute(&mut self, handle: u16, attribute: u16) -> u32 {
        self.request(handle, AirRequest::Read(attribute))
    }

    pub(super) fn write_attribute(
        &mut self,
        handle: u16,
        parameters: u32,
        memory: &Memory,
    ) -> Result<u32, What> {
        // `ble_gattc_write_params_t`.
        let fields = memory.read(parameters, 8).zip(memory.word(parameters + 8));
        let Some((fields, value)) = fields else {
            return Err(wrong("with parameters that are no memory"));
        };
        let [operation, _, a, b, _, _, c, d] = fields[..] else {
            return Ok(answer::INVALID_PARAM);
        };
        if operation != WRITE_REQUEST {
            let why = "for a write that is not modelled: only requests are";
            return Err(wrong(why));
        }
        let (attribute, length) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
        let Some(value) = memory.read(value, length.into()) else {
            return Err(wrong("with a value that is no memory"));
        };
        Ok(self.request(handle, AirRequest::Write(attribute, value)))
    }

    fn request(&mut self, handle: u16, request: AirRequest) -> u32 {
        if handle != HANDLE || !self.air.is_linked() {
            return answer::INVALID_CONN_HANDLE;
        }
        match self.air.request(request) {
            true => answer::SUCCESS,
            false => answer::BUSY,
        }
    }
}
