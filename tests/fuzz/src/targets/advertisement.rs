//! Advertising data: the session follows only data that lists the armband's service.

use shared::myo::{Event, MyoSession, Phase, Settings};
use shared::units::Millis;

use crate::radio::{CONTROL, address};

/// Takes the data of one advertisement.
pub fn run(data: &[u8]) {
    let mut session = MyoSession::new(Settings {
        follow_strongest: true,
        ..Settings::default()
    });
    let mut at = |now, event| session.handle(Millis(now), event, &mut |_| {});
    at(0, Event::Tick);
    at(
        1,
        Event::Advertisement {
            address: address(1),
            rssi: -40,
            data,
        },
    );
    at(1000, Event::Tick);
    let followed = session.phase() == Phase::Connecting;
    assert_eq!(followed, lists_the_service(data));
}

/// Looks for the service by a plain walk over the structures.
fn lists_the_service(data: &[u8]) -> bool {
    let mut at = 0;
    while at < data.len() {
        let end = at + 1 + usize::from(data[at]);
        if end > data.len() {
            return false;
        }
        if end == at + 1 {
            // A length of zero ends the data, or pads it.
            return false;
        }
        let (kind, value) = (data[at + 1], &data[at + 2..end]);
        let whole = value.len() / 16 * 16;
        let listed = value[..whole]
            .chunks(16)
            .any(|uuid| uuid == CONTROL.to_le_bytes());
        if (kind == 6 || kind == 7) && listed {
            return true;
        }
        at = end;
    }
    false
}
