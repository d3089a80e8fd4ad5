//! The receiver against simulated flash, whose power fails at every operation.

use super::journal::{JOURNAL_BYTES, Journal};
use super::*;
use alloc::vec::Vec;
use proptest::prelude::*;

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

/// Power has failed.
#[derive(Debug, PartialEq)]
struct PowerFailed;

/// Memory that outlasts a loss of power: erased to ones, programmed to zeros.
#[derive(Clone)]
struct Flash {
    region: Vec<u8>,
    journal: [u8; JOURNAL_BYTES],
    /// Operations until power fails, in the middle of one.
    left: usize,
}

impl Flash {
    fn of(file: &[u8]) -> Self {
        let mut region = file.to_vec();
        region.resize(CAPACITY, 0xff);
        Self {
            region,
            journal: [0xff; JOURNAL_BYTES],
            left: usize::MAX,
        }
    }

    /// Part of an operation that is done.
    fn part(&mut self, of: usize) -> usize {
        self.left -= 1;
        if self.left == 0 { of / 2 } else { of }
    }

    fn power(&self) -> Result<(), PowerFailed> {
        if self.left == 0 {
            Err(PowerFailed)
        } else {
            Ok(())
        }
    }

    fn holds(&self, file: &[u8]) -> bool {
        self.region.starts_with(file)
    }

    fn program(bytes: &mut [u8], content: &[u8]) {
        for (byte, content) in bytes.iter_mut().zip(content) {
            assert_eq!(*byte & content, *content, "written without an erasure");
            *byte &= content;
        }
    }
}

/// A board: its flash, and what a loss of power takes.
struct Board {
    flash: Flash,
    installation: Installation,
    /// The model that is in use, by its first byte.
    in_use: Option<u8>,
    is_safe: bool,
}

impl Board {
    /// A start; these are the files that count as models.
    fn start(flash: Flash, models: &[&[u8]]) -> Self {
        let whole = models.iter().find(|model| flash.holds(model));
        Self {
            in_use: whole.map(|model| model[0]),
            is_safe: whole.is_none(),
            installation: Installation::new(CAPACITY as u32),
            flash,
        }
    }

    fn journal(&self) -> Option<Journal> {
        journal::read(&self.flash.journal).filter(|_| self.in_use.is_none())
    }

    fn begin(&mut self, transfer: Transfer) -> Result<Progress, Refused> {
        let journal = self.journal();
        self.installation.begin(transfer, journal)
    }

    fn take(&mut self, file: &[u8], number: u32) -> Result<Result<Progress, Refused>, PowerFailed> {
        let taken = self
            .installation
            .take(number, &Block::of(file, number), |block| block.0[0] < 0x80);
        if let Err(refused) = taken {
            return Ok(Err(refused));
        }
        while let Some(step) = self.installation.step() {
            let outcome = self.carry_out(step, file)?;
            if let Err(refused) = self.installation.done(outcome) {
                return Ok(Err(refused));
            }
        }
        Ok(Ok(self.installation.progress()))
    }

    fn carry_out(&mut self, step: Step, file: &[u8]) -> Result<Result<(), Refused>, PowerFailed> {
        match step {
            Step::Suspend => {
                self.is_safe = true;
                self.in_use = None;
                return Ok(Ok(()));
            }
            Step::Verify => {
                return Ok(self.flash.holds(file).then_some(()).ok_or(Refused::Model));
            }
            Step::Resume => {
                self.in_use = Some(file[0]);
                self.is_safe = false;
                return Ok(Ok(()));
            }
            _ => assert!(
                self.is_safe && self.in_use.is_none(),
                "{step:?} while a model is in use"
            ),
        }
        let flash = &mut self.flash;
        match step {
            Step::EraseJournal | Step::EndJournal => {
                let part = flash.part(JOURNAL_BYTES);
                flash.journal[..part].fill(0xff);
            }
            Step::WriteJournal => {
                let record = self.installation.record();
                let part = flash.part(record.len());
                Flash::program(&mut flash.journal[..part], &record);
            }
            Step::ErasePage(page) => {
                let part = flash.part(PAGE_BYTES);
                flash.region[page as usize * PAGE_BYTES..][..part].fill(0xff);
            }
            Step::WriteBlock(number) => {
                let part = flash.part(BLOCK_BYTES);
                let place = number as usize * BLOCK_BYTES;
                let content = self.installation.content().0;
                Flash::program(&mut flash.region[place..][..part], &content);
            }
            Step::MarkPage(page) => {
                let part = flash.part(4);
                Flash::program(
                    &mut flash.journal[journal::mark(page) as usize..][..part],
                    &[0; 4],
                );
            }
            Step::Suspend | Step::Verify | Step::Resume => {}
        }
        flash.power().map(Ok)
    }
}

/// Sends a file until it is in use or power fails; gives the number of blocks sent.
fn send(board: &mut Board, file: &[u8]) -> Result<usize, PowerFailed> {
    let mut sent = 0;
    let mut progress = board.begin(transfer(file)).unwrap();
    while let Progress::Next(number) = progress {
        progress = board.take(file, number)?.unwrap();
        sent += 1;
    }
    Ok(sent)
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
        assert!(
            order[order.len() - first_page..]
                .iter()
                .all(|&number| number < 64)
        );
        assert_eq!(transfer.pages(), length.div_ceil(4096));
    }
}

#[test]
fn a_file_is_installed_and_in_use() {
    let (old, new) = (file(1), file(2));
    let mut board = Board::start(Flash::of(&old), &[&old, &new]);
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
        let mut board = Board::start(Flash::of(&old), &[&old, &new]);
        board.flash.left = operation;
        if send(&mut board, &new).is_ok() {
            break;
        }
        let written = board.flash.clone();
        let mut board = Board::start(
            Flash {
                left: usize::MAX,
                ..written
            },
            &[&old, &new],
        );
        // The first operation is the journal's; the last one too, when the file is whole.
        let expected = match operation {
            1 | 2 => Some(1),
            _ if board.flash.holds(&new) => Some(2),
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
fn power_that_fails_every_70_operations_installs_it_all_the_same() {
    let (old, new) = (file(1), file(2));
    let mut flash = Flash::of(&old);
    let mut starts = 0;
    let board = loop {
        flash.left = 70;
        let mut board = Board::start(flash, &[&old, &new]);
        starts += 1;
        assert!(starts < 30, "no progress");
        if board.in_use == Some(2) || send(&mut board, &new).is_ok() {
            break board;
        }
        flash = board.flash;
    };
    assert_eq!(board.in_use, Some(2));
    assert!(starts > 5);
}

#[test]
fn another_file_begins_from_the_start_and_the_same_one_goes_on() {
    let (old, new, other) = (file(1), file(2), file(3));
    let mut board = Board::start(Flash::of(&old), &[&old, &new, &other]);
    board.begin(transfer(&new)).unwrap();
    for number in [0, 64, 65, 66] {
        assert!(board.take(&new, number).unwrap().is_ok());
    }
    assert_eq!(board.begin(transfer(&new)), Ok(Progress::Next(67)));
    assert_eq!(board.begin(transfer(&other)), Ok(Progress::Next(0)));
    assert!(send(&mut board, &other).is_ok());
    assert_eq!(board.in_use, Some(3));
}

#[test]
fn what_was_not_asked_for_changes_nothing() {
    let (old, new) = (file(1), file(2));
    let mut board = Board::start(Flash::of(&old), &[&old, &new]);
    assert_eq!(board.take(&new, 0).unwrap(), Err(Refused::NotBegun));
    let long = Transfer {
        length: CAPACITY as u32 + 1,
        checksum: 0,
    };
    assert_eq!(board.begin(long), Err(Refused::Length));
    assert_eq!(
        board.begin(Transfer {
            length: 64,
            checksum: 0
        }),
        Err(Refused::Length)
    );
    assert_eq!(board.begin(transfer(&new)), Ok(Progress::Next(0)));
    let blocks = transfer(&new).blocks();
    assert_eq!(board.take(&new, blocks).unwrap(), Err(Refused::NoSuchBlock));
    assert_eq!(board.take(&new, 1).unwrap(), Ok(Progress::Next(0)));
    assert_eq!(board.in_use, Some(1), "begun, but nothing was sent");
    assert_eq!(board.take(&new, 0).unwrap(), Ok(Progress::Next(64)));
    assert_eq!(board.in_use, None);
    for wrong in [0, 1, 63, 65, blocks - 1] {
        let before = board.flash.region.clone();
        assert_eq!(board.take(&new, wrong).unwrap(), Ok(Progress::Next(64)));
        assert_eq!(board.flash.region, before);
    }
}

#[test]
fn a_first_block_that_is_not_ours_leaves_the_model_in_use() {
    let (old, new) = (file(1), file(0x90));
    let mut board = Board::start(Flash::of(&old), &[&old]);
    board.begin(transfer(&new)).unwrap();
    assert_eq!(board.take(&new, 0).unwrap(), Err(Refused::Model));
    assert_eq!(board.in_use, Some(1));
    assert_eq!(board.take(&new, 64).unwrap(), Err(Refused::NotBegun));
}

#[test]
fn a_file_that_is_no_model_is_refused_and_the_next_begins_from_the_start() {
    let (old, new) = (file(1), file(2));
    let mut board = Board::start(Flash::of(&old), &[&old, &new]);
    // One block comes from another file, and no checksum of the line finds it.
    let mut progress = board.begin(transfer(&new)).unwrap();
    let refused = loop {
        let Progress::Next(number) = progress else {
            panic!("installed");
        };
        let from = if number == 130 { &old } else { &new };
        if number == 130 {
            let block = Block::of(from, number);
            board.installation.take(number, &block, |_| true).unwrap();
            while let Some(step) = board.installation.step() {
                let outcome = board.carry_out(step, &new).unwrap();
                board.installation.done(outcome).unwrap();
            }
            progress = board.installation.progress();
            continue;
        }
        match board.take(&new, number).unwrap() {
            Ok(next) => progress = next,
            Err(refused) => break refused,
        }
    };
    assert_eq!(refused, Refused::Model);
    assert!(board.is_safe);
    assert_eq!(board.begin(transfer(&new)), Ok(Progress::Next(0)));
    assert_eq!(send(&mut board, &new), Ok(transfer(&new).blocks() as usize));
    assert_eq!(board.in_use, Some(2));
}

#[test]
fn flash_that_refuses_leaves_the_block_missing() {
    let new = file(2);
    let mut installation = Installation::new(CAPACITY as u32);
    installation.begin(transfer(&new), None).unwrap();
    for failing in 1..4 {
        installation.take(0, &Block::of(&new, 0), |_| true).unwrap();
        for _ in 0..failing {
            installation.done(Ok(())).unwrap();
        }
        let failed = Err(Refused::Flash);
        assert_eq!(installation.done(failed), failed);
        assert_eq!(installation.step(), None);
        assert_eq!(installation.progress(), Progress::Next(0));
    }
}

#[test]
fn a_model_that_is_not_suspended_or_not_put_in_use_is_no_failure_of_flash() {
    let (old, new) = (file(1), file(2));
    for failing in [Step::Suspend, Step::Resume] {
        let mut board = Board::start(Flash::of(&old), &[&old, &new]);
        let mut progress = board.begin(transfer(&new)).unwrap();
        let mut failed = None;
        while let Progress::Next(number) = progress {
            let block = Block::of(&new, number);
            board.installation.take(number, &block, |_| true).unwrap();
            while let Some(step) = board.installation.step() {
                if step == failing && failed.is_none() {
                    let busy = Err(Refused::Busy);
                    failed = Some(board.installation.done(busy).unwrap_err());
                    break;
                }
                let outcome = board.carry_out(step, &new).unwrap();
                board.installation.done(outcome).unwrap();
            }
            progress = board.installation.progress();
        }
        // The block was missing still, and sent again.
        assert_eq!(failed, Some(Refused::Busy), "{failing:?}");
        assert_eq!(board.in_use, Some(2));
    }
}

#[test]
fn a_model_that_cannot_be_put_in_use_ends_the_transfer() {
    let (old, new) = (file(1), file(2));
    let mut board = Board::start(Flash::of(&old), &[&old, &new]);
    let mut progress = board.begin(transfer(&new)).unwrap();
    let refused = 'refused: loop {
        let Progress::Next(number) = progress else {
            panic!("installed");
        };
        let block = Block::of(&new, number);
        board.installation.take(number, &block, |_| true).unwrap();
        while let Some(step) = board.installation.step() {
            if step == Step::Resume {
                break 'refused board.installation.done(Err(Refused::Model));
            }
            let outcome = board.carry_out(step, &new).unwrap();
            board.installation.done(outcome).unwrap();
        }
        progress = board.installation.progress();
    };
    assert_eq!(refused, Err(Refused::Model));
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
    assert_eq!(
        journal::read(&page),
        Some(Journal {
            transfer,
            marked: 0
        })
    );
    for marked in 1..64 {
        page[journal::mark(marked) as usize..][..4].fill(0);
        assert_eq!(journal::read(&page), Some(Journal { transfer, marked }));
    }
    for written in 0..16 {
        let mut half = [0xff; JOURNAL_BYTES];
        half[..written].copy_from_slice(&page[..written]);
        assert_eq!(journal::read(&half), None, "{written} bytes");
    }
}

proptest! {
    #[test]
    fn any_blocks_in_any_order_never_panic_and_install_nothing_else(
        numbers in prop::collection::vec(0_u32..620, 0..200), left in 1_usize..300,
    ) {
        let (old, new) = (file(1), file(2));
        let mut board = Board::start(Flash::of(&old), &[&old, &new]);
        board.flash.left = left;
        board.begin(transfer(&new)).unwrap();
        for number in numbers {
            if board.take(&new, number).is_err() {
                break;
            }
        }
        let board = Board::start(Flash { left: usize::MAX, ..board.flash }, &[&old, &new]);
        prop_assert!(board.in_use != Some(2));
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
