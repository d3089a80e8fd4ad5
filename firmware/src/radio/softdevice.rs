//! Nordic's SoftDevice as a central.

use core::cell::Cell;

use nrf_softdevice::{
    RawError, Softdevice,
    ble::{
        Address, AddressType, Connection, Uuid, central, gatt_client,
        gatt_client::{Client, Descriptor, DiscoverError, HvxType},
    },
    raw,
};
use shared::myo::{self, AddressKind, Characteristic, Service};

use super::{
    Advertisement, ConnectFailed, Conversation, Disconnected, Link, MOST_BYTES, OperationFailed,
    Radio, follow::Follower, handles::Handles,
};

/// Follows the armband for ever.
pub async fn run(softdevice: &Softdevice, follower: &Follower<'_>) {
    follower.follow(&mut Below { softdevice }).await;
}

/// The radio is the SoftDevice's.
struct Below<'s> {
    softdevice: &'s Softdevice,
}

/// Units of 0.625 ms. Scanning costs nothing but power, so it never pauses.
const SCAN_WINDOW: u32 = 96;

impl Radio for Below<'_> {
    async fn scan(&mut self, mut heard: impl FnMut(&Advertisement)) {
        let config = central::ScanConfig {
            active: false,
            extended: false,
            interval: SCAN_WINDOW,
            window: SCAN_WINDOW,
            ..central::ScanConfig::default()
        };
        let scan = central::scan(self.softdevice, &config, |report| {
            let address = Address::from_raw(report.peer_addr);
            let address = myo::Address {
                kind: match address.address_type() {
                    AddressType::Public => AddressKind::Public,
                    _ => AddressKind::Random,
                },
                bytes: address.bytes(),
            };
            heard(&Advertisement::new(address, report.rssi, bytes_of(report)));
            None::<()>
        });
        if let Err(error) = scan.await {
            defmt::warn!("the scan ended: {}", error);
        }
    }

    async fn connect(
        &mut self,
        address: myo::Address,
        conversation: &impl Conversation,
    ) -> Result<(), ConnectFailed> {
        let kind = match address.kind {
            AddressKind::Public => AddressType::Public,
            AddressKind::Random => AddressType::RandomStatic,
        };
        let address = Address::new(kind, address.bytes);
        let config = central::ConnectConfig {
            scan_config: central::ScanConfig {
                whitelist: Some(&[&address]),
                extended: false,
                interval: SCAN_WINDOW,
                window: SCAN_WINDOW,
                ..central::ScanConfig::default()
            },
            // Units of 1.25 ms and 10 ms: 7.5 to 15 ms, no latency, 2 s. A longer interval costs
            // data.
            conn_params: raw::ble_gap_conn_params_t {
                min_conn_interval: 6,
                max_conn_interval: 12,
                slave_latency: 0,
                conn_sup_timeout: 200,
            },
            att_mtu: None,
        };
        let connection = central::connect(self.softdevice, &config).await;
        let connection = connection.map_err(|error| {
            defmt::warn!("no connection: {}", error);
            ConnectFailed
        })?;
        let link = LinkBelow {
            connection,
            listening: Cell::new(false),
        };
        conversation.talk(&link).await;
        // An error says that the armband was first.
        let _ = link.connection.disconnect();
        Ok(())
    }
}

#[expect(
    unsafe_code,
    reason = "the SoftDevice's report is a pointer and a length"
)]
fn bytes_of(report: &raw::ble_gap_evt_adv_report_t) -> &[u8] {
    if report.data.p_data.is_null() {
        return &[];
    }
    // SAFETY: the SoftDevice filled that many bytes there, in a static buffer that it does not
    // touch again before the scan is resumed, which is after the report was looked at.
    unsafe { core::slice::from_raw_parts(report.data.p_data, report.data.len.into()) }
}

struct LinkBelow {
    connection: Connection,
    /// While set, the library's one place for events of the connection is taken.
    listening: Cell<bool>,
}

impl LinkBelow {
    /// Writes without waiting for the response, which goes to the listener and is ignored there:
    /// to wait for it would lose the notifications that come meanwhile. An armband that does not
    /// respond falls silent, and the session notices that.
    #[expect(
        unsafe_code,
        reason = "the library offers no write beside its listener"
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
        // SAFETY: the SoftDevice copies parameters and value before it returns.
        let answer = unsafe { raw::sd_ble_gattc_write(connection, &parameters) };
        RawError::convert(answer).map_err(|error| {
            defmt::warn!("a write was refused: {}", error);
            OperationFailed
        })
    }

    async fn discover_service<const SERVICE: usize>(
        &self,
        handles: &mut Handles,
    ) -> Result<(), OperationFailed> {
        let discovered: Discovered<SERVICE> = match gatt_client::discover(&self.connection).await {
            Ok(discovered) => discovered,
            // What is missing will be missed.
            Err(DiscoverError::ServiceNotFound) => return Ok(()),
            Err(error) => {
                defmt::warn!("discovery failed: {}", error);
                return Err(OperationFailed);
            }
        };
        for (characteristic, value, subscription) in discovered.0.into_iter().flatten() {
            handles.note(characteristic, value, subscription);
        }
        Ok(())
    }
}

impl Link for LinkBelow {
    async fn discover(&self) -> Result<Handles, OperationFailed> {
        const { assert!(Service::ALL.len() == 3) };
        let mut handles = Handles::default();
        self.discover_service::<0>(&mut handles).await?;
        self.discover_service::<1>(&mut handles).await?;
        self.discover_service::<2>(&mut handles).await?;
        Ok(handles)
    }

    async fn read(&self, handle: u16, value: &mut [u8]) -> Result<usize, OperationFailed> {
        if self.listening.get() {
            return Err(OperationFailed);
        }
        let read = gatt_client::read(&self.connection, handle, value).await;
        read.map_err(|error| {
            defmt::warn!("a read failed: {}", error);
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

    async fn listen(&self, mut notified: impl FnMut(u16, &[u8])) -> Disconnected {
        self.listening.set(true);
        gatt_client::run(&self.connection, &Listener, |value: Value| {
            notified(value.handle, &value.bytes[..value.length]);
        })
        .await;
        self.listening.set(false);
        Disconnected
    }
}

/// A notification.
struct Value {
    handle: u16,
    bytes: [u8; MOST_BYTES],
    length: usize,
}

/// What the library calls with every notification. It was not discovered: its methods for that
/// are never called.
struct Listener;

impl Client for Listener {
    type Event = Value;

    fn on_hvx(&self, _: &Connection, _: HvxType, handle: u16, data: &[u8]) -> Option<Value> {
        let mut bytes = [0; MOST_BYTES];
        let length = data.len().min(MOST_BYTES);
        bytes[..length].copy_from_slice(&data[..length]);
        Some(Value {
            handle,
            bytes,
            length,
        })
    }

    fn uuid() -> Uuid {
        uuid(Service::Emg.uuid())
    }

    fn new_undiscovered(_: Connection) -> Self {
        Self
    }

    fn discovered_characteristic(&mut self, _: &gatt_client::Characteristic, _: &[Descriptor]) {}

    fn discovery_complete(&mut self) -> Result<(), DiscoverError> {
        Ok(())
    }
}

/// What was found in the service of that place in [`Service::ALL`]: characteristic, handle of the
/// value, handle of the subscription.
struct Discovered<const SERVICE: usize>(
    [Option<(Characteristic, u16, Option<u16>)>; Characteristic::ALL.len()],
);

impl<const SERVICE: usize> Client for Discovered<SERVICE> {
    type Event = ();

    fn on_hvx(&self, _: &Connection, _: HvxType, _: u16, _: &[u8]) -> Option<()> {
        None
    }

    fn uuid() -> Uuid {
        uuid(Service::ALL[SERVICE].uuid())
    }

    fn new_undiscovered(_: Connection) -> Self {
        Self([None; Characteristic::ALL.len()])
    }

    fn discovered_characteristic(
        &mut self,
        found: &gatt_client::Characteristic,
        descriptors: &[Descriptor],
    ) {
        const SUBSCRIPTION: Uuid = Uuid::new_16(0x2902);
        let is_it = |known: &Characteristic| found.uuid == Some(uuid(known.uuid()));
        if let Some(characteristic) = Characteristic::ALL.into_iter().find(is_it) {
            let subscription = descriptors
                .iter()
                .find(|descriptor| descriptor.uuid == Some(SUBSCRIPTION))
                .map(|descriptor| descriptor.handle);
            self.0[characteristic.index()] =
                Some((characteristic, found.handle_value, subscription));
        }
    }

    fn discovery_complete(&mut self) -> Result<(), DiscoverError> {
        Ok(())
    }
}

/// The SoftDevice's own form; the vendor's family is registered with it by the first use, and
/// found again by all others.
fn uuid(uuid: myo::Uuid) -> Uuid {
    match uuid {
        myo::Uuid::Sig(short) => Uuid::new_16(short),
        myo::Uuid::Vendor(_) => Uuid::new_128(&uuid.to_le_bytes()),
    }
}
