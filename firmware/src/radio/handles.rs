//! Where an armband's attributes lie: discovered anew on every connection, for firmware versions
//! number them differently.

use shared::myo::{Characteristic, Found};

/// Attribute handles by characteristic, 0 where there is none.
#[derive(Clone, Copy, Default)]
pub struct Handles {
    value: [u16; Characteristic::ALL.len()],
    subscription: [u16; Characteristic::ALL.len()],
}

impl Handles {
    /// Notes where a characteristic was found.
    pub fn note(&mut self, characteristic: Characteristic, value: u16, subscription: Option<u16>) {
        self.value[characteristic.index()] = value;
        self.subscription[characteristic.index()] = subscription.unwrap_or(0);
    }

    /// Handle of the value.
    pub fn value(&self, characteristic: Characteristic) -> Option<u16> {
        Some(self.value[characteristic.index()]).filter(|&handle| handle != 0)
    }

    /// Handle of the descriptor that asks for notifications.
    pub fn subscription(&self, characteristic: Characteristic) -> Option<u16> {
        Some(self.subscription[characteristic.index()]).filter(|&handle| handle != 0)
    }

    /// Whose value lies at a handle.
    pub fn characteristic(&self, handle: u16) -> Option<Characteristic> {
        let found = self.value.iter().position(|&value| value == handle);
        found.map(|place| Characteristic::ALL[place])
    }

    /// What was found at all.
    pub fn found(&self) -> Found {
        let there = |characteristic: &Characteristic| self.value(*characteristic).is_some();
        Characteristic::ALL.into_iter().filter(there).collect()
    }
}
