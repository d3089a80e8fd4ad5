//! Simulated armband, with the Bluetooth stack that reaches it: answers the actions of a session.

use std::collections::VecDeque;

use shared::myo::{Action, Address, AddressKind, Characteristic, Uuid};
use shared::units::Sample;

use crate::radio::{RadioEvent, advertising_data};

/// Firmware version 1.5.1970, hardware revision 2.
const FIRMWARE: [u8; 8] = [1, 0, 5, 0, 0xb2, 0x07, 2, 0];

/// Charge of its battery in percent.
const BATTERY: u8 = 80;

/// Movement of an arm that lies still, palm down: quaternion, acceleration, turn rate.
const STILL: [i16; 10] = [16_384, 0, 0, 0, 0, 0, -2048, 0, 0, 0];

/// Simulated armband in range.
#[derive(Debug, Default)]
pub struct SimulatedArmband {
    /// Events that the session has not heard yet.
    events: VecDeque<RadioEvent>,
    streams: bool,
    /// Whether its movement is subscribed to, and on in its mode.
    imu: (bool, bool),
    /// Notifications of EMG since the connection.
    sent: usize,
}

impl SimulatedArmband {
    /// Address of the armband: FA:12:34:56:78:9A.
    pub const ADDRESS: Address = Address {
        kind: AddressKind::Random,
        bytes: [0x9a, 0x78, 0x56, 0x34, 0x12, 0xfa],
    };

    /// Carries out an action of the radio; others do nothing.
    pub fn act(&mut self, action: Action) {
        let event = match action {
            Action::Scan => RadioEvent::Advertisement {
                address: Self::ADDRESS,
                rssi: -50,
                data: advertising_data([Uuid::CONTROL.to_le_bytes()]),
            },
            Action::Connect(_) => RadioEvent::Connected,
            Action::Discover => RadioEvent::Discovered {
                found: Characteristic::ALL.into_iter().collect(),
            },
            Action::Read(one) => RadioEvent::Read {
                bytes: match one {
                    Characteristic::FirmwareVersion => FIRMWARE.to_vec(),
                    _ => vec![BATTERY],
                },
            },
            Action::Subscribe(one) => {
                self.imu.0 |= one == Characteristic::Imu;
                RadioEvent::Done
            }
            Action::Write(_, payload) => {
                // The command that sets the mode.
                if let [1, 3, emg, imu, _] = *payload.as_slice() {
                    (self.streams, self.imu.1) = (emg != 0, imu == 1);
                }
                RadioEvent::Done
            }
            Action::Disconnect => return self.lose(),
            _ => return,
        };
        self.events.push_back(event);
    }

    /// Ends the connection.
    pub fn lose(&mut self) {
        let mut events = self.events();
        events.push_back(RadioEvent::Disconnected);
        *self = Self {
            events,
            ..Self::default()
        };
    }

    /// Whether it wants samples to send.
    pub const fn streams(&self) -> bool {
        self.streams
    }

    /// Sends two samples, on its four characteristics in turn, and behind every second notification its movement.
    pub fn notify(&mut self, pair: [Sample; 2]) {
        let emg = pair.as_flattened().iter();
        self.events.push_back(RadioEvent::Notification {
            characteristic: Characteristic::ALL[2 + self.sent % 4],
            bytes: emg.map(|value| value.cast_unsigned()).collect(),
        });
        self.sent += 1;
        if self.imu == (true, true) && self.sent.is_multiple_of(2) {
            self.events.push_back(RadioEvent::Notification {
                characteristic: Characteristic::Imu,
                bytes: STILL.map(i16::to_le_bytes).as_flattened().to_vec(),
            });
        }
    }

    /// Returns the events since the last call.
    pub fn events(&mut self) -> VecDeque<RadioEvent> {
        std::mem::take(&mut self.events)
    }
}
