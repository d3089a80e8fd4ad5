//! Pins when the core hangs: the dead-man timer clears every label's pin and ends the pulses, on every board.

use nrf52::time::ms;
use shared::intent::Intent;
use shared::model::file::Model;
use xtask::firmware::Image;

use super::faults::effort;
use myointent_tests::chip::{Board, Setting};
use myointent_tests::{found, model_file};

/// Milliseconds of a core that stands still: more than the timer takes, less than the watchdog.
const HALT_MS: u64 = 400;
/// Milliseconds within which the pins are safe, as docs/uart.md says.
const SAFE_MS: u64 = 250;

/// The model of six classes, which sees this one in everything.
pub fn model_of(intent: Intent) -> anyhow::Result<Vec<u8>> {
    let file = model_file("six-class");
    let model = Model::parse(&file)?;
    let outputs = model.header.dimensions.row_outputs();
    let mut parts = model.to_parts();
    for row in parts.head.bias.chunks_mut(outputs) {
        row[intent.class()] = 90.0;
    }
    Ok(parts.to_bytes()?)
}

/// Pins of the labels and of `valid` that are high.
fn high(board: &Board) -> Vec<u32> {
    let chip = board.machine.chip();
    let pins = board.pins.intents.into_iter().chain([board.pins.valid]);
    pins.filter(|pin| chip.level(*pin) == Some(true)).collect()
}

#[test]
fn a_core_that_stands_still_in_any_label_loses_all_pins_on_every_board() -> anyhow::Result<()> {
    for built in Image::ALL {
        for intent in Intent::ALL {
            let setting = Setting::of(model_of(intent)?, effort(10));
            let mut board = found!(Board::of(built, setting));
            board.until_valid()?;
            let [relax, pin] = [Intent::Relax, intent].map(|one| board.pins.intents[one.class()]);
            assert_eq!(high(&board), [pin, board.pins.valid], "{built}, {intent:?}");
            let pulses = |board: &Board| {
                let chip = board.machine.chip();
                (chip.pulse().is_some(), chip.level(board.pins.strength))
            };
            assert!(pulses(&board).0, "{built}, {intent:?}");
            board.machine.chip().bus.halt(ms(HALT_MS));
            board.run_ms(SAFE_MS)?;
            assert_eq!(high(&board), [relax], "{built}, {intent:?}");
            assert_eq!(pulses(&board), (false, Some(false)), "{built}, {intent:?}");
        }
    }
    Ok(())
}
