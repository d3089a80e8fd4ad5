//! Attribute handles of an armband: discovered on every connection, for they differ between
//! firmware versions.

use shared::myo::{Attribute, Characteristic, Found};

/// Attribute handles by characteristic, 0 where there is none.
#[derive(Clone, Copy, Default)]
pub struct Handles {
    value: [u16; Characteristic::ALL.len()],
    subscription: [u16; Characteristic::ALL.len()],
}

impl Handles {
    pub fn insert(&mut self, attribute: Attribute) {
        match attribute {
            Attribute::Value(characteristic, handle) => {
                self.value[characteristic.index()] = handle;
            }
            Attribute::Subscription(characteristic, handle) => {
                self.subscription[characteristic.index()] = handle;
            }
        }
    }

    pub fn value(&self, characteristic: Characteristic) -> Option<u16> {
        Some(self.value[characteristic.index()]).filter(|&handle| handle != 0)
    }

    /// Handle of the descriptor that enables notifications.
    pub fn subscription(&self, characteristic: Characteristic) -> Option<u16> {
        Some(self.subscription[characteristic.index()]).filter(|&handle| handle != 0)
    }

    /// The characteristic whose value has a handle.
    pub fn characteristic(&self, handle: u16) -> Option<Characteristic> {
        let found = self.value.iter().position(|&value| value == handle);
        found.map(|place| Characteristic::ALL[place])
    }

    pub fn found(&self) -> Found {
        let there = |characteristic: &Characteristic| self.value(*characteristic).is_some();
        Characteristic::ALL.into_iter().filter(there).collect()
    }
}
