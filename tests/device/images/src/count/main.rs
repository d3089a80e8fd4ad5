//! Counts the instructions that each part of the line executes per patch.
//!
//! The argument is a file of raw samples, 8 bytes each. Prints how many patches were counted, then
//! a line for every part: name, mean and largest count over the patches.
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
    use shared::{
        kernels::Aligned,
        model_file::Model,
        units::{CHANNELS, Sample},
    };

    use crate::line;

    /// The model that the project ships, where flash has it: at a multiple of four.
    static MODEL: &Aligned<[u8]> =
        &Aligned(*include_bytes!("../../../../../models/three-class.intent"));

    fn main() {
        let path = arguments().into_iter().next().expect("a file of samples");
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
        let model = Model::parse(&MODEL.0).expect("a model");

        timer::start();
        let counts = line::count(&model, &samples);
        println!("patches {}", counts.total.count());
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
