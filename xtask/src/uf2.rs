//! One UF2 file of program and model, to be dragged onto a boot loader's drive: `cargo xtask uf2`.

use anyhow::{Context as _, Result};
use shared::uf2::Uf2;

use crate::firmware::Image;
use crate::merge::{Files, FlashPart};

/// Options of the file.
#[derive(clap::Args)]
pub struct Arguments {
    /// Board: its image is built, and the file has its name.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(Image::UF2.map(Image::name)))]
    pub board: String,
    #[command(flatten)]
    pub(crate) files: Files,
}

/// Builds a board's image and writes it with a model into one file.
pub fn run(arguments: &Arguments) -> Result<()> {
    let image = Image::from_name(&arguments.board).context("no board of this name")?;
    let (elf, model) = arguments.files.read(image)?;
    let written = file(&elf, &model)?;
    let out = arguments.files.write(image, "uf2", written)?;
    println!("{}", out.display());
    Ok(())
}

/// The file of an image's program and a model.
pub fn file(elf: &[u8], model: &[u8]) -> Result<Vec<u8>> {
    let mut file = Uf2::default();
    let parts = [
        FlashPart::program(elf)?,
        FlashPart::erased_journal(elf)?,
        FlashPart::model(model, elf)?,
    ];
    for (start, bytes) in parts.iter().flat_map(|part| &part.segments) {
        file.put(*start, bytes);
    }
    Ok(file.file())
}
