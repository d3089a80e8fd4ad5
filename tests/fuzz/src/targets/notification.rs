//! Notifications of a running stream: any bytes of any characteristic at any time.

use shared::myo::{Characteristic, Event};

use crate::input::Input;
use crate::radio::Link;

/// Takes notifications, each a byte for its kind, the time since the one before, and perhaps bytes.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let mut link = Link::streaming(input.word());
    while !input.is_empty() {
        let kind = input.byte();
        link.wait(input.pause());
        match kind {
            0..=199 => link.emg(usize::from(kind)),
            _ => {
                let characteristic = Characteristic::ALL[usize::from(kind) % 7];
                let bytes = input.short();
                link.handle(Event::Notification {
                    characteristic,
                    bytes,
                });
            }
        }
    }
}
