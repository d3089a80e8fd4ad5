//! Refusals beside Nordic's controller library, none of which is executed: each with a program that earns it.

use nrf52::{Refusal, What};
use xtask::firmware::Image;

use super::faults::{leave_interrupts, run_code};
use myointent_tests::chip::{Board, Setting};
use myointent_tests::found;

/// A board whose radio runs; where the image cannot be built, reports the test as skipped.
fn board() -> anyhow::Result<Option<Board>> {
    let mut board = found!(Board::of(Image::Nrf52840Sdc, Setting::default()), None);
    board.run_ms(600)?;
    leave_interrupts(&mut board)?;
    Ok(Some(board))
}

/// Lets a board run these instructions, with registers 0 and 1; returns why that is refused.
fn refused(board: &mut Board, registers: [u32; 2], code: &[u16]) -> Refusal {
    for (number, value) in (0..).zip(registers) {
        board.machine.core().set_register(number, value);
    }
    // Awake.
    board.machine.core().pend(20);
    run_code(board, code);
    board.run_ms(50).expect_err("it has to be refused")
}

#[test]
fn instructions_of_the_library_are_refused() -> anyhow::Result<()> {
    let mut board = found!(board()?);
    let inside = board.controller().library().range.start + 4;
    // bx r0
    let refusal = refused(&mut board, [inside | 1, 0], &[0x4700]);
    assert_eq!(refusal.what, What::LibraryCode, "{refusal}");
    Ok(())
}

#[test]
fn what_the_library_has_taken_is_refused() -> anyhow::Result<()> {
    // RADIO, TIMER0, RTC0, CLOCK's start, NVMC, a channel of the interconnect.
    let taken = [
        0x4000_1000,
        0x4000_8000,
        0x4000_b000,
        0x4000_0000,
        0x4001_e504,
        0x4001_f598,
    ];
    for address in taken {
        let mut board = found!(board()?);
        // str r1, [r0]
        let refusal = refused(&mut board, [address, 1], &[0x6001]);
        assert_eq!(refusal.what, What::Controllers, "{address:#x}: {refusal}");
    }
    Ok(())
}

#[test]
fn memory_of_the_library_that_is_written_is_refused() -> anyhow::Result<()> {
    let mut board = found!(board()?);
    let memory = board.controller().memory();
    let memory = memory.expect("the controller is enabled");
    board.memory().write(memory.end - 1, &[0]);
    // It is looked at with the next work of low priority.
    board.machine.core().pend(20);
    let refusal = board.run_ms(1000).expect_err("it has to be refused");
    assert!(matches!(refusal.what, What::WrongCall { .. }), "{refusal}");
    Ok(())
}

#[test]
fn a_call_of_the_library_from_an_interrupt_is_refused() -> anyhow::Result<()> {
    let mut board = found!(board()?);
    let functions = &board.controller().library().functions;
    let mut functions = functions.iter();
    let get = functions.find(|(_, name)| *name == "sdc_hci_get");
    let get = *get.expect("a function that every image calls").0;
    while !board.machine.core().is_in_handler() {
        board.machine.run(1)?;
    }
    // bx r0
    let refusal = refused(&mut board, [get | 1, 0], &[0x4700]);
    assert!(
        refusal.to_string().contains("from an interrupt"),
        "{refusal}"
    );
    Ok(())
}
