//! Executed instructions per patch on the Cortex-M4F, part by part.

use std::{
    fmt, fs, iter,
    path::{Path, PathBuf},
    process, thread,
    time::Duration,
};

use anyhow::{Context as _, Result, bail, ensure};

use crate::device::{self, Clock, Image};
use crate::qemu;
use crate::toolchain;

/// Of a whole patch, 50 ms of EMG.
pub const BUDGET: u64 = 150_000;
/// Emulating some hundred patches takes seconds.
const LIMIT: Duration = Duration::from_secs(120);
/// The line's parts, in its order, and the cycles that an instruction of each takes: estimated once, from a
/// trace of every executed block and the timing tables of the Cortex-M4 (docs/budgets.md).
const PARTS: [(&str, f64); 8] = [
    ("preprocess", 1.03),
    ("ring", 1.3),
    ("embed", 1.4),
    ("attention", 1.5),
    ("feed-forward", 1.52),
    ("head", 1.62),
    ("smoother", 1.4),
    ("rest", 1.4),
];
/// What is told besides: the line as a whole, the encoder without marks between its parts, and from scratch over a window
/// a patch's share and what is done in one piece.
const SUMS: [&str; 4] = ["total", "encoder", "rebuild", "slice"];
/// Most that a slice may keep the radio's tasks waiting.
const SLICE_MS: f64 = 10.0;
/// Change of the total for the worse that has to be explained, in percent.
const TOLERANCE: f64 = 2.0;
/// The counts of the last commit, in the form that the image prints.
const COMMITTED: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../tests/device/instructions.txt"
);

/// What to count with.
#[derive(clap::Args)]
pub struct Arguments {
    /// A recording to run over, as an npy file of bytes, shape (n, 8). Otherwise a made-up signal.
    #[arg(long, value_name = "FILE.npy")]
    recording: Option<PathBuf>,
    /// A model to run; otherwise the one that the project ships, judged by its budget.
    #[arg(long, value_name = "FILE.intent")]
    model: Option<PathBuf>,
    /// The model takes patches of 5 samples.
    #[arg(long, requires = "model")]
    patch_5: bool,
    /// Take these counts as the committed ones. Say in the commit why they are worse, if they are.
    #[arg(long, conflicts_with_all = ["recording", "model"])]
    accept: bool,
}

/// Builds, counts and prints the table beside the committed one.
///
/// # Errors
/// Also when the whole line is over its budget, or more than 2 % worse than committed.
pub fn print(arguments: &Arguments) -> Result<()> {
    let samples = match &arguments.recording {
        Some(path) => read_npy(path)?,
        None => made_up(),
    };
    let toolchain = toolchain::find(false)?;
    qemu::find()?;
    let image = if arguments.patch_5 {
        Image::CountOfFives
    } else {
        Image::Count
    };
    let image = device::build(&toolchain, image)?;
    let table = count(&image, &samples, arguments.model.as_deref())?;
    if arguments.recording.is_some() || arguments.model.is_some() {
        println!(
            "{}",
            Comparison {
                table: &table,
                committed: None
            }
        );
        return Ok(());
    }
    if arguments.accept {
        fs::write(COMMITTED, table.text())?;
    }
    let committed = fs::read_to_string(COMMITTED)
        .with_context(|| format!("{COMMITTED}: none; `cargo xtask count --accept` writes it"))?;
    let committed = Table::parse(&committed)?;
    println!(
        "{}",
        Comparison {
            table: &table,
            committed: Some(&committed)
        }
    );
    let [now, before] =
        [&table, &committed].map(|table| table.part("total").map_or(0, |total| total.mean));
    let worse = change(now, before);
    ensure!(
        worse <= TOLERANCE,
        "{worse:.1} % worse than {COMMITTED}: mend it, or run `cargo xtask count --accept` and say why in the commit"
    );
    ensure!(
        now <= BUDGET,
        "{now} instructions, over the budget of {BUDGET}"
    );
    let slice = table.slice_ms();
    ensure!(
        slice <= SLICE_MS,
        "a slice from scratch takes about {slice:.1} ms, over the {SLICE_MS} ms that the radio may wait"
    );
    Ok(())
}

/// Percent by which a count is worse than another.
fn change(now: u64, before: u64) -> f64 {
    (now as f64 / before.max(1) as f64 - 1.0) * 100.0
}

/// Instructions of a part, per patch.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// Mean over the patches.
    pub mean: u64,
    /// Largest of the patches.
    pub largest: u64,
}

/// The instruction count of a run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Table {
    /// Patches counted.
    pub patches: u64,
    /// Bytes of the encoder's state.
    pub state: u64,
    parts: Vec<Part>,
}

impl Table {
    /// A part, or one of the sums.
    pub fn part(&self, name: &str) -> Option<&Part> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// From what the image printed.
    pub fn parse(output: &str) -> Result<Self> {
        let mut lines = output.lines();
        let mut number = |name: &str| -> Result<u64> {
            let number = lines.next().and_then(|line| line.strip_prefix(name));
            Ok(number
                .with_context(|| format!("no {name}in: {output}"))?
                .parse()?)
        };
        let (patches, state) = (number("patches ")?, number("state ")?);
        let part = |line: &str| {
            let [name, mean, largest] = line.split(' ').collect::<Vec<_>>()[..] else {
                bail!("no part: {line}");
            };
            Ok(Part {
                name: name.into(),
                mean: mean.parse()?,
                largest: largest.parse()?,
            })
        };
        let table = Self {
            patches,
            state,
            parts: lines.map(part).collect::<Result<_>>()?,
        };
        for name in PARTS.map(|(name, _)| name).iter().chain(&SUMS) {
            ensure!(table.part(name).is_some(), "no part {name} in: {output}");
        }
        Ok(table)
    }

    /// As the image prints it.
    fn text(&self) -> String {
        let part = |part: &Part| format!("{} {} {}\n", part.name, part.mean, part.largest);
        let parts: String = self.parts.iter().map(part).collect();
        format!("patches {}\nstate {}\n{parts}", self.patches, self.state)
    }

    /// What a slice takes at 64 MHz, estimated as the parts that take most are.
    fn slice_ms(&self) -> f64 {
        self.part("slice")
            .map_or(0.0, |slice| slice.largest as f64 * 1.52 / 64e3)
    }

    /// Cycles of a part's mean; of the total, of all parts.
    fn cycles(&self, name: &str) -> f64 {
        let of = |(name, ratio): &(&str, f64)| {
            self.part(name).map_or(0.0, |part| part.mean as f64 * ratio)
        };
        PARTS
            .iter()
            .filter(|part| name == "total" || part.0 == name)
            .map(of)
            .sum()
    }
}

/// A table beside the committed one.
struct Comparison<'a> {
    table: &'a Table,
    committed: Option<&'a Table>,
}

impl fmt::Display for Comparison<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { table, committed } = self;
        writeln!(f, "instructions per patch, {} patches", table.patches)?;
        writeln!(
            f,
            "{:<14}{:>9}{:>9}{:>11}{:>9}{:>14}",
            "part", "mean", "largest", "committed", "change", "cycles, est."
        )?;
        for name in PARTS.map(|(name, _)| name).into_iter().chain(["total"]) {
            let Some(part) = table.part(name) else {
                continue;
            };
            write!(f, "{name:<14}{:>9}{:>9}", part.mean, part.largest)?;
            match committed.and_then(|committed| committed.part(name)) {
                Some(before) => {
                    let change = change(part.mean, before.mean);
                    write!(f, "{:>11}{change:>+7.1} %", before.mean)?;
                }
                None => write!(f, "{:>20}", "")?,
            }
            writeln!(f, "{:>14.0}", table.cycles(name))?;
        }
        if let Some(encoder) = table.part("encoder") {
            let mean = encoder.mean;
            writeln!(f, "embed to head without marks between them: {mean}")?;
        }
        if let [Some(rebuild), Some(slice)] = ["rebuild", "slice"].map(|name| table.part(name)) {
            writeln!(
                f,
                "from scratch: {} a patch, {} or about {:.1} ms in one piece",
                rebuild.mean,
                slice.largest,
                table.slice_ms(),
            )?;
        }
        writeln!(f, "state of the encoder: {} bytes", table.state)?;
        let total = table.part("total").map_or(0, |total| total.mean);
        let verdict = if total > BUDGET { "over" } else { "within" };
        let share = 100.0 * total as f64 / BUDGET as f64;
        let milliseconds = table.cycles("total") / 64e3;
        write!(
            f,
            "budget {BUDGET}: {verdict}, {share:.1} % of it; about {milliseconds:.1} ms at 64 MHz"
        )
    }
}

/// Runs the image over samples of 8 bytes each, with a model's file or the shipped one.
pub fn count(image: &Path, samples: &[u8], model: Option<&Path>) -> Result<Table> {
    // One file per process and thread: tests count side by side.
    let name = format!("samples-{}-{:?}", process::id(), thread::current().id());
    let file = image.with_file_name(name);
    fs::write(&file, samples).with_context(|| format!("{} cannot be written", file.display()))?;
    let files: Vec<&Path> = iter::once(file.as_path()).chain(model).collect();
    let outcome = device::run(image, &files, Clock::Instructions, LIMIT);
    fs::remove_file(&file)?;
    let outcome = outcome?;
    ensure!(outcome.success, "the image failed: {}", outcome.output);
    Table::parse(&outcome.output)
}

/// 20 s of noise, by turns weak as at rest and strong as in a fist, 2 s each.
pub fn made_up() -> Vec<u8> {
    const SAMPLES: u64 = 4000;
    let mut state = 1_u64;
    let mut byte = |amplitude: u64| {
        // Knuth's linear congruential generator; its high bits are the random ones.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % (2 * amplitude + 1)).wrapping_sub(amplitude) as u8
    };
    let sample = |index: u64| {
        if (index / 400).is_multiple_of(2) {
            3
        } else {
            80
        }
    };
    (0..SAMPLES)
        .flat_map(|index| [sample(index); 8])
        .map(&mut byte)
        .collect()
}

fn read_npy(path: &Path) -> Result<Vec<u8>> {
    let bytes = fs::read(path).with_context(|| format!("{} cannot be read", path.display()))?;
    npy_body(&bytes)
        .with_context(|| format!("{} is no npy file of bytes in rows of 8", path.display()))
}

/// The values of an npy file of version 1: magic, version, length of the header, header, values.
fn npy_body(bytes: &[u8]) -> Option<Vec<u8>> {
    let rest = bytes.strip_prefix(b"\x93NUMPY\x01\x00")?;
    let (length, rest) = rest.split_first_chunk()?;
    let (header, values) = rest.split_at_checked(u16::from_le_bytes(*length).into())?;
    let header = std::str::from_utf8(header).ok()?;
    let fits = header.contains("'|i1'") && header.contains("'fortran_order': False");
    (fits && values.len().is_multiple_of(8)).then(|| values.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn output(without: &str, mean: u64) -> String {
        let names = PARTS.map(|(name, _)| name);
        let names = names.iter().chain(&SUMS);
        let parts = names.filter(|name| **name != without);
        let lines: Vec<_> = parts
            .map(|name| format!("{name} {mean} 160000\n"))
            .collect();
        format!("patches 5\nstate 7\n{}", lines.concat())
    }

    #[test]
    fn every_part_is_read_and_a_missing_one_missed() {
        let table = Table::parse(&output("", 10)).unwrap();
        let total = table.part("total").unwrap();
        assert_eq!((table.patches, total.mean, total.largest), (5, 10, 160_000));
        assert_eq!(table.text(), output("", 10));
        for (name, _) in PARTS {
            assert!(Table::parse(&output(name, 10)).is_err(), "{name}");
        }
        assert!(Table::parse("hard fault at 0x0").is_err());
    }

    #[test]
    fn the_table_tells_changes_cycles_and_the_budget() {
        let [table, committed] =
            [10_200, 10_000].map(|mean| Table::parse(&output("", mean)).unwrap());
        let committed = Some(&committed);
        let table = &table;
        let text = Comparison { table, committed }.to_string();
        let line = text
            .lines()
            .find(|line| line.starts_with("embed "))
            .unwrap();
        let words: Vec<_> = line.split_whitespace().collect();
        assert_eq!(
            words,
            ["embed", "10200", "160000", "10000", "+2.0", "%", "14280"]
        );
        assert!(
            text.contains("budget 150000: within, 6.8 % of it"),
            "{text}"
        );
    }

    #[test]
    fn the_committed_counts_are_read() {
        let committed = Table::parse(&fs::read_to_string(COMMITTED).unwrap()).unwrap();
        assert!(committed.part("total").unwrap().mean <= BUDGET);
    }

    #[test]
    fn only_bytes_in_rows_of_8_are_a_recording() {
        let file = |kind: &str, values: &[u8]| {
            let header =
                format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (1, 8), }}");
            let length = (header.len() as u16).to_le_bytes();
            [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), values].concat()
        };
        assert_eq!(npy_body(&file("|i1", &[7; 8])), Some(vec![7; 8]));
        assert_eq!(npy_body(&file("|i1", &[7; 9])), None);
        assert_eq!(npy_body(&file("<i8", &[7; 8])), None);
        assert_eq!(npy_body(b"no npy"), None);
    }

    #[test]
    fn the_made_up_signal_has_rests_and_fists() {
        let values: Vec<i8> = made_up().into_iter().map(|byte| byte as i8).collect();
        let loudest = |range: std::ops::Range<usize>| {
            values[range].iter().map(|value| value.unsigned_abs()).max()
        };
        assert_eq!(values.len(), 4000 * 8);
        assert_eq!(loudest(0..400 * 8), Some(3));
        assert_eq!(loudest(400 * 8..800 * 8), Some(80));
    }
}
