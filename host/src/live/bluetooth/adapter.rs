//! Driver of this computer's Bluetooth, through btleplug: carries out the session's actions, and decides nothing.

use std::collections::HashMap;
use std::future::{Future, pending};
use std::sync::mpsc::Sender;

use anyhow::Context as _;
use btleplug::api::{Central as _, CentralEvent, Manager as _, Peripheral as _, ScanFilter};
use btleplug::platform::{self, Manager, PeripheralId};
use futures_util::StreamExt as _;
use shared::myo::{Action, Address, Uuid};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use super::link::{Link, Notifications, characteristic, on_air};
use crate::live::stream::Input;
use web::radio::{RadioEvent, advertising_data};

/// Signal strength that stands for an unknown one, as in the session.
const RSSI_UNKNOWN: i8 = 127;

/// Starts the stack on a thread of its own. It carries out actions in order, and ends with their channel.
pub(in crate::live) fn open(sender: Sender<Input>) -> anyhow::Result<UnboundedSender<Action>> {
    let (actions, wanted) = unbounded_channel();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    std::thread::Builder::new()
        .name("bluetooth".to_owned())
        .spawn(move || {
            if let Err(error) = runtime.block_on(run(wanted, &sender)) {
                // The session may have ended.
                let why = RadioEvent::Gone(format!("{error:#}"));
                let _ = sender.send(Input::Radio(why));
            }
        })?;
    Ok(actions)
}

/// Carries out actions until their channel ends.
async fn run(mut wanted: UnboundedReceiver<Action>, sender: &Sender<Input>) -> anyhow::Result<()> {
    let manager = Manager::new().await.context("no Bluetooth service")?;
    let adapters = manager.adapters().await?;
    let central = adapters
        .into_iter()
        .next()
        .context("this computer has no Bluetooth adapter, or it is switched off")?;
    let mut events = central.events().await?;
    let mut adapter = Adapter {
        central,
        known: HashMap::new(),
        link: None,
        notifications: None,
    };
    loop {
        let event = tokio::select! {
            action = wanted.recv() => match action {
                Some(action) => adapter.carry_out(action, &mut wanted).await,
                None => {
                    adapter.disconnect().await;
                    return Ok(());
                }
            },
            event = events.next() => {
                let event = event.context("the Bluetooth service has ended")?;
                adapter.handle(event).await
            }
            value = next(&mut adapter.notifications) => value,
        };
        if let Some(event) = event {
            // A session that has ended closes the other channel too.
            let _ = sender.send(Input::Radio(event));
        }
    }
}

/// Waits for the next notification of the armband.
async fn next(notifications: &mut Option<Notifications>) -> Option<RadioEvent> {
    let Some(stream) = notifications else {
        return pending().await;
    };
    let Some(value) = stream.next().await else {
        // The link has ended; the central reports that.
        *notifications = None;
        return None;
    };
    let bytes = value.value;
    characteristic(value.uuid).map(|characteristic| RadioEvent::Notification {
        characteristic,
        bytes,
    })
}

struct Adapter {
    central: platform::Adapter,
    /// Devices that have advertised.
    known: HashMap<[u8; 6], PeripheralId>,
    link: Option<Link>,
    notifications: Option<Notifications>,
}

impl Adapter {
    /// Carries out an action. Returns its result, if it has one.
    async fn carry_out(
        &mut self,
        action: Action,
        wanted: &mut UnboundedReceiver<Action>,
    ) -> Option<RadioEvent> {
        match action {
            Action::Scan => {
                let control =
                    uuid::Uuid::from_u128(u128::from_le_bytes(Uuid::CONTROL.to_le_bytes()));
                let services = vec![control];
                let started = self.central.start_scan(ScanFilter { services }).await;
                started.err().map(|_| RadioEvent::ScanEnded)
            }
            Action::StopScan => {
                // A scan that does not run cannot be stopped.
                let _ = self.central.stop_scan().await;
                None
            }
            Action::Connect(address) => Some(self.connect(address, wanted).await),
            Action::Disconnect => {
                let was_connected = self.link.is_some();
                self.disconnect().await;
                Some(if was_connected {
                    RadioEvent::Disconnected
                } else {
                    RadioEvent::ConnectFailed
                })
            }
            operation => {
                let event = match &mut self.link {
                    Some(link) => {
                        unless_ended(link.operate(operation, &mut self.notifications), wanted).await
                    }
                    None => Some(RadioEvent::Failed),
                };
                let event = match event {
                    Some(event) => event,
                    None => {
                        self.disconnect().await;
                        RadioEvent::Disconnected
                    }
                };
                Some(event)
            }
        }
    }

    async fn connect(
        &mut self,
        address: Address,
        wanted: &mut UnboundedReceiver<Action>,
    ) -> RadioEvent {
        let Some(id) = self.known.get(&address.bytes) else {
            return RadioEvent::ConnectFailed;
        };
        let Ok(peripheral) = self.central.peripheral(id).await else {
            return RadioEvent::ConnectFailed;
        };
        match unless_ended(peripheral.connect(), wanted).await {
            Some(Ok(())) => {
                self.link = Some(Link::new(peripheral));
                RadioEvent::Connected
            }
            Some(Err(_)) | None => {
                let _ = peripheral.disconnect().await;
                RadioEvent::ConnectFailed
            }
        }
    }

    async fn disconnect(&mut self) {
        self.notifications = None;
        if let Some(link) = self.link.take() {
            // A link that has ended already is not a failure.
            let _ = link.peripheral.disconnect().await;
        }
    }

    /// Handles an event of the stack.
    async fn handle(&mut self, event: CentralEvent) -> Option<RadioEvent> {
        match event {
            CentralEvent::DeviceDiscovered(id) | CentralEvent::DeviceUpdated(id) => {
                let peripheral = self.central.peripheral(&id).await.ok()?;
                let properties = peripheral.properties().await.ok()??;
                let address = Address::parse(&properties.address.to_string()).ok()?;
                self.known.insert(address.bytes, id);
                let rssi = properties.rssi.and_then(|rssi| i8::try_from(rssi).ok());
                let services = properties.services.iter();
                Some(RadioEvent::Advertisement {
                    address,
                    rssi: rssi.unwrap_or(RSSI_UNKNOWN),
                    data: advertising_data(services.copied().map(on_air)),
                })
            }
            CentralEvent::DeviceDisconnected(id) => {
                let link = self.link.take_if(|link| link.peripheral.id() == id)?;
                self.notifications = None;
                drop(link);
                Some(RadioEvent::Disconnected)
            }
            _ => None,
        }
    }
}

/// Result of an operation; none if the session ends or ends the connection. The session asks for nothing else meanwhile.
async fn unless_ended<T>(
    operation: impl Future<Output = T>,
    wanted: &mut UnboundedReceiver<Action>,
) -> Option<T> {
    let ended = async { while !matches!(wanted.recv().await, Some(Action::Disconnect) | None) {} };
    tokio::select! {
        result = operation => Some(result),
        () = ended => None,
    }
}
