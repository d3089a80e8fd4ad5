//! Start: from reset to running tasks.

use embassy_executor::{SpawnError, SpawnToken, Spawner};

use crate::board;
use crate::messages::{
    model,
    uart::{self, UartMessage},
};
use crate::reset_reason::previous_message;
use crate::tasks::{control, inference, output, radio, watchdog};

#[cfg(not(any(feature = "nrf52832", feature = "nrf52840", not(target_os = "none"))))]
compile_error!("choose a board: --features nrf52840 or nrf52832");
#[cfg(not(any(
    feature = "radio-softdevice",
    feature = "radio-trouble",
    not(target_os = "none")
)))]
compile_error!("choose a radio: --features radio-softdevice or radio-trouble");

pub fn start(spawner: Spawner) {
    // The outputs come first: from reset to here every pin floats.
    let board = board::start();
    spawn(&spawner, output::run(board.labels, board.pins));
    spawn(&spawner, watchdog::run(board.watchdog));
    let (pipeline, refused) = inference::load(board.reset_reason);
    uart::enqueue(UartMessage::Started(board.reset_reason, model::current()));
    if !previous_message().is_empty() {
        uart::enqueue(UartMessage::Ended);
    }
    spawn(&spawner, control::run(board.commands, board.button));
    spawn(&spawner, inference::run(pipeline, refused, board.dead_man));
    #[cfg(feature = "uf2")]
    spawn(&spawner, crate::tasks::battery::run(board.battery));
    spawn(&spawner, radio::run(spawner, board.radio));
}

fn spawn<S>(spawner: &Spawner, task: Result<SpawnToken<S>, SpawnError>) {
    match task {
        Ok(token) => spawner.spawn(token),
        Err(_) => panic!("a task is started twice"),
    }
}
