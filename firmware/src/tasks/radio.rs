//! Runs the Myo session on the board's radio and reports its phase and the armband's battery.

use core::cell::Cell;

use embassy_executor::Spawner;
use embassy_time::Timer;
use shared::myo::{Following, MyoSession, Phase, Settings};
use shared::units::Millis;

use crate::binding_region;
use crate::board::{self, RadioParts};
use crate::clock::now;
use crate::messages::{
    armband,
    packets::PACKETS,
    pin_state,
    uart::{self, UartMessage},
};
use crate::radio::driver::SessionDriver;
use crate::reset_reason::previous_message;
use crate::settings;

/// Milliseconds that the armband's LED is lit, and then dark, during a pairing.
const BLINK_MS: u32 = 250;

/// Milliseconds between two reminders that no armband is bound.
const REMINDER_MS: u32 = 10_000;

/// Milliseconds in which the first lines of a start go out, with what the run before said.
const FIRST_LINES_MS: u64 = 100;

/// Runs forever; a Bluetooth stack that stops ends in a panic, and so in a restart.
#[embassy_executor::task]
pub async fn run(spawner: Spawner, parts: RadioParts) {
    if !previous_message().is_empty() {
        // The radio may have caused the panic, and may cause it again at once: the line that says so goes out first.
        Timer::after_millis(FIRST_LINES_MS).await;
    }
    let reporter = Reporter::default();
    let observe = |session: &MyoSession| reporter.report(session);
    let kept = binding_region::load();
    let session = MyoSession::new(Settings {
        bound: kept,
        ..settings::SESSION
    });
    let driver = SessionDriver::new(session, kept, &PACKETS, &observe);
    board::run_radio(spawner, parts, &driver).await;
    panic!("the Bluetooth stack has stopped");
}

/// The session's state as it was last reported: only changes are.
#[derive(Default)]
struct Reporter {
    phase: Cell<Option<Phase>>,
    following: Cell<Option<Following>>,
    /// Time of the last message that no armband is followed.
    reminded: Cell<Option<Millis>>,
    battery_is_low: Cell<bool>,
}

impl Reporter {
    /// Says which armband is followed when that changes, and without one what to do: a terminal may be connected late.
    fn report_following(&self, session: &MyoSession) {
        let following = session.following();
        let before = self.following.replace(Some(following));
        if before == Some(Following::Pairing) && session.pairing_failed() {
            uart::enqueue(UartMessage::PairingFailed);
        }
        let is_due = |last: Millis| now().elapsed_since(last) >= REMINDER_MS;
        let reminds = following == Following::Nobody && self.reminded.get().is_none_or(is_due);
        if before != Some(following) || reminds {
            self.reminded.set(Some(now()));
            uart::enqueue(UartMessage::Following(following));
        }
    }

    fn report(&self, session: &MyoSession) {
        armband::set(session);
        self.report_following(session);
        let phase = session.phase();
        let before = self.phase.replace(Some(phase));
        if before != Some(phase) {
            if before == Some(Phase::Streaming) {
                uart::enqueue(UartMessage::StreamEnded(session.counters()));
            }
            if phase == Phase::Streaming {
                uart::enqueue(UartMessage::Armband(armband::current()));
            }
        }
        pin_state::set_armband(match session.following() {
            Following::Pairing => (now().0 / BLINK_MS).is_multiple_of(2),
            _ => phase == Phase::Streaming,
        });
        let low = session.battery().filter(|_| session.battery_is_low());
        let changed = self.battery_is_low.replace(low.is_some()) != low.is_some();
        if let Some(percent) = low.filter(|_| changed) {
            uart::enqueue(UartMessage::LowBattery(percent));
        }
    }
}
