//! Session with armbands: any events in any order at any time.

use shared::myo::{Characteristic, Found, MyoEvent, Settings};

use crate::input::Input;
use crate::radio::{FuzzLink, address, advertisement};

/// Takes settings and a first time, then events: a byte for the kind, the time since the one before, then its
/// arguments.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let bits = input.byte();
    let setting = |bit: u8, last| (bits & bit != 0).then(|| address(last));
    let settings = Settings {
        pinned: setting(1, 1),
        bound: setting(2, 2),
        follow_strongest: bits & 4 != 0,
        imu: bits & 8 != 0,
        ..Settings::default()
    };
    let mut link = FuzzLink::new(settings, input.word());
    while !input.is_empty() {
        let kind = input.byte();
        link.wait(input.pause());
        match kind % 32 {
            0..=7 => link.answer(),
            8..=15 => link.emg(usize::from(kind % 4)),
            16 => {
                let (last, rssi) = (input.byte(), input.byte().cast_signed());
                link.advertise(last, rssi, input.short());
            }
            17 | 18 => {
                let (last, rssi) = (input.byte() % 4, input.byte().cast_signed());
                link.advertise(last, rssi, &advertisement());
            }
            19 => link.handle(MyoEvent::ScanEnded),
            20 => link.handle(MyoEvent::Connected),
            21 => link.handle(MyoEvent::ConnectFailed),
            22 => link.handle(MyoEvent::Discovered(found(input.byte()))),
            23 => link.handle(MyoEvent::Read(input.short())),
            24 => link.handle(MyoEvent::Done),
            25 => link.handle(MyoEvent::Failed),
            26 => {
                let characteristic = Characteristic::ALL[input.below(8)];
                let bytes = input.short();
                link.handle(MyoEvent::Notification {
                    characteristic,
                    bytes,
                });
            }
            27 => link.handle(MyoEvent::Disconnected),
            28 => link.handle(MyoEvent::Pair),
            30 => link.session.set_imu(input.flag()),
            29 => {
                let armband = input.flag().then(|| address(2));
                link.handle(MyoEvent::Bind(armband));
            }
            _ => link.handle(MyoEvent::Tick),
        }
    }
}

/// Returns the characteristics of a set's bits.
fn found(bits: u8) -> Found {
    let all = Characteristic::ALL.into_iter();
    all.filter(|one| bits & (1 << one.index()) != 0).collect()
}
