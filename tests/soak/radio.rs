//! Radio between armband and device: passes events, and answers the session's actions.

use shared::myo::{Action, Characteristic, Event, Phase, Uuid};

use super::super::device::{ARMBAND, Device};
use super::Armband;

/// Duration of an operation in milliseconds.
const OPERATION_MS: u64 = 6;

/// Firmware Version of a real armband: 1.5.1970, rev D.
pub(super) const FIRMWARE: [u8; 8] = [1, 0, 5, 0, 0xb2, 0x07, 2, 0];

/// Firmware Version that is refused: 0.8.
const OLD_FIRMWARE: [u8; 8] = [0, 0, 8, 0, 0, 0, 1, 0];

/// Control service, which the armband advertises.
const CONTROL: Uuid = Uuid::Vendor(0x0001);

/// Reaction of the radio to an action.
#[derive(Clone, Copy, Debug)]
pub(super) enum Answer {
    Advertise,
    Connected,
    ConnectFailed,
    Discovered,
    Read(Characteristic),
    Done,
    Failed,
    Disconnected,
}

impl<'d, 'm, 's> Armband<'d, 'm, 's> {
    /// Passes an event to the device, and executes its session's actions.
    pub(super) fn event(&mut self, event: Event<'_>) {
        let now = Device::clock(self.now_us / 1000);
        for action in self.device.handle(now, event) {
            let answer = match action {
                Action::Scan => {
                    self.scanning = true;
                    Answer::Advertise
                }
                Action::StopScan => {
                    self.scanning = false;
                    continue;
                }
                Action::Connect(_) if self.refused > 0 => {
                    self.refused -= 1;
                    Answer::ConnectFailed
                }
                Action::Connect(_) => Answer::Connected,
                Action::Disconnect => Answer::Disconnected,
                // Only operations of the set-up fail: while it streams, the session only keeps the armband awake.
                _ if self.unanswered > 0 && self.device.session.phase() == Phase::SettingUp => {
                    self.unanswered -= 1;
                    self.injected.timeouts += 1;
                    continue;
                }
                Action::Subscribe(Characteristic::Emg(_)) if self.failing > 0 => {
                    self.failing -= 1;
                    self.injected.failed_set_ups += 1;
                    Answer::Failed
                }
                Action::Discover => Answer::Discovered,
                Action::Read(characteristic) => Answer::Read(characteristic),
                _ => Answer::Done,
            };
            let at = self.now_us + 1000 * OPERATION_MS;
            self.answers.push_back((at, answer));
        }
    }

    /// Tells the device the radio's reaction.
    pub(super) fn answer(&mut self, answer: Answer) {
        match answer {
            Answer::Advertise if !self.scanning => {}
            Answer::Advertise => {
                let mut data = [0; 18];
                data[..2].copy_from_slice(&[17, 0x06]);
                data[2..].copy_from_slice(&CONTROL.to_le_bytes());
                self.event(Event::Advertisement {
                    address: ARMBAND,
                    rssi: -50,
                    data: &data,
                });
                self.answers
                    .push_back((self.now_us + 100_000, Answer::Advertise));
            }
            Answer::Connected => {
                self.injected.connections += 1;
                self.event(Event::Connected);
            }
            Answer::ConnectFailed => {
                self.injected.failed_connects += 1;
                self.event(Event::ConnectFailed);
            }
            Answer::Discovered => {
                self.event(Event::Discovered(Characteristic::ALL.into_iter().collect()))
            }
            Answer::Read(Characteristic::FirmwareVersion) if self.outdated > 0 => {
                self.outdated -= 1;
                self.injected.refused += 1;
                self.event(Event::Read(&OLD_FIRMWARE));
            }
            Answer::Read(Characteristic::FirmwareVersion) => self.event(Event::Read(&FIRMWARE)),
            Answer::Read(_) => self.event(Event::Read(&[80])),
            Answer::Done => self.event(Event::Done),
            Answer::Failed => self.event(Event::Failed),
            Answer::Disconnected => {
                self.on_air.clear();
                self.event(Event::Disconnected);
            }
        }
    }
}
