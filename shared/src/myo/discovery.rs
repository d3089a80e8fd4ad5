//! Discovery of the armband's attributes by reading them, one handle after the other.
//!
//! A characteristic is declared by an attribute that everybody may read: its properties, the handle of its
//! value, its UUID (Bluetooth Core, Vol 3, Part G, 3.3.1). Behind the value come descriptors; the one that
//! enables notifications has two bytes and can be read too (3.3.3.3). An armband that refuses to let it be read refuses that for
//! the first time there. So plain reads suffice, and a read is the one operation that every Bluetooth stack carries out whatever
//! else it receives meanwhile: the ready-made discovery of nrf-softdevice 0.1 panics on any notification.
//!
//! Bounded by the last handle that is read; the session bounds the time.

use super::characteristic::{Characteristic, Found};
use super::uuid::Uuid;

/// The last handle that is read. An armband's subscriptions end at 0x35; reading all of these takes less than
/// the 5 s of an operation at the longest connection interval, two intervals a read.
const LAST: u16 = 128;
/// Bytes of a declaration before the UUID: properties, handle of the value.
const BEFORE_UUID: usize = 3;

/// An attribute that was found.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Attribute {
    /// The value of a characteristic.
    Value(Characteristic, u16),
    /// The descriptor that enables its notifications. If several are found, the last one counts: a
    /// refused one is found before a readable one.
    Subscription(Characteristic, u16),
}

/// Attribute to read next, and what was found.
///
/// `while let Some(handle) = discovery.handle() { discovery.answered(read(handle)) }`: at most 128 times.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Discovery {
    /// The next attribute, from 1.
    next: u16,
    /// The characteristic whose descriptors come next.
    of: Option<Characteristic>,
    values: Found,
    subscriptions: Found,
}

impl Default for Discovery {
    /// Discovery before the first attribute.
    fn default() -> Self {
        Self {
            next: 1,
            of: None,
            values: Found::NONE,
            subscriptions: Found::NONE,
        }
    }
}

impl Discovery {
    /// The attribute to read; none at the end.
    #[must_use]
    pub fn handle(&self) -> Option<u16> {
        let complete = |one: Characteristic| {
            let has_subscription = self.subscriptions.contains(one) && self.of != Some(one);
            self.values.contains(one) && (!notifies(one) || has_subscription)
        };
        // Not the IMU, which an armband declares before its EMG: one without it is not read to the end.
        let mut needed = Characteristic::ALL[..Characteristic::Imu.index()].iter();
        let all = needed.all(|&one| complete(one));
        (self.next <= LAST && !all).then_some(self.next)
    }

    /// Takes the value of the attribute that [`Discovery::handle`] named; none where it cannot be read.
    pub fn answered(&mut self, value: Option<&[u8]>) -> Option<Attribute> {
        let handle = self.next;
        self.next = handle.saturating_add(1);
        let Some(value) = value else {
            let characteristic = self.of.filter(|one| notifies(*one))?;
            let is_first = !self.subscriptions.contains(characteristic);
            self.subscriptions = self.subscriptions.with(characteristic);
            return is_first.then_some(Attribute::Subscription(characteristic, handle));
        };
        if let Some((value_handle, uuid)) = declaration(handle, value) {
            // The value itself is not read: it may have side effects.
            self.next = value_handle.saturating_add(1);
            self.of = uuid.and_then(Characteristic::from_uuid);
            let characteristic = self.of?;
            if self.values.contains(characteristic) {
                // Declared twice: the first one counts.
                self.of = None;
                return None;
            }
            self.values = self.values.with(characteristic);
            return Some(Attribute::Value(characteristic, value_handle));
        }
        if !matches!(value, [0..=3, 0]) {
            return None;
        }
        let characteristic = self.of.take()?;
        self.subscriptions = self.subscriptions.with(characteristic);
        Some(Attribute::Subscription(characteristic, handle))
    }
}

/// Whether the session enables the notifications of a characteristic.
const fn notifies(one: Characteristic) -> bool {
    matches!(
        one,
        Characteristic::Emg(_) | Characteristic::BatteryLevel | Characteristic::Imu
    )
}

/// Handle and UUID of a declaration's value; the UUID is `None` if it belongs to neither family.
fn declaration(handle: u16, bytes: &[u8]) -> Option<(u16, Option<Uuid>)> {
    let (before, uuid) = bytes.split_at_checked(BEFORE_UUID)?;
    let value_handle = u16::from_le_bytes([before[1], before[2]]);
    let is_declaration =
        matches!(uuid.len(), 2 | 16) && (handle + 1..=LAST).contains(&value_handle);
    is_declaration.then(|| (value_handle, Uuid::from_le_bytes(uuid)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::myo::Lane;
    use alloc::{collections::BTreeMap, vec, vec::Vec};

    /// Values by handle, from 1; none where a read is refused.
    type Table = Vec<Option<Vec<u8>>>;

    fn run(table: &Table) -> (Vec<Attribute>, Vec<u16>) {
        let (mut discovery, mut found, mut read) = (Discovery::default(), Vec::new(), Vec::new());
        while let Some(handle) = discovery.handle() {
            read.push(handle);
            let value = table.get(usize::from(handle) - 1);
            found.extend(discovery.answered(value.and_then(|value| value.as_deref())));
        }
        (found, read)
    }

    fn declare(table: &mut Table, uuid: Uuid) {
        let value_handle = table.len() as u16 + 2;
        let mut bytes = vec![0x10];
        bytes.extend(value_handle.to_le_bytes());
        match uuid {
            Uuid::Sig(short) => bytes.extend(short.to_le_bytes()),
            Uuid::Vendor(_) => bytes.extend(uuid.to_le_bytes()),
        }
        table.extend([Some(bytes), Some(vec![7; 20])]);
    }

    /// The table of an armband, whose IMU comes before its EMG.
    fn armband() -> (Table, Vec<Attribute>) {
        let mut all = Characteristic::ALL;
        all.rotate_right(1);
        armband_with(&all)
    }

    /// A table of services, characteristics, subscriptions, some of them unknown.
    fn armband_with(all: &[Characteristic]) -> (Table, Vec<Attribute>) {
        let (mut table, mut expected) = (Table::new(), Vec::new());
        table.push(Some(vec![0x00, 0x18]));
        declare(&mut table, Uuid::Sig(0x2a00));
        table.push(Some(vec![0x0f, 0x18]));
        for &characteristic in all {
            declare(&mut table, characteristic.uuid());
            expected.push(Attribute::Value(characteristic, table.len() as u16));
            let notifies = !matches!(
                characteristic,
                Characteristic::Command | Characteristic::FirmwareVersion
            );
            if notifies {
                // A description in front of the subscription.
                table.extend([Some(b"EMG".to_vec()), Some(vec![0, 0])]);
                let handle = table.len() as u16;
                expected.push(Attribute::Subscription(characteristic, handle));
            }
        }
        (table, expected)
    }

    #[test]
    fn an_armbands_attributes_are_found_and_no_value_is_read() {
        // One without an IMU is not read on for it.
        let (table, expected) = armband_with(&Characteristic::ALL[..7]);
        let (found, read) = run(&[&table[..], &[None, None]].concat());
        assert_eq!(
            (found, read.last()),
            (expected, Some(&(table.len() as u16)))
        );
        let (table, expected) = armband();
        let (found, read) = run(&table);
        assert_eq!(found, expected);
        for attribute in &expected {
            if let Attribute::Value(_, handle) = attribute {
                assert!(!read.contains(handle), "{attribute:?} was read");
            }
        }
        assert_eq!(read.last(), Some(&(table.len() as u16)), "not to the end");
    }

    #[test]
    fn handles_that_are_missing_or_refused_are_passed_over() {
        let (table, _) = armband();
        let mut holes = vec![None; 20];
        holes.extend(table.into_iter().skip(3));
        let (found, _) = run(&holes);
        // Every declaration names the handle before it now: none fits.
        assert_eq!(found, []);
        let mut later = vec![None; 20];
        for characteristic in [Characteristic::Command, Characteristic::Emg(Lane::ALL[3])] {
            declare(&mut later, characteristic.uuid());
            later.push(None);
        }
        let command = Attribute::Value(Characteristic::Command, 22);
        let lane = Characteristic::Emg(Lane::ALL[3]);
        let subscription = Attribute::Subscription(lane, 26);
        let expected = [command, Attribute::Value(lane, 25), subscription];
        assert_eq!(run(&later).0, expected);
    }

    #[test]
    fn a_subscription_that_cannot_be_read_is_where_a_read_is_refused_first() {
        let (mut table, expected) = armband();
        let (mut described, _) = armband();
        for attribute in &expected {
            if let Attribute::Subscription(_, handle) = attribute {
                table[usize::from(*handle) - 1] = None;
                described[usize::from(*handle) - 2] = None;
            }
        }
        assert_eq!(run(&table).0, expected);
        // The description is refused in its place: the readable one, which comes later, counts.
        let last = |attributes: Vec<Attribute>| -> BTreeMap<(usize, bool), u16> {
            let handles = attributes.into_iter().map(|attribute| match attribute {
                Attribute::Value(of, handle) => ((of.index(), false), handle),
                Attribute::Subscription(of, handle) => ((of.index(), true), handle),
            });
            handles.collect()
        };
        assert_eq!(last(run(&described).0), last(expected));
    }

    #[test]
    fn the_first_of_two_declarations_counts() {
        let mut table = Table::new();
        declare(&mut table, Characteristic::BatteryLevel.uuid());
        declare(&mut table, Characteristic::BatteryLevel.uuid());
        table.push(Some(vec![0, 0]));
        let battery = Characteristic::BatteryLevel;
        assert_eq!(run(&table).0, [Attribute::Value(battery, 2)]);
    }
}
