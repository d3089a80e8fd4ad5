//! The UART's receiver: nothing that comes on the line ends it.

use std::iter::repeat_n;

use shared::model::noise::Noise;
use xtask::firmware::Image;

use super::start::FLASHED;
use myointent_tests::chip::{Board, OTHER, Setting};
use myointent_tests::found;

const NOISE: usize = 1_000_000;

fn board(built: Image) -> Option<Board> {
    Board::of(built, Setting::default())
}

#[test]
fn bytes_that_come_while_a_page_is_erased_do_not_end_the_receiver() -> anyhow::Result<()> {
    for built in [Image::Nrf52840S140, Image::Nrf52832S132] {
        let mut board = found!(board(built));
        board.run_ms(500)?;
        // The core stands still for 85 ms; these take 260 ms. Outside of a line they mean nothing.
        board.send(&format!("BIND,set,{OTHER}"));
        board.send_bytes(repeat_n(b'x', 3000));
        board.run_ms(1000)?;
        assert_eq!(board.bound(), Some(OTHER), "{built}");
        board.ask("IDENTIFY", "$OK,IDENTIFY")?;
        // The ring of the nRF52840 holds them all.
        let is_said = board.text().contains("# received bytes were lost");
        let is_lost = built == Image::Nrf52832S132;
        assert_eq!(is_said, is_lost, "{built}:\n{}", board.text());
    }
    Ok(())
}

#[test]
fn a_command_is_answered_after_a_million_bytes_of_noise() -> anyhow::Result<()> {
    // Whether RXDRDY comes for a byte without its stop bit no specification says.
    for counts_broken in [false, true] {
        let mut board = found!(board(Image::Nrf52840S140));
        board.run_ms(500)?;
        let mut noise = Noise(11);
        let mut any = || ((noise.signed() + 1.0) * 128.0) as u8;
        let bytes: Vec<_> = (0..NOISE / 2).map(|_| (any(), any() < 16)).collect();
        let now = board.machine.now();
        {
            let mut chip = board.machine.chip();
            chip.count_broken_bytes(counts_broken);
            chip.receive(now, bytes);
        }
        // 87 us each.
        board.run_ms(NOISE as u64 / 2 * 87 / 1000 + 500)?;
        board.ask("IDENTIFY", "$OK,IDENTIFY")?;
        board.ask("COUNTERS", "$OK,COUNTERS")?;
    }
    Ok(())
}

#[test]
fn a_clock_that_is_off_by_two_percent_until_the_crystal_runs_leaves_the_line_readable()
-> anyhow::Result<()> {
    for built in FLASHED {
        // More than an oscillator is ever off: then only the crystal makes the line readable.
        for thousandths in [-20, 20, 200] {
            let mut board = found!(board(built));
            board.machine.chip().bus.inaccuracy = thousandths;
            board.send("IDENTIFY");
            board.run_ms(1000)?;
            board.ask("IDENTIFY", "$OK,IDENTIFY")?;
            let text = board.text();
            let is_whole = text.is_ascii() && text.starts_with("# myointent");
            assert!(
                is_whole || thousandths == 200,
                "{built}, {thousandths}:\n{text}"
            );
        }
    }
    Ok(())
}
