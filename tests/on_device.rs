//! The tests of `shared` on the emulated Cortex-M4F, each as a test of its own.
//!
//! Unit tests and golden checks are compiled from the same sources as on the host. Each test runs in
//! an emulator of its own, so that a panic or an endless loop ends no other test. Without a cross
//! compiler or an emulator there are no tests, and one line says so.

#[path = "golden/cases.rs"]
mod cases;
#[path = "golden/files.rs"]
mod files;
#[path = "golden/smoother.rs"]
mod smoother;

use std::{fs, path::Path, process::ExitCode, sync::Arc, time::Duration};

use anyhow::{Context as _, Result, ensure};
use libtest_mimic::{Arguments, Failed, Trial};
use myointent_tests::{golden, skip};
use xtask::{
    count::{self, CountTable},
    device::{self, Clock, Image},
    emulator,
    toolchain::{self, Toolchain},
};

/// Longest run of a test, of which the slowest takes 8 s on an idle core.
const TIMEOUT: Duration = Duration::from_secs(300);

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let found =
        toolchain::find(toolchain::TARGET, false).and_then(|found| emulator::qemu().map(|_| found));
    let trials = match found {
        Ok(toolchain) => trials(&toolchain).unwrap_or_else(|error| {
            let message = format!("{error:#}");
            vec![trial("images_build_and_list_their_tests", || {
                anyhow::bail!(message)
            })]
        }),
        Err(missing) => {
            skip(&format!("{missing:#}"));
            Vec::new()
        }
    };
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trials(toolchain: &Toolchain) -> Result<Vec<Trial>> {
    let mut trials = Vec::new();
    let unit_tests: Arc<Path> = device::build(toolchain, Image::UnitTests)?.into();
    for name in names(&unit_tests)? {
        let image = unit_tests.clone();
        trials.push(trial(&name.clone(), move || pass(&image, &name)));
    }
    let image: Arc<Path> = device::build(toolchain, Image::Golden)?.into();
    for &(name, read) in cases::ON_BOTH {
        let image = image.clone();
        trials.push(trial(&format!("golden::{name}"), move || {
            golden_check(&image, name, read)
        }));
    }
    let image: Arc<Path> = device::build(toolchain, Image::Count)?.into();
    trials.push(trial(
        "count::instructions_add_up_and_do_not_vary",
        move || counts_add_up(&image),
    ));
    Ok(trials)
}

fn trial(name: &str, run: impl FnOnce() -> Result<()> + Send + 'static) -> Trial {
    let run = || run().map_err(|error| Failed::from(format!("{error:#}")));
    Trial::test(format!("device::{name}"), run)
}

fn names(unit_tests: &Path) -> Result<Vec<String>> {
    let listed = device::run(unit_tests, &[""; 0], Clock::Free, TIMEOUT)?;
    ensure!(listed.success, "no list of tests: {}", listed.output);
    let names: Vec<_> = listed.output.lines().map(String::from).collect();
    ensure!(!names.is_empty(), "the list of tests is empty");
    Ok(names)
}

/// Runs an image with one argument; expects exit code 0.
fn pass(image: &Path, argument: &str) -> Result<()> {
    let outcome = device::run(image, &[argument], Clock::Free, TIMEOUT)?;
    ensure!(outcome.success, "{}", outcome.output);
    Ok(())
}

fn golden_check(image: &Path, name: &str, read: cases::Read) -> Result<()> {
    let folder = golden();
    let check = postcard::to_allocvec(&read(&folder))?;
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&file, check)?;
    pass(image, file.to_str().context("a path of UTF-8")?)
}

fn counts_add_up(image: &Path) -> Result<()> {
    let samples = count::synthetic();
    let table = count::count(image, &samples, None)?;
    ensure!(
        table == count::count(image, &samples, None)?,
        "two runs differ"
    );
    ensure!(table.patches == 340, "{} patches", table.patches);

    let mean = |table: &CountTable, name: &str| -> Result<u64> {
        Ok(table.part(name).context("a part")?.mean)
    };
    let sum = |names: &[&str]| -> Result<u64> { names.iter().map(|name| mean(&table, name)).sum() };
    // Each mean is rounded to the nearest.
    let whole = sum(&["preprocess", "ring", "encoder", "smoother", "rest"])?;
    let total = sum(&["total"])?;
    ensure!(whole.abs_diff(total) <= 3, "{whole} of {total}");
    // The rest is small: the parts cost alone what they cost in the pipeline.
    let rest = sum(&["rest"])?;
    ensure!(rest > 0 && rest < total / 20, "rest {rest} of {total}");
    // With a probe between the encoder's parts the compiler arranges them differently: by 1 % at most so far.
    let parts = sum(&["embed", "attention", "feed-forward", "head"])?;
    let encoder = sum(&["encoder"])?;
    ensure!(
        parts.abs_diff(encoder) <= encoder / 50,
        "{parts} of {encoder}"
    );
    // Waiting for gestures is little beside a patch; the encoder never takes more than one patch with a sample.
    let waiting = mean(&table, "align-patch")?;
    ensure!(
        waiting > 0 && waiting < total + total / 20,
        "a patch while waiting {waiting}, else {total}"
    );
    for name in ["align-end", "align-again", "align-arm"] {
        let largest = table.part(name).context("a part")?.largest;
        ensure!(
            largest > encoder / 2 && largest < total + total / 4,
            "{name} {largest}, a patch {total}"
        );
    }
    Ok(())
}
