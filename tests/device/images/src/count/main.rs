//! Counts the instructions per patch that each part of the pipeline executes.
//!
//! Arguments: a file of raw samples, 8 bytes each, and optionally a model file; without one the model that the
//! project ships. Prints the number of patches counted, the size of the encoder's state in bytes, then a line for
//! every part: name, mean and largest count over the patches.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![forbid(unsafe_code)]

#[cfg(target_os = "none")]
extern crate alloc;

#[cfg(target_os = "none")]
mod alignment;
#[cfg(target_os = "none")]
mod calibration;
#[cfg(target_os = "none")]
mod pipeline;
#[cfg(target_os = "none")]
mod spans;

#[cfg(target_os = "none")]
mod image {
    use alloc::{boxed::Box, vec::Vec};

    use device::{arguments, files, println, timer};
    use shared::calibration::Memory;
    use shared::model::Aligned;
    use shared::model::encoder::{DeviceEncoder, DeviceState, HostEncoder};
    use shared::model::file::Model;
    use shared::units::{CHANNELS, Sample};

    use crate::pipeline::{self, Apart};
    use crate::{alignment, calibration};

    /// The model that the project ships, aligned as in flash: at a multiple of four.
    static MODEL: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../../models/three-class.intent"));

    fn main() {
        let mut paths = arguments().into_iter();
        let path = paths.next().expect("a file of samples");
        let bytes = files::read(&path).expect("a readable file");
        let (samples, rest) = bytes.as_chunks::<CHANNELS>();
        assert!(
            rest.is_empty(),
            "{} bytes after the last sample",
            rest.len()
        );
        let samples: Vec<Sample> = samples
            .iter()
            .map(|sample| sample.map(|byte| byte as i8))
            .collect();
        // Memory for a file is a large allocation, aligned to eight bytes.
        let file = paths
            .next()
            .map(|path| files::read(&path).expect("a readable file"));
        let model = Model::parse(file.as_deref().unwrap_or(&MODEL.0)).expect("a model");

        timer::start();
        let mut memory = Box::new(Memory::EMPTY);
        // Wider models than a device holds are counted with the host's capacity.
        let (counts, alignment, calibration, state) = match DeviceEncoder::new(&model) {
            Ok(encoder) => (
                pipeline::count(encoder, &model, &samples),
                alignment::count(Apart(encoder), &model),
                Some(calibration::count(encoder, &model, &mut memory)),
                size_of::<DeviceState>(),
            ),
            Err(_) => {
                let encoder = HostEncoder::new(&model).expect("room for every model");
                (
                    pipeline::count(encoder, &model, &samples),
                    alignment::count(Apart(encoder), &model),
                    None,
                    size_of_val(&encoder.fresh()),
                )
            }
        };
        println!("patches {}", counts.total.count());
        println!("state {state}");
        let named = counts.named().into_iter().chain(alignment);
        let named = named.chain(calibration.into_iter().flatten());
        for (part, spans) in named {
            println!("{part} {} {}", spans.mean(), spans.largest());
        }
    }

    device::entry!(main);
}

/// Points to `cargo xtask count`: on a PC there is nothing to emulate.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the emulated core: `cargo xtask count`");
}
