//! Flash that is written by the SoftDevice's calls: power fails in the middle, and no time is found beside the radio.

use std::iter::repeat_n;

use nrf52::softdevice::Fate;
use virtual_armband::ADDRESS;
use xtask::firmware::Image;

use myointent_tests::chip::{self, Board, OTHER, Setting};
use myointent_tests::found;

/// A binding has fewer operations of flash.
const MOST_OPERATIONS: usize = 8;
/// Most operations in time slots: nine partial erasures, and words.
const MOST_OPERATIONS_IN_SLOTS: usize = 40;

/// A board with Nordic's controller library, which grants time slots for flash.
fn board_with_time_slots() -> Option<Board> {
    let setting = Setting::of(chip::model(), vec![[1; 8]; 60 * 200]);
    Board::of(Image::Nrf52840Sdc, setting)
}

fn board(fates: impl IntoIterator<Item = Fate>) -> Option<Board> {
    let mut board = Board::of(Image::Nrf52840S140, Setting::default())?;
    board.flash().fates.extend(fates);
    Some(board)
}

/// Checks that the page holds one of both armbands or none, and that binding can be done again.
fn check_page(board: &mut Board, case: &str, again_ms: u64) -> anyhow::Result<()> {
    let found = board.bound();
    let allowed = [None, Some(ADDRESS), Some(OTHER)];
    assert!(allowed.contains(&found), "{case}: {found:?}");
    board.send(&format!("BIND,set,{OTHER}"));
    board.run_ms(again_ms)?;
    assert_eq!(board.bound(), Some(OTHER), "{case}:\n{}", board.text());
    Ok(())
}

#[test]
fn power_that_fails_while_the_page_is_written_leaves_one_armband_or_none() -> anyhow::Result<()> {
    for operation in 0..MOST_OPERATIONS {
        for percent in [0, 50, 100] {
            let before = repeat_n(Fate::Success, operation);
            let cut = Fate::PowerCut { percent };
            let mut board = found!(board(before.chain([cut])));
            board.run_ms(500)?;
            board.send(&format!("BIND,set,{OTHER}"));
            board.run_ms(1500)?;
            if !board.flash().fates.is_empty() {
                assert!(operation > 0, "no operation of flash:\n{}", board.text());
                return Ok(());
            }
            check_page(
                &mut board,
                &format!("operation {operation}, {percent} %"),
                1500,
            )?;
        }
    }
    anyhow::bail!("more than {MOST_OPERATIONS} operations for a page")
}

#[test]
fn binding_in_time_slots_writes_the_page_beside_a_stream() -> anyhow::Result<()> {
    // Without and with slots that find no time: they are asked for again, and urgently.
    for blocked in [0, 3] {
        let mut board = found!(board_with_time_slots());
        board.wait_for("$LABEL", 10_000)?;
        let slots = &mut board.controller().timeslot;
        slots.blocked = blocked;
        let before = slots.begun;
        board.send(&format!("BIND,set,{OTHER}"));
        board.wait_for("$OK,BIND", 3000)?;
        board.run_ms(2000)?;
        assert_eq!(board.bound(), Some(OTHER), "{}", board.text());
        assert!(board.controller().timeslot.begun > before);
    }
    Ok(())
}

#[test]
fn power_that_fails_in_a_time_slot_leaves_one_armband_or_none() -> anyhow::Result<()> {
    for operation in 0..MOST_OPERATIONS_IN_SLOTS {
        let mut board = found!(board_with_time_slots());
        board.run_ms(500)?;
        board.machine.chip().nvmc.power_fails_after = Some(operation);
        board.send(&format!("BIND,set,{OTHER}"));
        board.run_ms(1500)?;
        if board.machine.chip().nvmc.power_fails_after.is_some() {
            assert!(
                operation > 9,
                "{operation} operations of flash:\n{}",
                board.text()
            );
            return Ok(());
        }
        check_page(&mut board, &format!("operation {operation}"), 2000)?;
    }
    anyhow::bail!("more than {MOST_OPERATIONS_IN_SLOTS} operations for a page")
}

#[test]
fn flash_that_finds_no_time_at_first_is_asked_again() -> anyhow::Result<()> {
    let fates = [Fate::TimeOut, Fate::TimeOut, Fate::Success, Fate::TimeOut];
    let mut board = found!(board(fates));
    board.run_ms(500)?;
    board.send(&format!("BIND,set,{OTHER}"));
    board.run_ms(4000)?;
    assert_eq!(board.bound(), Some(OTHER), "{}", board.text());
    let said = board.text().contains("did not take the change");
    assert!(!said, "{}", board.text());
    Ok(())
}

#[test]
fn flash_that_finds_no_time_beside_the_radio_is_said() -> anyhow::Result<()> {
    let mut board = found!(board(repeat_n(Fate::TimeOut, 20)));
    board.run_ms(500)?;
    board.send(&format!("BIND,set,{OTHER}"));
    board.wait_for("the flash page did not take the change", 5000)?;
    Ok(())
}
