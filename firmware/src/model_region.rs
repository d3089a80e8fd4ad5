//! The part of flash that holds the model file (`MODEL` in `memory.x`).
//!
//! It is flashed apart from the program, so it may be erased, or hold an old model or noise; or the program exchanges it
//! ([`installation`](crate::installation)), and power may have failed meanwhile.

use shared::calibration::{RecordError, from_record};
#[cfg(not(feature = "nrf52832"))]
use shared::calibration::{Refusal, Sums};
use shared::installation::journal::{self, Journal};
use shared::model::encoder::{DeviceEncoder, DeviceState};
use shared::model::file::{Model, ModelError};
#[cfg(not(feature = "nrf52832"))]
use shared::model::head::Head;
use shared::model::{Encode, LookBackLogits};
use shared::pipeline::{ModelInput, ModelRefused, Smoother};
use shared::stream::alignment::Alignment;
use shared::units::Patch;

use crate::flash::{self, Region};

/// Encoder for models of any dimensions that the device has room for.
pub struct BoardEncoder(DeviceEncoder<'static>);

impl BoardEncoder {
    fn new(model: &Model<'static>) -> Result<Self, ModelError> {
        DeviceEncoder::new(model).map(Self)
    }

    /// Uses the calibration that is kept; returns the alignment under which it was learnt.
    fn calibrate(&mut self, model: &Model<'_>) -> Result<Alignment, RecordError> {
        // No calibration is made on an nRF52832.
        if cfg!(feature = "nrf52832") {
            return Err(RecordError::Missing);
        }
        let head = from_record(flash::bytes(Region::Calibration), model)?;
        self.0.set_head(head);
        Ok(head.alignment)
    }
}

/// On an nRF52832 without what calibrates: it has no room for that.
impl Encode for BoardEncoder {
    type State = DeviceState;

    fn classes(&self) -> usize {
        self.0.classes()
    }

    fn fresh(&self) -> DeviceState {
        self.0.fresh()
    }

    fn reset(&self, state: &mut DeviceState) {
        state.reset();
    }

    fn step(&self, state: &mut DeviceState, patch: &Patch) -> LookBackLogits {
        self.0.step(state, patch)
    }

    #[cfg(not(feature = "nrf52832"))]
    fn hidden<'s>(&self, state: &'s DeviceState) -> &'s [f32] {
        self.0.hidden(state)
    }

    #[cfg(not(feature = "nrf52832"))]
    fn logits_by(&self, head: &Head, state: &mut DeviceState) -> LookBackLogits {
        self.0.logits_by(head, state)
    }

    #[cfg(not(feature = "nrf52832"))]
    fn solve(&self, sums: &Sums, state: &mut DeviceState, head: &mut Head) -> Result<(), Refusal> {
        self.0.solve(sums, state, head)
    }
}

pub struct Loaded {
    pub encoder: BoardEncoder,
    pub smoother: Smoother,
    pub input: ModelInput,
    pub checksum: u32,
    /// Whether the encoder has the wearer's calibration, or why not.
    pub calibration: Result<(), RecordError>,
}

/// Reads the region and hands over what is in it, which may not be used once an installation has asked for its end.
// Handed over, not returned: what is read and what takes it are large, and are not on the stack at the same time. Not
// inlined: its stack frame is released before anything else runs.
#[inline(never)]
pub fn load(take: &mut dyn FnMut(Loaded)) -> Result<(), ModelRefused> {
    let model = Model::parse(flash::bytes(Region::Model))?;
    let mut encoder = BoardEncoder::new(&model)?;
    let calibration = encoder.calibrate(&model);
    let settings = model.header.smoother.in_patches();
    take(Loaded {
        smoother: Smoother::new(settings, encoder.classes())?,
        encoder,
        input: ModelInput {
            preprocessing: model.header.preprocessing,
            template: model.header.template,
            alignment: calibration.unwrap_or_default(),
        },
        checksum: model.checksum,
        calibration: calibration.map(|_| ()),
    });
    Ok(())
}

pub fn journal() -> Option<Journal> {
    journal::read(&Region::Journal.read(0))
}
