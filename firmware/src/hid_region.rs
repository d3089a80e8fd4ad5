//! The part of flash that holds the outputs to a computer (`HID` in `memory.x`): a page of its own, which neither a new program
//! nor a new model touches.

use shared::hid::Settings;
use shared::hid::record::{from_record, to_record};
use shared::model::Aligned;
use shared::uart_line::answer::Refusal;

use crate::flash::{Flash, FlashFailed, Region, SharedFlash};
use crate::messages::{hid, requests::HID};

/// The settings that are kept. Without a whole record, as after a loss of power while it was written, they are off.
pub fn load() -> Settings {
    from_record(&Region::Hid.read(0)).unwrap_or(Settings::OFF)
}

/// Carries out the commands about the outputs: what the page holds then is in force.
pub async fn serve(flash: &SharedFlash<impl Flash>) -> ! {
    loop {
        let (ticket, command) = HID.receive().await;
        let wanted = hid::settings().after(command);
        if wanted != load() {
            // What came of it is read.
            let _ = write(&mut *flash.lock().await, wanted).await;
            hid::set(load());
        }
        let is_kept = load() == wanted;
        HID.answer(ticket, is_kept.then_some(wanted).ok_or(Refusal::Flash));
    }
}

async fn write(flash: &mut impl Flash, settings: Settings) -> Result<(), FlashFailed> {
    let page = Region::Hid.address(0);
    flash.erase(page).await?;
    flash.write(page, &Aligned(to_record(&settings)).0).await
}
