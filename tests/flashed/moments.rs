//! Faults at any moment: a core that stands still whatever the board was doing, an interrupt at every instruction of what
//! tasks and interrupts share, RAM that holds anything at the start.

use std::cell::Cell;
use std::collections::BTreeSet;

use myointent::cli::replay;
use nrf52::chip::Reset;
use nrf52::time::{ms, us};
use nrf52::{Incident, RAM};
use shared::installation::{Block, Transfer};
use shared::uart_line::command::Command;
use virtual_armband::{ArmbandFault, Behaviour};
use xtask::firmware::Image;

use super::faults::{effort, leave_interrupts, run_code};
use super::start::FLASHED;
use myointent_tests::chip::{self, Board, OTHER, Setting};
use myointent_tests::found;

/// Something that a board does, and how it comes to it.
struct Activity {
    name: &'static str,
    /// True without an armband in reach.
    is_alone: bool,
    begin: fn(&mut Board) -> anyhow::Result<()>,
}

/// Runs until flash is being written. A time slot may not be overrun, which is refused: until after one.
fn until_flash(board: &mut Board) -> anyhow::Result<()> {
    let begun = |board: &Board| match (&board.machine.softdevice, &board.machine.controller) {
        (Some(softdevice), _) => (softdevice.flash.begun, false),
        (_, Some(controller)) => (controller.timeslot.begun, controller.timeslot.is_granted()),
        _ => (0, false),
    };
    let (before, _) = begun(board);
    board.until("operation of flash", 1000, us(100), |board| {
        let (now, is_in_slot) = begun(board);
        now != before && !is_in_slot
    })
}

fn until_a_stream(board: &mut Board) -> anyhow::Result<()> {
    board.wait_for("# armband FA", 10_000)?;
    Ok(board.run_ms(300)?)
}

const ACTIVITIES: [Activity; 8] = [
    Activity {
        name: "start",
        is_alone: true,
        begin: |board| board.wait_for("# myointent", 1000),
    },
    Activity {
        name: "scan",
        is_alone: true,
        begin: |board| Ok(board.run_ms(2000)?),
    },
    Activity {
        name: "pairing",
        is_alone: true,
        begin: |board| {
            board.run_ms(500)?;
            board.ask("BIND,begin", "$OK,BIND")
        },
    },
    Activity {
        name: "first requests of a link",
        is_alone: false,
        begin: |board| {
            let is_linked = |board: &mut Board| board.machine.air().is_linked();
            board.until("link", 5000, us(100), is_linked)
        },
    },
    Activity {
        name: "alignment",
        is_alone: false,
        begin: |board| {
            until_a_stream(board)?;
            board.ask("ALIGN,begin", "$OK,ALIGN")
        },
    },
    Activity {
        name: "raw stream",
        is_alone: false,
        begin: |board| {
            until_a_stream(board)?;
            board.send("RAW,on");
            board.wait_for("$EMG", 1000)
        },
    },
    Activity {
        name: "binding",
        is_alone: false,
        begin: |board| {
            until_a_stream(board)?;
            board.send(&format!("BIND,set,{OTHER}"));
            until_flash(board)
        },
    },
    Activity {
        name: "installation",
        is_alone: false,
        begin: |board| {
            until_a_stream(board)?;
            let file = chip::model();
            let transfer = Transfer {
                length: file.len() as u32,
                // Another file than the one in use.
                checksum: 1,
            };
            board.send_bytes(Command::Install(transfer).to_string().bytes());
            board.wait_for("$OK,INSTALL,0", 1000)?;
            let block = Command::Block(0, Block::of(&file, 0));
            board.send_bytes(block.to_string().bytes());
            until_flash(board)
        },
    },
];

/// The core stands still, as in a loop that nothing interrupts, until the chip is reset.
fn stand_still(board: &mut Board) -> anyhow::Result<()> {
    let incidents = board.machine.incidents.len();
    board.until("end of it", 3000, 1, |board| {
        let is_over = board.machine.incidents.len() > incidents;
        if !is_over {
            // One instruction each time, too few to end an interrupt.
            board.machine.chip().bus.halt(ms(50));
        }
        is_over
    })
}

/// Tasks stand still, and interrupts go on.
fn stop_tasks(board: &mut Board) -> anyhow::Result<()> {
    leave_interrupts(board)?;
    // wfi; b to it.
    run_code(board, &[0xbf30, 0xe7fd]);
    Ok(board.run_ms(2500)?)
}

#[test]
fn the_watchdog_ends_a_hang_whatever_the_board_was_doing() -> anyhow::Result<()> {
    for (number, activity) in ACTIVITIES.iter().enumerate() {
        for (how, hang) in [stand_still, stop_tasks].into_iter().enumerate() {
            // Each image has each hang, and both hangs of an activity are on different images.
            let built = FLASHED[(number + how) % FLASHED.len()];
            let steps = Vec::from_iter(activity.is_alone.then_some(ArmbandFault::Absent));
            let setting = Setting {
                samples: effort(20),
                behaviour: Behaviour::with(steps),
                ..Setting::default()
            };
            let mut board = found!(Board::of(built, setting));
            (activity.begin)(&mut board)?;
            let (from, sent) = (board.machine.now(), board.sent_bytes());
            let before = board.machine.incidents.len();
            hang(&mut board)?;
            let case = format!("{built}, {}, hang {how}", activity.name);
            let ended = board.machine.incidents.get(before);
            let Some((at, Incident::Started(Reset::Watchdog))) = ended else {
                panic!("{case}: {ended:?}");
            };
            let after = (at - from) / ms(1);
            assert!(after <= 2060, "{case}: after {after} ms");
            board.run_ms(1000)?;
            board.ask("IDENTIFY", "$OK,IDENTIFY")?;
            let said = board.text_from(sent);
            assert!(said.contains("started by the watchdog"), "{case}:\n{said}");
        }
    }
    Ok(())
}

#[test]
fn an_interrupt_at_every_instruction_of_queues_and_wakers_changes_no_label() -> anyhow::Result<()> {
    // The packets' queue, wakers of interrupts, the receiver of commands, the transmitter's ring.
    let names: [&[&str]; 4] = [
        &["messages5queue", "4push"],
        &["atomic_waker"],
        &["CommandPort"],
        &["atomic_ring_buffer"],
    ];
    let samples = effort(5);
    let expected = replay::lines(&chip::model(), &samples)?;
    let setting = Setting::of(chip::model(), samples);
    let mut board = found!(Board::of(Image::Nrf52840S140, setting));
    let functions = names.map(|parts| board.machine.image().functions(parts));
    board.wait_for("# armband FA", 10_000)?;
    board.send("COUNTERS");
    let enabled = |number: &u16| board.machine.core().priority(*number).is_some();
    let interrupts: Vec<u16> = (0..48).filter(enabled).collect();
    let (mut met, mut taken) = (BTreeSet::new(), 0);
    let end = board.machine.now() + ms(400);
    while board.machine.now() < end {
        if board.machine.core().sleeps() {
            let is_over = Cell::new(false);
            board.machine.run_until(end, |_| is_over.replace(true))?;
        }
        let place = board.machine.core().place();
        let holds = |all: &Vec<std::ops::Range<u32>>| all.iter().any(|one| one.contains(&place));
        let is_new = functions.iter().any(holds) && met.insert(place);
        if is_new {
            for interrupt in &interrupts {
                board.machine.core().pend(*interrupt);
            }
        }
        board.machine.run(1)?;
        let went = board.machine.core().place().abs_diff(place);
        taken += usize::from(is_new && went > 0x400);
    }
    for (names, all) in names.iter().zip(&functions) {
        let is_met = |place: &u32| all.iter().any(|one| one.contains(place));
        let count = met.iter().filter(|place| is_met(place)).count();
        assert!(count > 10, "{names:?}: {count} instructions");
    }
    // Where interrupts are enabled they come at once.
    assert!(taken > 20, "{taken} of {} taken at once", met.len());
    board.wait_for("# stream over", 10_000)?;
    board.run_ms(200)?;
    let lines = board.lines().concat();
    assert!(lines.starts_with(&expected), "{}", board.text());
    assert!(board.text().contains("$OK,COUNTERS"), "{}", board.text());
    Ok(())
}

#[test]
fn whatever_ram_holds_at_the_start_the_first_lines_are_the_same() -> anyhow::Result<()> {
    for built in FLASHED {
        let mut board = found!(Board::of(built, Setting::default()));
        board.wait_for("$STATE", 1000)?;
        let expected = board.text();
        assert!(expected.contains("started by power or reset"), "{expected}");
        board.run_ms(2000)?;
        let memory = board.memory();
        let bytes = memory.ram.len() as u32;
        // A supply that is away for a moment leaves what the program had.
        let left = memory.read(RAM, bytes).expect("RAM");
        for content in [left, vec![0; bytes as usize], vec![0xff; bytes as usize]] {
            board.machine.reset(Reset::Power);
            memory.write(RAM, &content);
            let sent = board.sent_bytes();
            board.wait_from(sent, "$STATE", 1000)?;
            let said = board.text_from(sent);
            assert!(said.contains(expected.trim_end()), "{built}:\n{said}");
        }
    }
    Ok(())
}
