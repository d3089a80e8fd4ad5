//! The Bluetooth host `trouble`, over whatever controller speaks HCI: Nordic's library on the
//! board, a UART in the emulator.

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
use embassy_time::Duration;
use shared::myo::{self, AddressKind, Characteristic, Service};
use trouble_host::{
    Address, Controller, HostResources, Stack,
    central::Central,
    connection::{ConnectConfig, RequestedConnParams, ScanConfig},
    gatt::{GattClient, NotificationListener},
    prelude::{DefaultPacketPool, EventHandler, Uuid},
    scan::Scanner,
};

use super::{
    Advertisement, ConnectFailed, Conversation, Disconnected, Link, OperationFailed, Radio,
    follow::Follower, handles::Handles,
};

/// Bytes of a notification that are kept, as the `mtu` feature of the packet pool sets them.
const NOTIFICATION_BYTES: usize = trouble_host::config::GATT_CLIENT_NOTIFICATION_MTU;
/// Services that the client keeps: those that are looked for.
const MOST_SERVICES: usize = Service::ALL.len();
/// Characteristics of one service: EMG has four, Control three.
const MOST_CHARACTERISTICS: usize = 6;

/// Scanning costs nothing but power, so it never pauses.
const SCAN_WINDOW: Duration = Duration::from_millis(60);

/// A longer interval costs data, a latency would too.
const LINK: RequestedConnParams = RequestedConnParams {
    min_connection_interval: Duration::from_micros(7_500),
    max_connection_interval: Duration::from_millis(15),
    max_latency: 0,
    min_event_length: Duration::from_ticks(0),
    max_event_length: Duration::from_millis(15),
    supervision_timeout: Duration::from_secs(2),
};

/// What this central needs of a controller: legacy scanning and connecting, as the armband's.
pub trait Capable:
    Controller
    + ControllerCmdSync<LeSetScanParams>
    + ControllerCmdSync<LeSetScanEnable>
    + ControllerCmdSync<LeClearFilterAcceptList>
    + ControllerCmdSync<LeAddDeviceToFilterAcceptList>
    + ControllerCmdAsync<LeCreateConn>
{
}

impl<C> Capable for C where
    C: Controller
        + ControllerCmdSync<LeSetScanParams>
        + ControllerCmdSync<LeSetScanEnable>
        + ControllerCmdSync<LeClearFilterAcceptList>
        + ControllerCmdSync<LeAddDeviceToFilterAcceptList>
        + ControllerCmdAsync<LeCreateConn>
{
}

/// Runs the host and follows the armband, until the controller fails.
///
/// `own` is the central's random static address: its two highest bits are ones.
pub async fn run<C: Capable>(controller: C, own: [u8; 6], follower: &Follower<'_>) {
    let mut resources: HostResources<DefaultPacketPool, 1, 1> = HostResources::new();
    let heard = Heard(Channel::new());
    let stack = trouble_host::new(controller, &mut resources)
        .set_random_address(Address::random(own))
        .build();
    let mut runner = stack.runner();
    let mut radio = Trouble {
        stack: &stack,
        central: stack.central(),
        heard: &heard,
    };
    select(runner.run_with_handler(&heard), follower.follow(&mut radio)).await;
}

/// Advertisements on their way from the host to the scan; what it has no room for will be
/// repeated by its sender.
struct Heard(Channel<NoopRawMutex, Advertisement, 4>);

impl EventHandler for Heard {
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

struct Trouble<'s, 'r, C: Controller> {
    stack: &'s Stack<'r, C, DefaultPacketPool>,
    central: Central<'s, C, DefaultPacketPool>,
    heard: &'s Heard,
}

impl<C: Capable> Radio for Trouble<'_, '_, C> {
    async fn scan(&mut self, mut heard: impl FnMut(&Advertisement)) {
        let config = ScanConfig {
            active: false,
            interval: SCAN_WINDOW,
            window: SCAN_WINDOW,
            ..ScanConfig::default()
        };
        self.heard.0.clear();
        let mut scanner = Scanner::new(&mut self.central);
        let Ok(_session) = scanner.scan(&config).await else {
            return;
        };
        loop {
            heard(&self.heard.0.receive().await);
        }
    }

    async fn connect(
        &mut self,
        address: myo::Address,
        conversation: &impl Conversation,
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
        // Where the armband drops the link at once, both events come in one go, and the host forgets
        // the connection before `connect` gets to see it and waits on. But it counts connections,
        // and the event that made one has woken this task: one that `connect`, asked first, has not
        // got by now is over.
        let begun = || self.stack.metrics(|host| host.connect_events);
        let before = begun();
        let missed = poll_fn(|_| {
            if begun() == before {
                Poll::Pending
            } else {
                Poll::Ready(())
            }
        });
        let connection = match select(self.central.connect(&config), missed).await {
            Either::First(connection) => connection.map_err(|_| ConnectFailed)?,
            Either::Second(()) => return Err(ConnectFailed),
        };
        let client: GattClient<'_, C, DefaultPacketPool, MOST_SERVICES> =
            GattClient::new(self.stack, &connection)
                .await
                .map_err(|_| ConnectFailed)?;
        // Before anything is subscribed: what nobody listens for is thrown away.
        let listener = client.listen_all().map_err(|_| ConnectFailed)?;
        let link = TroubleLink {
            client: &client,
            listener: Mutex::new(listener),
        };
        // The client's task ends when the connection does, and only it notices.
        select(client.task(), conversation.talk(&link)).await;
        connection.disconnect();
        Ok(())
    }
}

struct TroubleLink<'c, C: Controller> {
    client: &'c GattClient<'c, C, DefaultPacketPool, MOST_SERVICES>,
    listener: Mutex<NoopRawMutex, NotificationListener<'c, NOTIFICATION_BYTES>>,
}

impl<C: Capable> Link for TroubleLink<'_, C> {
    async fn discover(&self) -> Result<Handles, OperationFailed> {
        let mut handles = Handles::default();
        for service in Service::ALL {
            let services = self.client.services_by_uuid(&uuid(service.uuid())).await;
            for service in services.map_err(|_| OperationFailed)? {
                let characteristics = self
                    .client
                    .characteristics::<MOST_CHARACTERISTICS>(&service)
                    .await;
                for found in characteristics.map_err(|_| OperationFailed)? {
                    let known = myo::Uuid::from_le_bytes(found.uuid.as_raw())
                        .and_then(Characteristic::from_uuid);
                    if let Some(characteristic) = known {
                        handles.note(characteristic, found.handle, found.cccd_handle);
                    }
                }
            }
        }
        Ok(handles)
    }

    async fn read(&self, handle: u16, value: &mut [u8]) -> Result<usize, OperationFailed> {
        let read = self.client.read_handle(handle, value).await;
        read.map_err(|_| OperationFailed)
    }

    async fn write(&self, handle: u16, value: &[u8]) -> Result<(), OperationFailed> {
        let written = self.client.write_handle(handle, value).await;
        written.map_err(|_| OperationFailed)
    }

    async fn listen(&self, mut notified: impl FnMut(u16, &[u8])) -> Disconnected {
        let mut listener = self.listener.lock().await;
        loop {
            let notification = listener.next().await;
            notified(notification.handle(), notification.as_ref());
        }
    }
}

fn uuid(uuid: myo::Uuid) -> Uuid {
    match uuid {
        myo::Uuid::Sig(short) => Uuid::new_short(short),
        myo::Uuid::Vendor(_) => Uuid::new_long(uuid.to_le_bytes()),
    }
}
