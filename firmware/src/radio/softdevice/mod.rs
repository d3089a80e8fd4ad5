//! Nordic's SoftDevice as a central.

mod link;

use nrf_softdevice::{
    Softdevice,
    ble::{Address, AddressType, central},
    raw,
};
use shared::myo::{self, AddressKind};

use super::{Advertisement, ConnectFailed, ConnectionHandler, Radio, driver::SessionDriver};
use crate::binding_region::Page;
use link::SoftdeviceLink;

/// Runs the session forever.
pub async fn run(softdevice: &Softdevice, driver: &SessionDriver<'_>, page: &mut impl Page) {
    driver.run(&mut SoftdeviceRadio { softdevice }, page).await;
}

struct SoftdeviceRadio<'s> {
    softdevice: &'s Softdevice,
}

/// Window and interval of a scan, in units of 0.625 ms. Equal: it scans all the time, which costs
/// nothing but power.
const SCAN_WINDOW: u32 = 96;

/// When an attempt to connect ends by itself, in units of 10 ms: before the session's time-out of 5 s would cancel
/// it. nrf-softdevice 0.1 panics if a connection was established in the moment of its cancellation.
const CONNECT_TIMEOUT: u16 = 450;

/// Units of 1.25 ms and 10 ms: 7.5 to 15 ms, no latency, 2 s. A longer interval loses data.
const PARAMETERS: raw::ble_gap_conn_params_t = raw::ble_gap_conn_params_t {
    min_conn_interval: 6,
    max_conn_interval: 12,
    slave_latency: 0,
    conn_sup_timeout: 200,
};

impl Radio for SoftdeviceRadio<'_> {
    async fn scan(&mut self, mut on_advertisement: impl FnMut(&Advertisement)) {
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
            on_advertisement(&Advertisement::new(address, report.rssi, data(report)));
            None::<()>
        });
        if let Err(error) = scan.await {
            defmt::warn!("the scan ended: {}", error);
        }
    }

    async fn connect(
        &mut self,
        address: myo::Address,
        handler: &impl ConnectionHandler,
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
                timeout: CONNECT_TIMEOUT,
                ..central::ScanConfig::default()
            },
            conn_params: PARAMETERS,
            att_mtu: None,
        };
        let connection = central::connect(self.softdevice, &config).await;
        let connection = connection.map_err(|error| {
            defmt::warn!("no connection: {}", error);
            ConnectFailed
        })?;
        let link = SoftdeviceLink::new(connection);
        handler.run(&link).await;
        link.disconnect();
        Ok(())
    }
}

/// The advertising data of a report.
#[expect(
    unsafe_code,
    reason = "the SoftDevice's report is a pointer and a length"
)]
fn data(report: &raw::ble_gap_evt_adv_report_t) -> &[u8] {
    if report.data.p_data.is_null() {
        return &[];
    }
    // SAFETY: `report` comes from the SoftDevice's event, so `p_data` points into the static scan
    // buffer of nrf-softdevice and `len` bytes of it are filled in. The SoftDevice writes that
    // buffer again only after the scan is resumed, and nrf-softdevice resumes it after the callback
    // that holds `report` has returned; the slice does not live longer than `report`.
    unsafe { core::slice::from_raw_parts(report.data.p_data, report.data.len.into()) }
}
