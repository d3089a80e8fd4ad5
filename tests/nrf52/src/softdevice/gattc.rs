//! The client of attributes (`ble_gattc.h`): one request at a time.

use super::calls::{answer, attribute};
use super::events::{HANDLE, air_us};
use super::{SoftDevice, events, refused};
use crate::memory::Memory;
use crate::refusal::What;

/// Bytes that an answer has room for: an ATT MTU of 23 without its header.
const MOST: usize = 22;
/// A write that is answered (`BLE_GATT_OP_WRITE_REQ`).
const WRITE_REQUEST: u8 = 1;

/// A request to the armband's attributes.
#[derive(Debug)]
pub enum Request {
    /// Read of an attribute, by its handle.
    Read(u16),
    /// Write of an attribute, by its handle, with the bytes.
    Write(u16, Vec<u8>),
}

impl SoftDevice {
    pub(super) fn read_attribute(&mut self, handle: u16, attribute: u16) -> u32 {
        self.request(handle, Request::Read(attribute))
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
            return Err(refused("with parameters that are no memory"));
        };
        let [operation, _, a, b, _, _, c, d] = fields[..] else {
            return Ok(answer::INVALID_PARAM);
        };
        if operation != WRITE_REQUEST {
            let why = "for a write that is not modelled: only requests are";
            return Err(refused(why));
        }
        let (attribute, length) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
        let Some(value) = memory.read(value, length.into()) else {
            return Err(refused("with a value that is no memory"));
        };
        Ok(self.request(handle, Request::Write(attribute, value)))
    }

    fn request(&mut self, handle: u16, request: Request) -> u32 {
        let Some(link) = self.link.as_mut().filter(|_| handle == HANDLE) else {
            return answer::INVALID_CONN_HANDLE;
        };
        if link.request.is_some() || link.response.is_some() {
            return answer::BUSY;
        }
        link.request = Some(request);
        answer::SUCCESS
    }

    /// The armband takes the request, at a connection event.
    pub(super) fn carry_request_out(&mut self, now: u64) {
        let Some(link) = &mut self.link else {
            return;
        };
        let armband = &mut self.armbands[link.armband];
        link.response = match link.request.take() {
            None => return,
            Some(Request::Read(attribute)) => {
                let value = armband.read(attribute);
                let value = match &value {
                    Some(value) => Ok(&value[..value.len().min(MOST)]),
                    None => Err(attribute::READ_NOT_PERMITTED),
                };
                Some(events::read(HANDLE, attribute, value))
            }
            Some(Request::Write(attribute, value)) => {
                let is_taken = armband.write(attribute, &value, air_us(now));
                let status = if is_taken {
                    0
                } else {
                    attribute::WRITE_NOT_PERMITTED
                };
                Some(events::written(HANDLE, attribute, status))
            }
        };
    }
}
