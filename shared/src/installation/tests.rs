//! The receiver against simulated flash, whose power fails at every operation.

use super::journal::{JOURNAL_BYTES, Journal};
use super::*;
use alloc::vec::Vec;

mod board;

use board::{Board, flash, send};

/// Ten pages, the last not full, and the last block not either.
const LENGTH: usize = 9 * PAGE_BYTES + 5 * BLOCK_BYTES + 7;
const CAPACITY: usize = 12 * PAGE_BYTES;

fn file(seed: u8) -> Vec<u8> {
    let mut noise = crate::model::noise::Noise(u64::from(seed));
    let mut file: Vec<u8> = (0..LENGTH)
        .map(|_| (noise.signed() * 127.0) as i8 as u8)
        .collect();
    file[0] = seed;
    file
}

fn transfer(file: &[u8]) -> Transfer {
    let checksum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(file);
    Transfer {
        length: file.len() as u32,
        checksum,
    }
}

const fn next(block: u32) -> Result<InstallationProgress, Refused> {
    Ok(InstallationProgress::Next(block))
}

/// Two models, and a board that has both as such and the first one in use.
fn started() -> (Vec<u8>, Vec<u8>, Board) {
    let (old, new) = (file(1), file(2));
    let board = Board::start(flash(&old), &[&old, &new]);
    (old, new, board)
}

/// Sends a file, each block from what `from` gives, until one is refused.
fn refusal<'f>(board: &mut Board, file: &[u8], from: impl Fn(u32) -> &'f Vec<u8>) -> Refused {
    let mut progress = board.begin(transfer(file)).unwrap();
    while let InstallationProgress::Next(number) = progress {
        match board.take(from(number), number).unwrap() {
            Ok(next) => progress = next,
            Err(refused) => return refused,
        }
    }
    panic!("installed");
}

#[test]
fn every_block_is_asked_for_once_and_the_first_page_last() {
    for length in [65, 128, 4095, 4096, 4097, 4160, 8192, LENGTH as u32] {
        let transfer = Transfer {
            length,
            checksum: 0,
        };
        let order: Vec<u32> = (0..transfer.blocks())
            .map(|taken| transfer.block(taken))
            .collect();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..transfer.blocks()), "{length}");
        assert_eq!(order[0], 0);
        for (before, &number) in order.iter().enumerate() {
            assert_eq!(transfer.before(number), before as u32);
        }
        let first_page = order.len().min(64) - 1;
        let last = &order[order.len() - first_page..];
        assert!(last.iter().all(|&number| number < 64), "{length}");
        assert_eq!(transfer.pages(), length.div_ceil(4096));
    }
}

#[test]
fn a_file_is_installed_and_in_use() {
    let (old, new, mut board) = started();
    assert_eq!(board.in_use, Some(1));
    assert_eq!(send(&mut board, &new), Ok(transfer(&new).blocks() as usize));
    assert_eq!(board.in_use, Some(2));
    assert_eq!(board.flash.journal, [0xff; JOURNAL_BYTES]);
    // And another one after it.
    assert!(send(&mut board, &old).is_ok());
    assert_eq!(board.in_use, Some(1));
}

#[test]
fn power_that_fails_at_any_operation_leaves_the_old_model_or_none_and_the_file_is_gone_on_with() {
    let (old, new) = (file(1), file(2));
    let blocks = transfer(&new).blocks() as usize;
    let mut operation = 0;
    loop {
        operation += 1;
        let mut board = Board::start(flash(&old), &[&old, &new]);
        board.left = operation;
        if send(&mut board, &new).is_ok() {
            break;
        }
        let mut board = Board::start(board.flash, &[&old, &new]);
        // The first operation is the journal's; the last one too, when the file is whole.
        let expected = match operation {
            1 | 2 => Some(1),
            _ if board.flash.region.starts_with(&new) => Some(2),
            _ => None,
        };
        assert_eq!(board.in_use, expected, "operation {operation}");
        if expected == Some(2) {
            continue;
        }
        let sent = send(&mut board, &new).unwrap();
        assert_eq!(board.in_use, Some(2), "operation {operation}");
        // At most the page that was being written is sent again, and the first block.
        let left = blocks.saturating_sub(operation.saturating_sub(30));
        assert!(
            sent <= left + 64 + 1,
            "operation {operation}: {sent} blocks sent again, {left} were left"
        );
    }
    assert!(operation > blocks, "{operation}");
}

#[test]
fn another_file_begins_from_the_start_and_the_same_one_goes_on() {
    let (old, new, other) = (file(1), file(2), file(3));
    let mut board = Board::start(flash(&old), &[&old, &new, &other]);
    board.begin(transfer(&new)).unwrap();
    for number in [0, 64, 65, 66] {
        assert!(board.take(&new, number).unwrap().is_ok());
    }
    assert_eq!(board.begin(transfer(&new)), next(67));
    assert_eq!(board.begin(transfer(&other)), next(0));
    assert!(send(&mut board, &other).is_ok());
    assert_eq!(board.in_use, Some(3));
}

#[test]
fn what_was_not_asked_for_changes_nothing() {
    let (_, new, mut board) = started();
    assert_eq!(board.take(&new, 0).unwrap(), Err(Refused::NotBegun));
    for length in [CAPACITY as u32 + 1, 64] {
        let begun = board.begin(Transfer {
            length,
            checksum: 0,
        });
        assert_eq!(begun, Err(Refused::Length), "{length} bytes");
    }
    assert_eq!(board.begin(transfer(&new)), next(0));
    let blocks = transfer(&new).blocks();
    assert_eq!(board.take(&new, blocks).unwrap(), Err(Refused::NoSuchBlock));
    assert_eq!(board.take(&new, 1).unwrap(), next(0));
    assert_eq!(board.in_use, Some(1), "begun, but nothing was sent");
    assert_eq!(board.take(&new, 0).unwrap(), next(64));
    assert_eq!(board.in_use, None);
    for wrong in [0, 1, 63, 65, blocks - 1] {
        let before = board.flash.region.clone();
        assert_eq!(board.take(&new, wrong).unwrap(), next(64));
        assert_eq!(board.flash.region, before);
    }
}

#[test]
fn a_first_block_that_is_not_ours_leaves_the_model_in_use() {
    let (old, new) = (file(1), file(0x90));
    let mut board = Board::start(flash(&old), &[&old]);
    board.begin(transfer(&new)).unwrap();
    assert_eq!(board.take(&new, 0).unwrap(), Err(Refused::Model));
    assert_eq!(board.in_use, Some(1));
    assert_eq!(board.take(&new, 64).unwrap(), Err(Refused::NotBegun));
}

#[test]
fn a_file_that_is_no_model_is_refused_and_the_next_begins_from_the_start() {
    let (old, new, mut board) = started();
    // One block comes from another file, and no checksum of the line finds it.
    let refused = refusal(
        &mut board,
        &new,
        |number| if number == 130 { &old } else { &new },
    );
    assert_eq!(refused, Refused::Model);
    assert!(board.is_safe);
    assert_eq!(board.begin(transfer(&new)), next(0));
    assert_eq!(send(&mut board, &new), Ok(transfer(&new).blocks() as usize));
    assert_eq!(board.in_use, Some(2));
}

#[test]
fn a_failure_while_flash_still_holds_the_old_model_puts_it_back_in_use() {
    for failing in [
        InstallationStep::Suspend,
        InstallationStep::EraseJournal,
        InstallationStep::WriteJournal,
        InstallationStep::ErasePage(0),
    ] {
        let (_, new, mut board) = started();
        board.begin(transfer(&new)).unwrap();
        board.failing = Some((failing, Refused::Flash));
        let failure = board.take(&new, 0).unwrap();
        assert_eq!(failure, Err(Refused::Flash), "{failing:?}");
        assert_eq!(board.in_use, Some(1), "{failing:?}");
        assert!(!board.is_safe, "{failing:?}");
        assert_eq!(board.begin(transfer(&new)), next(0));
        assert!(send(&mut board, &new).is_ok());
        assert_eq!(board.in_use, Some(2), "{failing:?}");
    }
}

#[test]
fn a_failure_that_left_half_a_page_leaves_the_board_safe_and_the_block_missing() {
    let (_, new, mut board) = started();
    board.begin(transfer(&new)).unwrap();
    board.flash.region[..PAGE_BYTES / 2].fill(0xff);
    board.failing = Some((InstallationStep::ErasePage(0), Refused::Flash));
    assert_eq!(board.take(&new, 0).unwrap(), Err(Refused::Flash));
    assert_eq!((board.in_use, board.is_safe), (None, true));
    assert_eq!(board.begin(transfer(&new)), next(0));
    assert!(send(&mut board, &new).is_ok());
    assert_eq!(board.in_use, Some(2));
}

#[test]
fn a_model_that_is_not_suspended_or_not_put_in_use_is_no_failure_of_flash() {
    for failing in [InstallationStep::Suspend, InstallationStep::Resume] {
        let (_, new, mut board) = started();
        board.failing = Some((failing, Refused::Busy));
        assert_eq!(refusal(&mut board, &new, |_| &new), Refused::Busy);
        // The block is missing still.
        assert!(send(&mut board, &new).is_ok());
        assert_eq!(board.in_use, Some(2));
    }
}

#[test]
fn a_model_that_cannot_be_put_in_use_ends_the_transfer() {
    let (_, new, mut board) = started();
    board.failing = Some((InstallationStep::Resume, Refused::Model));
    assert_eq!(refusal(&mut board, &new, |_| &new), Refused::Model);
    assert_eq!(board.take(&new, 63).unwrap(), Err(Refused::NotBegun));
    assert!(board.is_safe);
}

#[test]
fn a_journal_is_read_back_and_a_damaged_one_is_none() {
    let transfer = Transfer {
        length: 84_729,
        checksum: 0x5f3a_0c11,
    };
    let mut page = [0xff; JOURNAL_BYTES];
    assert_eq!(journal::read(&page), None);
    page[..16].copy_from_slice(&journal::to_record(transfer));
    for marked in 0..64 {
        if marked > 0 {
            page[journal::mark(marked) as usize..][..4].fill(0);
        }
        assert_eq!(journal::read(&page), Some(Journal { transfer, marked }));
    }
    for written in 0..16 {
        let mut half = [0xff; JOURNAL_BYTES];
        half[..written].copy_from_slice(&page[..written]);
        assert_eq!(journal::read(&half), None, "{written} bytes");
    }
}

#[test]
fn the_block_behind_the_end_of_a_file_is_erased() {
    let blocks: Vec<Block> = (0..3).map(|number| Block::of(&[7; 70], number)).collect();
    assert_eq!(blocks[0].0, [7; 64]);
    assert_eq!(blocks[1].0[..6], [7; 6]);
    assert_eq!(blocks[1].0[6..], [0xff; 58]);
    assert_eq!(blocks[2], Block::ERASED);
}
