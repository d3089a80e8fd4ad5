//! Writes UART messages and sets pins. Messages wait for the UART; pins wait for nothing.

use embassy_futures::join::join;
use embassy_time::with_timeout;

use crate::board::{LabelPort, Pins};
use crate::messages::{
    heartbeat,
    packets::PACKETS,
    pin_state,
    uart::{self, Next, UartMessage},
};

#[embassy_executor::task]
pub async fn run(mut port: LabelPort, mut pins: Pins) {
    join(set_pins(&mut pins), write_messages(&mut port)).await;
}

async fn write_messages(port: &mut LabelPort) {
    let mut dropped = 0;
    loop {
        let next = if PACKETS.dropped() == dropped {
            with_timeout(heartbeat::PERIOD, uart::receive()).await
        } else {
            dropped = PACKETS.dropped();
            Ok(Next::Message(UartMessage::PacketsDropped(dropped)))
        };
        // Evidence: the UART took a line, or no line waits for it.
        match next {
            Ok(next) => {
                port.send(next.line().as_bytes()).await;
                heartbeat::OUTPUT.beat();
            }
            Err(_) if uart::is_idle() => heartbeat::OUTPUT.beat(),
            Err(_) => {}
        }
    }
}

async fn set_pins(pins: &mut Pins) {
    loop {
        let state = pin_state::current();
        pins.set(state);
        pin_state::set_shown(state);
        pin_state::changed().await;
    }
}
