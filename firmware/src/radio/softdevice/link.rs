//! A connection that the SoftDevice holds.

use core::cell::Cell;

use embassy_futures::select::select;
use embassy_time::{Duration, Ticker};
use nrf_softdevice::{
    RawError,
    ble::{
        Connection, Uuid,
        gatt_client::{self, Client, Descriptor, DiscoverError, HvxType},
    },
    raw,
};
use shared::myo::{ConnectionParameters, LOOK_MS, ParameterHold};

use super::ending::Ending;
use super::raw_parameters;
use crate::radio::{Disconnected, Link, MAX_VALUE_BYTES, OperationFailed};

pub struct SoftdeviceLink<'e> {
    connection: Connection,
    /// Whether the connection's only event portal of nrf-softdevice is occupied.
    listening: Cell<bool>,
    ending: &'e Ending,
}

impl<'e> SoftdeviceLink<'e> {
    /// Link of a new connection, which is handed to `ending` when the link is dropped.
    pub fn new(connection: Connection, ending: &'e Ending) -> Self {
        Self {
            connection,
            listening: Cell::new(false),
            ending,
        }
    }
    /// Writes without waiting for the response, which goes to [`Listener`] and is ignored there:
    /// waiting for it would lose the notifications that arrive meanwhile. An armband that does not
    /// respond stops streaming, and the session notices that.
    #[expect(
        unsafe_code,
        reason = "nrf-softdevice offers no write while it listens"
    )]
    fn write_while_listening(&self, handle: u16, value: &[u8]) -> Result<(), OperationFailed> {
        let connection = self.connection.handle().ok_or(OperationFailed)?;
        let parameters = raw::ble_gattc_write_params_t {
            write_op: raw::BLE_GATT_OP_WRITE_REQ as u8,
            flags: 0,
            handle,
            offset: 0,
            len: u16::try_from(value.len()).map_err(|_| OperationFailed)?,
            p_value: value.as_ptr(),
        };
        // SAFETY: a `Connection` exists only while the SoftDevice is enabled, which the call
        // requires. `parameters` and the `len` bytes at `p_value` are borrowed until it returns,
        // and the SoftDevice copies both before that. A handle of a connection that has ended
        // meanwhile, or of no attribute, is answered with an error code.
        let code = unsafe { raw::sd_ble_gattc_write(connection, &parameters) };
        RawError::convert(code).map_err(|error| {
            defmt::warn!("a write was refused: {}", error);
            OperationFailed
        })
    }
}

impl SoftdeviceLink<'_> {
    /// Asks for our connection parameters again when others are in force, as [`ParameterHold`] says: nrf-softdevice grants
    /// the armband whatever it asks for.
    async fn hold_parameters(&self) -> ! {
        let mut hold = ParameterHold::default();
        let mut ticker = Ticker::every(Duration::from_millis(LOOK_MS.into()));
        loop {
            ticker.next().await;
            let found = self.connection.conn_params();
            let found = ConnectionParameters {
                min_interval: found.min_conn_interval,
                max_interval: found.max_conn_interval,
                latency: found.slave_latency,
                supervision_timeout: found.conn_sup_timeout,
            };
            if let Some(wanted) = hold.look(found) {
                defmt::warn!("the armband changed the interval to {}", found.max_interval);
                // An error says that the connection has ended, or that an update is under way.
                let _ = self.connection.set_conn_params(raw_parameters(wanted));
            }
        }
    }
}

impl Drop for SoftdeviceLink<'_> {
    fn drop(&mut self) {
        self.ending.begin(self.connection.clone());
    }
}

impl Link for SoftdeviceLink<'_> {
    async fn read(&self, handle: u16, value: &mut [u8]) -> Result<usize, OperationFailed> {
        if self.listening.get() {
            return Err(OperationFailed);
        }
        let read = gatt_client::read(&self.connection, handle, value).await;
        read.map_err(|error| {
            // Usual during discovery, which reads attributes that may not be read.
            defmt::debug!("a read failed: {}", error);
            OperationFailed
        })
    }

    async fn write(&self, handle: u16, value: &[u8]) -> Result<(), OperationFailed> {
        if self.listening.get() {
            return self.write_while_listening(handle, value);
        }
        let written = gatt_client::write(&self.connection, handle, value).await;
        written.map_err(|error| {
            defmt::warn!("a write failed: {}", error);
            OperationFailed
        })
    }

    async fn listen(&self, mut on_notification: impl FnMut(u16, &[u8])) -> Disconnected {
        self.listening.set(true);
        let run = gatt_client::run(&self.connection, &Listener, |value: Value| {
            on_notification(value.handle, &value.bytes[..value.length]);
        });
        // The end of the connection drops the future that asks for its parameters.
        select(run, self.hold_parameters()).await;
        self.listening.set(false);
        Disconnected
    }
}

struct Value {
    handle: u16,
    bytes: [u8; MAX_VALUE_BYTES],
    length: usize,
}

/// The client that nrf-softdevice calls with every notification. It is used without discovery, so
/// its methods for that are never called.
struct Listener;

impl Client for Listener {
    type Event = Value;

    fn on_hvx(&self, _: &Connection, _: HvxType, handle: u16, data: &[u8]) -> Option<Value> {
        let mut bytes = [0; MAX_VALUE_BYTES];
        let length = data.len().min(MAX_VALUE_BYTES);
        bytes[..length].copy_from_slice(&data[..length]);
        Some(Value {
            handle,
            bytes,
            length,
        })
    }

    fn uuid() -> Uuid {
        // Of no service: nothing is discovered with it.
        Uuid::new_16(0)
    }

    fn new_undiscovered(_: Connection) -> Self {
        Self
    }

    fn discovered_characteristic(&mut self, _: &gatt_client::Characteristic, _: &[Descriptor]) {}

    fn discovery_complete(&mut self) -> Result<(), DiscoverError> {
        Ok(())
    }
}
