//! The regions of flash that the program writes: files, so that they outlast a reset. Power may fail in the middle of an
//! operation.

use std::fs::File;
use std::io::{Seek as _, SeekFrom, Write as _};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

use embassy_time::Timer;

use super::{power, surroundings};
use crate::flash::{self, Flash, FlashFailed, PAGE_BYTES, Region};
use crate::reset_reason::ResetReason;

/// Microseconds of an erasure and of a word (nRF52840 product specification, NVMC). Other tasks run meanwhile, as beside a
/// Bluetooth stack that erases a page in parts or reports the end by an event.
const ERASE_US: u64 = 85_000;
const WORD_US: u64 = 41;

/// Percent.
const HALF: u32 = 50;

/// Flash, by the SoftDevice's rules.
pub struct Files;

impl Flash for Files {
    async fn erase(&mut self, page: u32) -> Result<(), FlashFailed> {
        Timer::after_micros(ERASE_US).await;
        operate(page, PAGE_BYTES, |length| flash::erase(page, length))
    }

    async fn write(&mut self, address: u32, words: &[u8]) -> Result<(), FlashFailed> {
        Timer::after_micros(WORD_US * words.len() as u64 / 4).await;
        operate(address, words.len() as u32, |length| {
            flash::program(address, &words[..length as usize]);
        })
    }
}

/// Does an operation on `length` bytes, and keeps its result. Where power fails, a part of it is done.
fn operate(address: u32, length: u32, act: impl FnOnce(u32)) -> Result<(), FlashFailed> {
    static DONE: AtomicU32 = AtomicU32::new(0);
    let arguments = surroundings().arguments;
    let files = [
        (Region::Calibration, arguments.calibration.as_ref()),
        (Region::Journal, arguments.journal.as_ref()),
        (Region::Binding, Some(&arguments.page)),
        (Region::Model, Some(&arguments.model)),
    ];
    let (region, path) = files
        .into_iter()
        .rfind(|(region, _)| region.address(0) <= address)
        .ok_or(FlashFailed)?;
    let is_page = matches!(region, Region::Binding | Region::Calibration);
    if is_page && surroundings().scenario.page_fails {
        return Err(FlashFailed);
    }
    let number = DONE.fetch_add(1, Ordering::Relaxed) + 1;
    let scenario = &surroundings().scenario;
    let fails = scenario.power_fails_at.get(arguments.starts) == Some(&number);
    let done = scenario.power_fails_done.get(arguments.starts);
    let done = length * done.unwrap_or(&HALF) / 100;
    act(if fails { done } else { length });
    if let Some(path) = path {
        let offset = address - region.address(0);
        keep(path, region, offset, length).map_err(|_| FlashFailed)?;
    }
    if fails {
        power::reset(ResetReason::Power);
    }
    Ok(())
}

/// Writes what a part of a region holds to its file.
fn keep(path: &Path, region: Region, offset: u32, length: u32) -> std::io::Result<()> {
    let contents = flash::contents(region);
    let mut file = File::options()
        .create(true)
        .write(true)
        .truncate(false)
        .open(path)?;
    file.seek(SeekFrom::Start(offset.into()))?;
    file.write_all(&contents[offset as usize..(offset + length) as usize])
}
