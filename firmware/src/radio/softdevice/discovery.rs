//! Discovery of the armband's characteristics, one service after the other.

use nrf_softdevice::ble::{
    Connection, Uuid,
    gatt_client::{self, Client, Descriptor, DiscoverError, HvxType},
};
use shared::myo::{self, Characteristic, Service};

use crate::radio::{OperationFailed, handles::Handles};

/// Finds every characteristic that the session knows.
pub async fn discover(connection: &Connection) -> Result<Handles, OperationFailed> {
    const { assert!(Service::ALL.len() == 3) };
    let mut handles = Handles::default();
    discover_service::<0>(connection, &mut handles).await?;
    discover_service::<1>(connection, &mut handles).await?;
    discover_service::<2>(connection, &mut handles).await?;
    Ok(handles)
}

async fn discover_service<const SERVICE: usize>(
    connection: &Connection,
    handles: &mut Handles,
) -> Result<(), OperationFailed> {
    let discovered: Discovered<SERVICE> = match gatt_client::discover(connection).await {
        Ok(discovered) => discovered,
        // The session checks which characteristics are missing.
        Err(DiscoverError::ServiceNotFound) => return Ok(()),
        Err(error) => {
            defmt::warn!("discovery failed: {}", error);
            return Err(OperationFailed);
        }
    };
    for (characteristic, value, subscription) in discovered.0.into_iter().flatten() {
        handles.insert(characteristic, value, subscription);
    }
    Ok(())
}

/// What was found in the service at this place of [`Service::ALL`]: characteristic, handle of the
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
        let matches = |known: &Characteristic| found.uuid == Some(uuid(known.uuid()));
        if let Some(characteristic) = Characteristic::ALL.into_iter().find(matches) {
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

/// A UUID in the SoftDevice's form. The first use of a vendor UUID registers its base with the
/// SoftDevice; later uses find that entry.
pub fn uuid(uuid: myo::Uuid) -> Uuid {
    match uuid {
        myo::Uuid::Sig(short) => Uuid::new_16(short),
        myo::Uuid::Vendor(_) => Uuid::new_128(&uuid.to_le_bytes()),
    }
}
