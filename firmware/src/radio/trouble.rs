//! The Bluetooth host `trouble` as a central, on any HCI controller: Nordic's library on a chip, on
//! a PC one that another program simulates.

use core::{future::poll_fn, task::Poll};

use bt_hci::{
    cmd::le::{
        LeAddDeviceToFilterAcceptList, LeClearFilterAcceptList, LeCreateConn, LeSetScanEnable,
        LeSetScanParams,
    },
    controller::{ControllerCmdAsync, ControllerCmdSync},
    param::{AddrKind, BdAddr, LeAdvReportsIter},
};
use embassy_futures::select::{Either, select};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, channel::Channel, mutex::Mutex};
use embassy_time::{Duration, with_timeout};
use shared::myo::{self, AddressKind, ConnectionParameters};
use trouble_host::{
    Address, Controller, HostResources, Stack,
    central::Central,
    connection::{ConnectConfig, RequestedConnParams, ScanConfig},
    gatt::{GattClient, NotificationListener},
    prelude::{DefaultPacketPool, EventHandler},
    scan::Scanner,
};

use super::{
    Advertisement, ConnectFailed, ConnectionHandler, Disconnected, Link, OperationFailed, Pace,
    REST, Radio, SCAN_SECONDS, Scanned, driver::SessionDriver, guarded::Guarded,
};
use crate::flash::{Flash, SharedFlash};

/// Bytes of a notification that are kept, as the `mtu` feature of the packet pool sets them.
const NOTIFICATION_BYTES: usize = trouble_host::config::GATT_CLIENT_NOTIFICATION_MTU;
/// Services that the client keeps: it looks for no service.
const MAX_SERVICES: usize = 1;

const SCAN_WINDOW: Duration = Duration::from_millis(60);

/// The session's connection parameters, in the units of this host.
const LINK: RequestedConnParams = RequestedConnParams {
    min_connection_interval: interval(OURS.min_interval),
    max_connection_interval: interval(OURS.max_interval),
    max_latency: OURS.latency,
    min_event_length: Duration::from_ticks(0),
    max_event_length: interval(OURS.max_interval),
    supervision_timeout: Duration::from_millis(OURS.supervision_timeout as u64 * 10),
};
const OURS: ConnectionParameters = ConnectionParameters::OURS;

/// A connection interval, from units of 1.25 ms.
const fn interval(units: u16) -> Duration {
    Duration::from_micros(units as u64 * 1_250)
}

/// The commands that this central needs of a controller: legacy scanning and connecting.
pub trait CentralController:
    Controller
    + ControllerCmdSync<LeSetScanParams>
    + ControllerCmdSync<LeSetScanEnable>
    + ControllerCmdSync<LeClearFilterAcceptList>
    + ControllerCmdSync<LeAddDeviceToFilterAcceptList>
    + ControllerCmdAsync<LeCreateConn>
{
}

impl<C> CentralController for C where
    C: Controller
        + ControllerCmdSync<LeSetScanParams>
        + ControllerCmdSync<LeSetScanEnable>
        + ControllerCmdSync<LeClearFilterAcceptList>
        + ControllerCmdSync<LeAddDeviceToFilterAcceptList>
        + ControllerCmdAsync<LeCreateConn>
{
}

/// Runs the host and the session until the controller fails.
///
/// `own_address` is the central's random static address: its two highest bits are ones.
pub async fn run<C: CentralController>(
    controller: C,
    own_address: [u8; 6],
    driver: &SessionDriver<'_>,
    flash: &SharedFlash<impl Flash>,
) {
    let mut resources: HostResources<DefaultPacketPool, 1, 1> = HostResources::new();
    let advertisements = Advertisements(Channel::new());
    let stack = trouble_host::new(Guarded(controller), &mut resources)
        .set_random_address(Address::random(own_address))
        .build();
    let mut runner = stack.runner();
    let mut radio = TroubleRadio {
        stack: &stack,
        central: stack.central(),
        advertisements: &advertisements,
    };
    // The host returns only where the controller fails: the board restarts then, and whatever the session was at is lost.
    select(
        runner.run_with_handler(&advertisements),
        driver.run(&mut radio, flash),
    )
    .await;
}

/// Advertisements on their way from the host to the scan. One that finds it full is dropped: its
/// sender repeats it.
struct Advertisements(Channel<NoopRawMutex, Advertisement, 4>);

impl EventHandler for Advertisements {
    fn on_adv_reports(&self, reports: LeAdvReportsIter<'_>) {
        for report in reports.flatten() {
            let mut bytes = [0; 6];
            bytes.copy_from_slice(report.addr.raw());
            let address = myo::Address {
                kind: if report.addr_kind == AddrKind::PUBLIC {
                    AddressKind::Public
                } else {
                    AddressKind::Random
                },
                bytes,
            };
            let advertisement = Advertisement::new(address, report.rssi, report.data);
            let _ = self.0.try_send(advertisement);
        }
    }
}

struct TroubleRadio<'s, 'r, C: Controller> {
    stack: &'s Stack<'r, C, DefaultPacketPool>,
    central: Central<'s, C, DefaultPacketPool>,
    advertisements: &'s Advertisements,
}

/// Whether the host has a connection beside a scan: one that is still ending, or one that was made while its attempt was
/// cancelled. Nobody can end the latter, and its armband does not advertise: the session hears nothing, and the watchdog
/// restarts the board.
fn is_held<C: Controller>(stack: &Stack<'_, C, DefaultPacketPool>) -> bool {
    let links = stack.metrics(|host| host.connect_events.wrapping_sub(host.disconnect_events));
    links.cast_signed() > 0
}

impl<C: CentralController> Radio for TroubleRadio<'_, '_, C> {
    // Nordic's scheduler erases a page in parts, between radio events.
    const LEAVES_FLASH_TIME: bool = true;

    async fn silence(&mut self) {}

    async fn scan(&mut self, pace: impl Fn() -> Pace, mut report: impl FnMut(Scanned<'_>)) {
        self.advertisements.0.clear();
        let stack = self.stack;
        let mut report = |scanned: Scanned<'_>| {
            if !is_held(stack) {
                report(scanned);
            }
        };
        let mut scanner = Scanner::new(&mut self.central);
        loop {
            let config = ScanConfig {
                active: false,
                interval: match pace() {
                    Pace::Always => SCAN_WINDOW,
                    Pace::Seldom => SCAN_WINDOW * u32::from(REST),
                },
                window: SCAN_WINDOW,
                ..ScanConfig::default()
            };
            let Ok(_session) = scanner.scan(&config).await else {
                return;
            };
            report(Scanned::Answered);
            let advertisements = async {
                loop {
                    let advertisement = self.advertisements.0.receive().await;
                    report(Scanned::Advertisement(&advertisement));
                }
            };
            // Then the session is dropped, which ends the scan.
            let _ = with_timeout(Duration::from_secs(SCAN_SECONDS.into()), advertisements).await;
        }
    }

    async fn connect(
        &mut self,
        address: myo::Address,
        handler: &impl ConnectionHandler,
    ) -> Result<(), ConnectFailed> {
        let kind = match address.kind {
            AddressKind::Public => AddrKind::PUBLIC,
            AddressKind::Random => AddrKind::RANDOM,
        };
        let address = Address::new(kind, BdAddr::new(address.bytes));
        let config = ConnectConfig {
            scan_config: ScanConfig {
                filter_accept_list: &[address],
                interval: SCAN_WINDOW,
                window: SCAN_WINDOW,
                ..ScanConfig::default()
            },
            connect_params: LINK,
        };
        // If the armband drops the link at once, both events are handled before this task runs: the
        // host has removed the connection, and `connect` would wait forever. The host also counts
        // connections. `connect` is polled first, so a connection that was counted and that
        // `connect` did not return has ended.
        let established = || self.stack.metrics(|host| host.connect_events);
        let before = established();
        let missed = poll_fn(|_| {
            if established() == before {
                Poll::Pending
            } else {
                Poll::Ready(())
            }
        });
        // The dropped future loses nothing: a flag, or an attempt whose connection has ended.
        let connection = match select(self.central.connect(&config), missed).await {
            Either::First(connection) => connection.map_err(|_| ConnectFailed)?,
            Either::Second(()) => return Err(ConnectFailed),
        };
        let client: GattClient<'_, C, DefaultPacketPool, MAX_SERVICES> =
            GattClient::new(self.stack, &connection)
                .await
                .map_err(|_| ConnectFailed)?;
        // Before any subscription: the host drops notifications that have no listener.
        let listener = client.listen_all().map_err(|_| ConnectFailed)?;
        let link = TroubleLink {
            client: &client,
            listener: Mutex::new(listener),
        };
        // Only the client's task notices the end of the connection, and ends then. The handler's request has no answer any more.
        select(client.task(), handler.run(&link)).await;
        connection.disconnect();
        Ok(())
    }
}

struct TroubleLink<'c, C: Controller> {
    client: &'c GattClient<'c, C, DefaultPacketPool, MAX_SERVICES>,
    listener: Mutex<NoopRawMutex, NotificationListener<'c, NOTIFICATION_BYTES>>,
}

impl<C: CentralController> Link for TroubleLink<'_, C> {
    async fn read(&self, handle: u16, value: &mut [u8]) -> Result<usize, OperationFailed> {
        let read = self.client.read_handle(handle, value).await;
        read.map_err(|_| OperationFailed)
    }

    async fn write(&self, handle: u16, value: &[u8]) -> Result<(), OperationFailed> {
        let written = self.client.write_handle(handle, value).await;
        written.map_err(|_| OperationFailed)
    }

    async fn listen(&self, mut on_notification: impl FnMut(u16, &[u8])) -> Disconnected {
        let mut listener = self.listener.lock().await;
        loop {
            let notification = listener.next().await;
            on_notification(notification.handle(), notification.as_ref());
        }
    }
}
