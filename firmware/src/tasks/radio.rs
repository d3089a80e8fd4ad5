//! Follows the armband; tells the output how it stands with it.

use core::cell::Cell;

use embassy_executor::Spawner;
use shared::myo::{MyoSession, Phase};

use super::{
    PACKETS,
    output::{self, Armband, Line},
};
use crate::board::{self, RadioParts};
use crate::radio::follow::Follower;
use crate::settings;

/// Runs for ever; a stack that fails ends in a panic, and so in a restart.
#[embassy_executor::task]
pub async fn run(spawner: Spawner, parts: RadioParts) {
    let told = Told::default();
    let watch = |session: &MyoSession| told.news(session);
    let session = MyoSession::new(settings::SESSION);
    let follower = Follower::new(session, &PACKETS, &watch);
    board::run_radio(spawner, parts, &follower).await;
    panic!("the Bluetooth stack has stopped");
}

/// What was told last, so that only news is told.
#[derive(Default)]
struct Told {
    phase: Cell<Option<Phase>>,
    low: Cell<bool>,
}

impl Told {
    fn news(&self, session: &MyoSession) {
        let phase = session.phase();
        let before = self.phase.replace(Some(phase));
        if before != Some(phase) {
            output::armband(phase == Phase::Streaming);
            if before == Some(Phase::Streaming) {
                output::say(Line::StreamOver(session.counters()));
            }
            if phase == Phase::Streaming {
                output::say(Line::Armband(Armband {
                    address: session.armband(),
                    firmware: session.firmware(),
                    battery: session.battery(),
                }));
            }
        }
        let low = session.battery().filter(|_| session.battery_is_low());
        let news = self.low.replace(low.is_some()) != low.is_some();
        if let Some(percent) = low.filter(|_| news) {
            output::say(Line::LowBattery(percent));
        }
    }
}
