//! Nordic's SoftDevice as a central.

mod ending;
mod link;

use core::future::{Future as _, poll_fn};
use core::pin::pin;
use core::task::Poll;

use embassy_time::{Duration, with_timeout};
use nrf_softdevice::{
    Softdevice,
    ble::{Address, AddressType, Connection, central},
    raw,
};
use shared::myo::{self, AddressKind, ConnectionParameters};

use super::{
    Advertisement, ConnectFailed, ConnectionHandler, Pace, REST, Radio, SCAN_SECONDS, Scanned,
    driver::SessionDriver,
};
use crate::flash::{Flash, SharedFlash};
use ending::Ending;
use link::SoftdeviceLink;

pub async fn run(
    softdevice: &Softdevice,
    driver: &SessionDriver<'_>,
    flash: &SharedFlash<impl Flash>,
) {
    let mut radio = SoftdeviceRadio {
        softdevice,
        ending: Ending::default(),
    };
    driver.run(&mut radio, flash).await;
}

struct SoftdeviceRadio<'s> {
    softdevice: &'s Softdevice,
    ending: Ending,
}

/// Window of a scan, in units of 0.625 ms.
const SCAN_WINDOW: u32 = 96;

/// Time after which an attempt to connect ends by itself, in units of 10 ms: before the session's time-out of 5 s cancels
/// it. nrf-softdevice 0.1 panics if a connection was established in the moment of its cancellation.
const CONNECT_TIMEOUT: u16 = 450;

/// Time after which an attempt to connect is over in any case: after its own end, and before the session's.
const CONNECT_LIMIT: Duration = Duration::from_millis(4_700);

/// Connection parameters as the SoftDevice's type, which has the same units.
const fn raw_parameters(parameters: ConnectionParameters) -> raw::ble_gap_conn_params_t {
    raw::ble_gap_conn_params_t {
        min_conn_interval: parameters.min_interval,
        max_conn_interval: parameters.max_interval,
        slave_latency: parameters.latency,
        conn_sup_timeout: parameters.supervision_timeout,
    }
}

/// Connects; polls the library only while the connection lasts.
///
/// nrf-softdevice 0.1 asks for the ATT MTU right after a connection was established and unwraps the answer, an error where
/// the connection has ended before the program's turn. Then it is not asked again, and the attempt ends by its limit. What
/// that costs is one of the library's 20 records of connections, until the next start.
async fn established(
    softdevice: &Softdevice,
    config: &central::ConnectConfig<'_>,
) -> Result<Connection, ConnectFailed> {
    let mut attempt = pin!(central::connect(softdevice, config));
    let mut begun = false;
    let connected = poll_fn(|context| {
        let lasts = Connection::iter().next().is_some();
        if begun && !lasts {
            // The attempt has this task's waker since its first poll.
            return Poll::Pending;
        }
        begun = true;
        attempt.as_mut().poll(context)
    });
    match with_timeout(CONNECT_LIMIT, connected).await {
        Ok(Ok(connection)) => Ok(connection),
        Ok(Err(error)) => {
            defmt::warn!("no connection: {}", error);
            Err(ConnectFailed)
        }
        Err(_) => Err(ConnectFailed),
    }
}

impl Radio for SoftdeviceRadio<'_> {
    // A page takes 85 ms, and the events of a link follow each other without a pause.
    const LEAVES_FLASH_TIME: bool = false;

    async fn silence(&mut self) {
        self.ending.finished().await;
    }

    async fn scan(&mut self, pace: impl Fn() -> Pace, mut report: impl FnMut(Scanned<'_>)) {
        self.ending.finished().await;
        loop {
            let config = central::ScanConfig {
                active: false,
                extended: false,
                interval: match pace() {
                    Pace::Always => SCAN_WINDOW,
                    Pace::Seldom => SCAN_WINDOW * u32::from(REST),
                },
                window: SCAN_WINDOW,
                timeout: SCAN_SECONDS * 100,
                ..central::ScanConfig::default()
            };
            let scan = central::scan(self.softdevice, &config, |found| {
                report(Scanned::Advertisement(&advertisement(found)));
                None::<()>
            });
            match scan.await {
                // An event of the SoftDevice's, which is alive then.
                Err(central::ScanError::Timeout) => report(Scanned::Answered),
                Err(error) => return defmt::warn!("the scan ended: {}", error),
                Ok(()) => return,
            }
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
            conn_params: raw_parameters(ConnectionParameters::OURS),
            att_mtu: None,
        };
        self.ending.finished().await;
        let connection = established(self.softdevice, &config).await?;
        let link = SoftdeviceLink::new(connection, &self.ending);
        handler.run(&link).await;
        Ok(())
    }
}

fn advertisement(report: &raw::ble_gap_evt_adv_report_t) -> Advertisement {
    let address = Address::from_raw(report.peer_addr);
    let address = myo::Address {
        // Not `address_type`, which unwraps: a sender may have an address of a kind that the library does not know.
        kind: if address.flags >> 1 == AddressType::Public as u8 {
            AddressKind::Public
        } else {
            AddressKind::Random
        },
        bytes: address.bytes(),
    };
    Advertisement::new(address, report.rssi, data(report))
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
