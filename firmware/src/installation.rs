//! Exchanges the model in flash, or its calibration: carries out what [`Installation`] asks for, beside the radio.

use embassy_futures::{
    select::{Either, select},
    yield_now,
};
use embassy_time::Timer;
use shared::installation::{
    BLOCK_BYTES, Block, Installation, InstallationProgress, InstallationStep, Refused, journal,
};
use shared::model::Aligned;
use shared::model::file::{Model, ModelError};
use shared::uart_line::answer::Refusal;
use shared::uart_line::calibration::{CalibrationReport, CalibrationState};

use crate::flash::{Flash, FlashFailed, PAGE_BYTES, Region, SharedFlash};
use crate::messages::{
    calibration::{self, Keep},
    heartbeat, model, pin_state,
    requests::{INSTALLATION, InstallationRequest, MODEL, ModelRequest},
    uart::{self, UartMessage},
};
use crate::model_region;

/// Runs the radio once there is a model, and exchanges the model when that is asked for.
pub async fn beside<F: Flash>(flash: F, radio: impl AsyncFnOnce(&SharedFlash<F>)) {
    let flash = SharedFlash::new(flash);
    // Neither returns, unless the Bluetooth stack stops: the board restarts then, and goes on by the journal.
    #[cfg(not(feature = "uf2"))]
    let served = serve(&flash);
    #[cfg(feature = "uf2")]
    let served = select(serve(&flash), crate::hid_region::serve(&flash));
    select(served, async {
        while model::current().is_none() {
            // No radio runs without a model.
            heartbeat::RADIO.beat();
            Timer::after(heartbeat::PERIOD).await;
        }
        radio(&flash).await;
    })
    .await;
}

async fn serve(flash: &SharedFlash<impl Flash>) -> ! {
    let mut installation = Installation::new(Region::Model.length());
    loop {
        // The dropped future loses nothing. A record first: its model is given up already.
        let next = select(calibration::KEEP.wait(), INSTALLATION.receive()).await;
        let (ticket, request) = match next {
            Either::First(wanted) => {
                keep(flash, wanted).await;
                continue;
            }
            Either::Second(asked) => asked,
        };
        let answer = match request {
            InstallationRequest::Begin(transfer) if model::current() == Some(transfer.checksum) => {
                Ok(InstallationProgress::Installed)
            }
            InstallationRequest::Begin(transfer) => {
                let is_in_use = model::current().is_some();
                let journal = (!is_in_use).then(model_region::journal).flatten();
                installation.begin(transfer, journal)
            }
            InstallationRequest::Block(number, block) => {
                take(&mut installation, flash, number, &block).await
            }
        };
        INSTALLATION.answer(ticket, answer.map_err(Refusal::from));
    }
}

/// Keeps a record in the calibration's page, or none, and puts the model in use again, with it. A loss of power leaves the
/// page as it was, as it is to be, or not whole: then the model's own head is used.
async fn keep(flash: &SharedFlash<impl Flash>, Keep { learnt, model }: Keep) {
    shown().await;
    let wanted = learnt.is_some();
    let mut learnt = learnt;
    {
        let _radio_turn = flash.radio_turn().await;
        let record = learnt.as_deref_mut().map(|memory| memory.record(model));
        // What came of it is read.
        let _ = write_page(&mut *flash.lock().await, record.unwrap_or_default()).await;
    }
    if let Some(memory) = learnt {
        calibration::RETURNED.signal(memory);
    }
    // Nobody asks again.
    while MODEL.ask(ModelRequest::Resume).await == Err(Refusal::Busy) {}
    let state = match (wanted, calibration::is_in_use()) {
        (true, true) => CalibrationState::Done,
        (false, false) => CalibrationState::Idle,
        _ => CalibrationState::NotKept,
    };
    calibration::report(CalibrationReport {
        state,
        ..calibration::current()
    });
}

async fn write_page(flash: &mut impl Flash, record: &[u8]) -> Result<(), FlashFailed> {
    let region = Region::Calibration;
    flash.erase(region.address(0)).await?;
    for (block, words) in (0..).zip(record.chunks(BLOCK_BYTES)) {
        put(flash, region, block * BLOCK_BYTES as u32, words).await?;
    }
    Ok(())
}

async fn take(
    installation: &mut Installation,
    flash: &SharedFlash<impl Flash>,
    number: u32,
    block: &Block,
) -> Result<InstallationProgress, Refused> {
    installation.take(number, block, is_ours)?;
    while let Some(step) = installation.step() {
        let outcome = match request(step) {
            Some(request) => inference(request).await,
            None => {
                // The first step suspends the model; without one the radio is idle.
                let _radio_turn = flash.radio_turn().await;
                let mut flash = flash.lock().await;
                let written = write(installation, &mut *flash, step).await;
                written.map_err(|FlashFailed| Refused::Flash)
            }
        };
        installation.done(outcome)?;
    }
    Ok(installation.progress())
}

/// Whether the file that begins with this block may be a model for this program. Says so if not.
fn is_ours(first: &Block) -> bool {
    match Model::parse(&first.0) {
        // All that a block can say: magic and format are those of this program, and the file is longer.
        Err(ModelError::Length { .. }) => true,
        Ok(_) => false,
        Err(error) => {
            uart::enqueue(UartMessage::ModelRefused(error.into()));
            false
        }
    }
}

/// Request to the inference in a step; none where it has nothing to do.
const fn request(step: InstallationStep) -> Option<ModelRequest> {
    match step {
        InstallationStep::Suspend => Some(ModelRequest::Suspend),
        InstallationStep::Verify => Some(ModelRequest::Verify),
        InstallationStep::Resume => Some(ModelRequest::Resume),
        _ => None,
    }
}

/// Requests the inference's part. The pins show it then: they are safe, and nothing reads the region, once it is suspended.
async fn inference(request: ModelRequest) -> Result<(), Refused> {
    let done = MODEL.ask(request).await;
    shown().await;
    done.map_err(|refusal| match refusal {
        Refusal::Model => Refused::Model,
        _ => Refused::Busy,
    })
}

/// Waits until the pins show the newest state.
async fn shown() {
    while !pin_state::is_shown() {
        yield_now().await;
    }
}

async fn write(
    installation: &Installation,
    flash: &mut impl Flash,
    step: InstallationStep,
) -> Result<(), FlashFailed> {
    let log = Region::Journal;
    match step {
        InstallationStep::EraseJournal | InstallationStep::EndJournal => {
            flash.erase(log.address(0)).await
        }
        InstallationStep::WriteJournal => {
            let record = Aligned(installation.record());
            put(flash, log, 0, &record.0).await
        }
        InstallationStep::MarkPage(page) => {
            let mark = Aligned([0; 4]);
            put(flash, log, journal::mark(page), &mark.0).await
        }
        InstallationStep::ErasePage(page) => {
            flash.erase(Region::Model.address(page * PAGE_BYTES)).await
        }
        InstallationStep::WriteBlock(number) => {
            let offset = number * BLOCK_BYTES as u32;
            put(flash, Region::Model, offset, &installation.content().0).await
        }
        InstallationStep::Suspend | InstallationStep::Verify | InstallationStep::Resume => Ok(()),
    }
}

/// Writes words, a block at most, and reads them back.
async fn put(
    flash: &mut impl Flash,
    region: Region,
    offset: u32,
    words: &[u8],
) -> Result<(), FlashFailed> {
    flash.write(region.address(offset), words).await?;
    let found: [u8; BLOCK_BYTES] = region.read(offset);
    found.starts_with(words).then_some(()).ok_or(FlashFailed)
}
