//! The files of a release, as they are flashed.

use std::collections::BTreeMap;
use std::env;
use std::path::PathBuf;

use anyhow::{Context as _, ensure};
use myointent::cli::replay;
use recordings::synthetic::{self, SynthOptions};
use xtask::firmware::Image;

use super::{merged, uf2};
use myointent_tests::chip::{self, Board, MODEL, Setting};

/// Bytes at consecutive addresses, taken out of a file's.
fn segments(found: BTreeMap<u32, u8>) -> Vec<(u32, Vec<u8>)> {
    let mut segments: Vec<(u32, Vec<u8>)> = Vec::new();
    for (address, byte) in found {
        match segments.last_mut() {
            Some((start, bytes)) if *start + bytes.len() as u32 == address => bytes.push(byte),
            _ => segments.push((address, vec![byte])),
        }
    }
    segments
}

#[test]
#[ignore = "tests/release names a folder"]
fn every_image_of_a_release_starts_and_labels_as_replay_does() -> anyhow::Result<()> {
    let folder = env::var_os("MYOINTENT_RELEASE").context("no MYOINTENT_RELEASE")?;
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: 12,
        ..SynthOptions::default()
    };
    let samples = synthetic::generate(&options).remove(0).samples;
    for built in Image::ALL {
        let extension = if Image::UF2.contains(&built) {
            "uf2"
        } else {
            "hex"
        };
        let file = PathBuf::from(&folder)
            .join(built.name())
            .with_extension(extension);
        let found = match extension {
            "uf2" => uf2::read(&std::fs::read(&file).with_context(|| file.display().to_string())?)?,
            _ => merged::read(&file)?,
        };
        let mut found = segments(found);
        let model = found.iter().position(|(start, _)| *start == MODEL);
        let (_, model) = found.remove(model.context("no model")?);
        // Registers for a programmer.
        found.retain(|(start, _)| *start < 0x1000_0000);
        let expected = replay::lines(&model, &samples)?;
        // Emulated functions are found by the names that the image has here; what runs is the file's.
        let mut image = chip::image(built).context("no compiler")?;
        image.segments = found;
        let setting = Setting::of(model, samples.clone());
        let mut board = Board::new(built, image, setting);
        board.wait_for("# stream over", 20_000)?;
        board.run_ms(200)?;
        let lines = board.lines().concat();
        ensure!(
            expected.contains("$LABEL") && lines.starts_with(&expected),
            "{built}:\n{lines}"
        );
        println!("{}: {} lines", file.display(), expected.lines().count());
    }
    Ok(())
}
