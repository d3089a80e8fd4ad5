//! The client of attributes (`ble_gattc.h`): one request at a time.

use super::SoftDevice;
use super::calls::answer;
use super::events::HANDLE;
use crate::air::AirRequest;
use crate::memory::{Memory, halves, take};
use crate::refusal::{What, needs};

/// A write that is answered (`BLE_GATT_OP_WRITE_REQ`).
pub(super) const WRITE_REQUEST: u8 = 1;

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
        let fields = take(memory, parameters, 12)?;
        needs(
            fields[0] == WRITE_REQUEST,
            "for a write that is not modelled: only requests are",
        )?;
        let [attribute, _, length, low, high] = halves(&fields, 2);
        let value = u32::from(low) | u32::from(high) << 16;
        let value = take(memory, value, length.into())?;
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
