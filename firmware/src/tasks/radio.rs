//! Runs the Myo session on the board's radio and reports its phase and the armband's battery.

use core::cell::Cell;

use embassy_executor::Spawner;
use shared::myo::{MyoSession, Phase};

use crate::board::{self, RadioParts};
use crate::messages::{
    armband,
    packets::PACKETS,
    pin_state,
    uart::{self, UartMessage},
};
use crate::radio::driver::SessionDriver;
use crate::settings;

/// Runs forever; a Bluetooth stack that stops ends in a panic, and so in a restart.
#[embassy_executor::task]
pub async fn run(spawner: Spawner, parts: RadioParts) {
    let reporter = Reporter::default();
    let observe = |session: &MyoSession| reporter.report(session);
    let session = MyoSession::new(settings::SESSION);
    let driver = SessionDriver::new(session, &PACKETS, &observe);
    board::run_radio(spawner, parts, &driver).await;
    panic!("the Bluetooth stack has stopped");
}

/// The session's state as it was last reported: only changes are.
#[derive(Default)]
struct Reporter {
    phase: Cell<Option<Phase>>,
    battery_is_low: Cell<bool>,
}

impl Reporter {
    fn report(&self, session: &MyoSession) {
        armband::set(session);
        let phase = session.phase();
        let before = self.phase.replace(Some(phase));
        if before != Some(phase) {
            pin_state::set_armband(phase == Phase::Streaming);
            if before == Some(Phase::Streaming) {
                uart::enqueue(UartMessage::StreamEnded(session.counters()));
            }
            if phase == Phase::Streaming {
                uart::enqueue(UartMessage::Armband(armband::current()));
            }
        }
        let low = session.battery().filter(|_| session.battery_is_low());
        let changed = self.battery_is_low.replace(low.is_some()) != low.is_some();
        if let Some(percent) = low.filter(|_| changed) {
            uart::enqueue(UartMessage::LowBattery(percent));
        }
    }
}
