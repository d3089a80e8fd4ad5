//! Use of the radio: scans, streams, links that are lost.

use nrf52::time::{HZ, ms};
use shared::model::noise::Noise;
use shared::units::Sample;
use virtual_armband::{ADDRESS, ArmbandFault, Behaviour, Stranger};
use xtask::firmware::Image;

use myointent_tests::chip::{Board, OTHER, Setting};
use myointent_tests::found;

const STREAM: usize = 120;

fn samples() -> Vec<Sample> {
    let mut noise = Noise(5);
    (0..STREAM * 200).map(|_| noise.sample(20.0)).collect()
}

/// A board beside an armband that streams noise; none where the image cannot be built.
pub fn board(behaviour: Behaviour) -> Option<Board> {
    board_of(Image::Nrf52840S140, behaviour)
}

fn board_of(built: Image, behaviour: Behaviour) -> Option<Board> {
    let setting = Setting {
        samples: samples(),
        behaviour,
        ..Setting::default()
    };
    Board::of(built, setting)
}

/// Percent of the time in which the receiver is on for a scan, from now on.
fn scanned_percent(board: &mut Board, seconds: u64) -> anyhow::Result<u64> {
    let scanned = |board: &Board| board.machine.air().scanned(board.machine.now());
    let before = scanned(board);
    board.run_ms(seconds * 1000)?;
    Ok((scanned(board) - before) * 100 / (seconds * HZ))
}

#[test]
fn a_board_that_sees_nobody_for_a_minute_scans_a_tenth_of_the_time() -> anyhow::Result<()> {
    for built in [Image::Nrf52840S140, Image::Nrf52840Sdc] {
        let absent = Behaviour::with(vec![ArmbandFault::Absent]);
        let mut board = found!(board_of(built, absent));
        let at_first = scanned_percent(&mut board, 50)?;
        assert!(at_first > 90, "{built}: {at_first} %");
        board.run_ms(25_000)?;
        let later = scanned_percent(&mut board, 50)?;
        assert!((5..=11).contains(&later), "{built}: {later} %");
        // It is switched on, and found all the same.
        board.machine.air_mut().armbands[0].disconnected(0);
        board.wait_for("# armband FA", 20_000)?;
    }
    Ok(())
}

#[test]
fn a_pairing_scans_all_the_time() -> anyhow::Result<()> {
    let absent = Behaviour::with(vec![ArmbandFault::Absent]);
    let mut board = found!(board(absent));
    board.run_ms(90_000)?;
    board.ask("BIND,begin", "$OK,BIND")?;
    let pairing = scanned_percent(&mut board, 20)?;
    assert!(pairing > 90, "{pairing} %");
    Ok(())
}

#[test]
fn a_link_that_is_made_while_its_attempt_is_cancelled_is_not_kept_for_ever() -> anyhow::Result<()> {
    let built = Image::Nrf52840Sdc;
    let stranger = Stranger {
        address: OTHER,
        rssi: -80,
    };
    let setting = Setting {
        samples: samples(),
        stranger: Some(stranger),
        ..Setting::default()
    };
    let mut board = found!(Board::of(built, setting));
    board.machine.air_mut().cancel_comes_late = true;
    let connects = |board: &mut Board| board.machine.air().connects();
    board.until("attempt", 10_000, ms(1), connects)?;
    // The first ends the attempt; the second has the same armband sought.
    board.send("BIND,forget");
    board.send(&format!("BIND,set,{ADDRESS}"));
    // A link that no task of the program has keeps its armband from advertising, while the stranger is heard.
    board.wait_for("started by the watchdog", 120_000)?;
    board.wait_for("# armband FA", 120_000)
}

#[test]
fn the_parameters_that_an_armband_prefers_are_said_once() -> anyhow::Result<()> {
    let sleeps = ArmbandFault::Sleep { at: 100, for_ms: 1 };
    let mut board = found!(board(Behaviour::with(vec![sleeps])));
    board.run_ms(10_000)?;
    let text = board.text();
    assert_eq!(text.matches("# armband FA").count(), 2, "{text}");
    let said = "# the armband prefers an interval of 7.50 to 15.00 ms, latency 0, time-out 3000 ms";
    assert_eq!(text.matches(said).count(), 1, "{text}");
    Ok(())
}
