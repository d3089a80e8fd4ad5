//! Executed instructions per patch on the Cortex-M4F, part by part.

mod comparison;
mod signal;
mod table;

use std::{
    fs, iter,
    path::{Path, PathBuf},
    process, thread,
    time::Duration,
};

use anyhow::{Context as _, Result, ensure};

pub use signal::synthetic;
pub use table::CountTable;

use crate::device::{self, Clock, Image};
use crate::toolchain::TARGET;
use crate::{emulator, toolchain, write};
use comparison::{BUDGET, Comparison, change};
use table::milliseconds;

/// Emulating some hundred patches takes seconds.
const TIMEOUT: Duration = Duration::from_secs(120);
/// Computations that keep the radio's tasks waiting: description, name of the count, and most milliseconds. While the
/// encoder takes the window again for an alignment or after one, a sample must be done before the next one comes.
const WAITS: [(&str, &str, f64); 3] = [
    ("the end of an alignment", "align-end", 10.0),
    ("a sample after an alignment", "align-again", 5.0),
    (
        "a sample while the model decides on the arm",
        "align-arm",
        5.0,
    ),
];
/// Percent by which the total may rise without `--accept`.
const TOLERANCE: f64 = 2.0;
/// The counts of the last commit, in the form that the image prints.
const COMMITTED: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../tests/device/instructions.txt"
);

/// Options of the count.
#[derive(clap::Args)]
pub struct Arguments {
    /// A recording to run over, as an npy file of bytes, shape (n, 8). Otherwise a synthetic signal.
    #[arg(long, value_name = "FILE.npy")]
    recording: Option<PathBuf>,
    /// A model to run. Otherwise the one in models/, which is compared with its budget.
    #[arg(long, value_name = "FILE.intent")]
    model: Option<PathBuf>,
    /// Take these counts as the committed ones. Say in the commit why they are worse, if they are.
    #[arg(long, conflicts_with_all = ["recording", "model"])]
    accept: bool,
}

/// Builds, counts and prints the table beside the committed one.
pub fn print(arguments: &Arguments) -> Result<()> {
    let samples = match &arguments.recording {
        Some(path) => signal::read_npy(path)?,
        None => synthetic(),
    };
    let toolchain = toolchain::find(TARGET, false)?;
    emulator::qemu()?;
    let image = device::build(&toolchain, Image::Count)?;
    let table = count(&image, &samples, arguments.model.as_deref())?;
    if arguments.recording.is_some() || arguments.model.is_some() {
        let committed = None;
        let table = &table;
        println!("{}", Comparison { table, committed });
        return Ok(());
    }
    if arguments.accept {
        fs::write(COMMITTED, table.text())?;
    }
    compare(&table, &committed()?)
}

/// The counts of the last commit.
pub fn committed() -> Result<CountTable> {
    let committed = fs::read_to_string(COMMITTED)
        .with_context(|| format!("{COMMITTED}: none; `cargo xtask count --accept` writes it"))?;
    CountTable::parse(&committed)
}

fn compare(table: &CountTable, committed: &CountTable) -> Result<()> {
    let comparison = Comparison {
        table,
        committed: Some(committed),
    };
    println!("{comparison}");
    let [now, before] = [table, committed].map(|table| table.mean("total"));
    let worse = change(now, before);
    ensure!(
        worse <= TOLERANCE,
        "{worse:.1} % worse than {COMMITTED}: fix it, or run `cargo xtask count --accept` and say why in the commit"
    );
    ensure!(
        now <= BUDGET,
        "{now} instructions, over the budget of {BUDGET}"
    );
    for (what, name, most) in WAITS {
        let ms = milliseconds(table.largest(name));
        ensure!(ms <= most, "{what} takes about {ms:.1} ms, over {most} ms");
    }
    Ok(())
}

/// Runs the image over samples of 8 bytes each, with a model's file or the one in models/.
pub fn count(image: &Path, samples: &[u8], model: Option<&Path>) -> Result<CountTable> {
    // One file per process and thread: tests count side by side.
    let name = format!("samples-{}-{:?}", process::id(), thread::current().id());
    let file = image.with_file_name(name);
    write(&file, samples)?;
    let files: Vec<&Path> = iter::once(file.as_path()).chain(model).collect();
    let outcome = device::run(image, &files, Clock::Instructions, TIMEOUT);
    fs::remove_file(&file)?;
    let outcome = outcome?;
    ensure!(outcome.success, "the image failed: {}", outcome.output);
    CountTable::parse(&outcome.output)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_counts_are_within_the_budget() {
        let committed = CountTable::parse(&fs::read_to_string(COMMITTED).unwrap()).unwrap();
        assert!((1..=BUDGET).contains(&committed.mean("total")));
    }
}
