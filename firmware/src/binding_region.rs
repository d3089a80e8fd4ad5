//! The part of flash that holds the bound armband (`BINDING` in `memory.x`): a page of its own, which neither a new program
//! nor a new model touches.

use shared::model::Aligned;
use shared::myo::Address;
use shared::myo::binding::{from_record, to_record};

use crate::flash::{Flash, Region};

/// The armband that is kept; none if the page holds no whole record.
pub fn load() -> Option<Address> {
    from_record(&Region::Binding.read(0))
}

/// Keeps an armband, or removes it; returns whether the page then agrees. Does nothing if the page agrees already.
///
/// A loss of power in between leaves no whole record: then no armband is bound.
pub async fn keep(flash: &mut impl Flash, armband: Option<Address>) -> bool {
    if load() != armband {
        let page = Region::Binding.address(0);
        let erased = flash.erase(page).await;
        if let (Ok(()), Some(armband)) = (erased, armband) {
            // What came of it is read.
            let _ = flash.write(page, &Aligned(to_record(armband)).0).await;
        }
    }
    load() == armband
}
