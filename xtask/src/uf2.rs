//! One UF2 file of program and model, to be dragged onto a boot loader's drive: `cargo xtask uf2`.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, Result, ensure};
use shared::uf2;

use crate::firmware::{self, Image};
use crate::merge::Part;
use crate::{cross_target, toolchain};

/// Options of the file.
#[derive(clap::Args)]
pub struct Arguments {
    /// Board: its image is built, and the file has its name.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(Image::UF2.map(Image::name)))]
    board: String,
    /// Model file.
    #[arg(long, default_value = "models/three-class.intent")]
    model: PathBuf,
    /// Leaves out the program.
    #[arg(long)]
    model_only: bool,
    /// File to write. By default the board's name in target/cross.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Installs a missing cross compiler or libclang, as root, with apt-get.
    #[arg(long)]
    install: bool,
    /// Refuses to change Cargo.lock.
    #[arg(long)]
    locked: bool,
}

/// Builds a board's image and writes it with a model into one file.
///
/// # Errors
/// When the image does not build, a file cannot be read or written, or the model does not fit.
pub fn run(arguments: &Arguments) -> Result<()> {
    let image = Image::UF2
        .into_iter()
        .find(|one| one.name() == arguments.board);
    let image = image.context("no board with a boot loader for UF2 files")?;
    let toolchain = toolchain::find(arguments.install)?;
    let elf = firmware::build_image(&toolchain, image, arguments.install, arguments.locked)?;
    let read = |path: &PathBuf| {
        fs::read(path).with_context(|| format!("{} cannot be read", path.display()))
    };
    let written = file(
        &read(&elf)?,
        &read(&arguments.model)?,
        !arguments.model_only,
    )?;
    let default = || cross_target().join(image.name()).with_extension("uf2");
    let out = arguments.out.clone().unwrap_or_else(default);
    fs::write(&out, written).with_context(|| format!("{} cannot be written", out.display()))?;
    println!("{}", out.display());
    Ok(())
}

/// The file of a model, and of an image's program.
///
/// # Errors
/// When the image is no ELF file, or the model does not fit into its region.
pub fn file(elf: &[u8], model: &[u8], has_program: bool) -> Result<Vec<u8>> {
    let region = Part::model(model, elf)?;
    ensure!(
        matches!(region.segments[..], [(uf2::MODEL, _)]),
        "the image expects its model elsewhere than at {:#x}",
        uf2::MODEL
    );
    let program = Part::program(elf)?;
    let program = program.segments.iter().filter(|_| has_program);
    let program = program.map(|(start, bytes)| (*start, &bytes[..]));
    let segments: Vec<_> = program.chain(uf2::model(model)).collect();
    Ok(uf2::blocks(&segments).flatten().collect())
}
