//! Counts the instructions that each part of the line executes per patch.
//!
//! The arguments are a file of raw samples, 8 bytes each, and a model's, or none for the one that the project ships.
//! Prints how many patches were counted, the bytes of the encoder's state, then a line for every part: name, mean and
//! largest count over the patches.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![forbid(unsafe_code)]

#[cfg(target_os = "none")]
extern crate alloc;

#[cfg(target_os = "none")]
mod line;
#[cfg(target_os = "none")]
mod spans;

#[cfg(target_os = "none")]
mod image {
    use alloc::vec::Vec;

    use device::{arguments, files, println, timer};
    use shared::model::encoder::{EncoderState, usual_span};
    use shared::model::file::Model;
    use shared::model::kernels::Aligned;
    use shared::units::{CHANNELS, Sample};

    use crate::line;

    /// The model that the project ships, where flash has it: at a multiple of four.
    static MODEL: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../../models/three-class.intent"));

    /// Counts with the encoder of a shape; gives the bytes of its state too.
    macro_rules! count {
        ($model:expr, $samples:expr, $(($width:literal, $layers:literal))*) => {
            match ($model.header.dimensions.width, $model.header.dimensions.layers) {
                $(($width, $layers) => (
                    line::count::<$width, $layers, { usual_span($layers) }>($model, $samples),
                    size_of::<EncoderState<$width, $layers, { usual_span($layers) }>>(),
                ),)*
                shape => panic!("no encoder {shape:?} is compiled"),
            }
        };
    }

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
        // Read into memory it is aligned as a large allocation is: at a multiple of eight.
        let file = paths
            .next()
            .map(|path| files::read(&path).expect("a readable file"));
        let model = Model::parse(file.as_deref().unwrap_or(&MODEL.0)).expect("a model");

        timer::start();
        let (counts, state) = count!(
            &model,
            &samples,
            (48, 2)(64, 2)(96, 2)(128, 2)(48, 3)(64, 3)(96, 3)(128, 3)
        );
        println!("patches {}", counts.total.count());
        println!("state {state}");
        for (part, spans) in counts.named() {
            println!("{part} {} {}", spans.mean(), spans.largest());
        }
    }

    device::entry!(main);
}

/// On a PC there is nothing to emulate.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the emulated core: `cargo xtask count`");
}
