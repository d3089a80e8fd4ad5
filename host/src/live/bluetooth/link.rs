//! Connection to an armband: its characteristics, and operations on them.

use std::pin::Pin;

use btleplug::api::{Characteristic as Remote, Peripheral as _, ValueNotification, WriteType};
use btleplug::platform::Peripheral;
use futures_util::Stream;
use shared::myo::{Action, Characteristic, Uuid};

use web::radio::RadioEvent;

/// Notifications of all subscribed characteristics.
pub(super) type Notifications = Pin<Box<dyn Stream<Item = ValueNotification> + Send>>;

/// Finds the characteristic of a UUID; none if it is not used here.
pub(super) fn characteristic(uuid: uuid::Uuid) -> Option<Characteristic> {
    Characteristic::from_uuid(Uuid::from_le_bytes(&on_air(uuid))?)
}

/// Bytes of a UUID in the order on air.
pub(super) const fn on_air(uuid: uuid::Uuid) -> [u8; 16] {
    // Not `to_bytes_le`, which swaps only three of its fields.
    uuid.as_u128().to_le_bytes()
}

/// Connection to an armband.
pub(super) struct Link {
    pub(super) peripheral: Peripheral,
    found: Vec<(Characteristic, Remote)>,
}

impl Link {
    /// Creates a connection before discovery.
    pub(super) const fn new(peripheral: Peripheral) -> Self {
        Self {
            peripheral,
            found: Vec::new(),
        }
    }

    /// Carries out an operation of the session. Returns its result.
    pub(super) async fn operate(
        &mut self,
        operation: Action,
        notifications: &mut Option<Notifications>,
    ) -> RadioEvent {
        let answer = match operation {
            Action::Discover => self.discover().await,
            Action::Read(characteristic) => self.read(characteristic).await,
            Action::Write(characteristic, payload) => {
                self.write(characteristic, payload.as_slice()).await
            }
            Action::Subscribe(characteristic) => {
                self.subscribe(characteristic, notifications).await
            }
            _ => None,
        };
        answer.unwrap_or(RadioEvent::Failed)
    }

    async fn discover(&mut self) -> Option<RadioEvent> {
        self.peripheral.discover_services().await.ok()?;
        let remotes = self.peripheral.characteristics().into_iter();
        self.found = remotes
            .filter_map(|remote| Some((characteristic(remote.uuid)?, remote)))
            .collect();
        let found = self.found.iter().map(|(characteristic, _)| *characteristic);
        Some(RadioEvent::Discovered {
            found: found.collect(),
        })
    }

    fn remote(&self, wanted: Characteristic) -> Option<&Remote> {
        let mut found = self.found.iter();
        found.find_map(|(characteristic, remote)| (*characteristic == wanted).then_some(remote))
    }

    async fn read(&self, characteristic: Characteristic) -> Option<RadioEvent> {
        let bytes = self.peripheral.read(self.remote(characteristic)?).await;
        bytes.ok().map(|bytes| RadioEvent::Read { bytes })
    }

    async fn write(&self, characteristic: Characteristic, bytes: &[u8]) -> Option<RadioEvent> {
        let remote = self.remote(characteristic)?;
        // The armband ignores a write without response.
        let written = self
            .peripheral
            .write(remote, bytes, WriteType::WithResponse);
        written.await.ok().map(|()| RadioEvent::Done)
    }

    async fn subscribe(
        &self,
        characteristic: Characteristic,
        notifications: &mut Option<Notifications>,
    ) -> Option<RadioEvent> {
        if notifications.is_none() {
            *notifications = Some(self.peripheral.notifications().await.ok()?);
        }
        let remote = self.remote(characteristic)?;
        let subscribed = self.peripheral.subscribe(remote).await;
        subscribed.ok().map(|()| RadioEvent::Done)
    }
}
