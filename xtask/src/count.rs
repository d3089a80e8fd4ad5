//! Executed instructions per patch on the Cortex-M4F, part by part.

use std::{
    fmt, fs,
    path::{Path, PathBuf},
    process, thread,
    time::Duration,
};

use anyhow::{Context as _, Result, bail, ensure};

use crate::{
    device::{self, Clock, Image},
    qemu, toolchain,
};

/// Of a whole patch, 50 ms of EMG.
pub const BUDGET: u64 = 150_000;
/// Emulating some hundred patches takes seconds.
const LIMIT: Duration = Duration::from_secs(120);
/// The line's parts, in its order.
const PARTS: [&str; 8] = [
    "preprocess",
    "ring",
    "embed",
    "attention",
    "feed-forward",
    "head",
    "smoother",
    "rest",
];

/// What to count with.
#[derive(clap::Args)]
pub struct Arguments {
    /// A recording to run over, as an npy file of bytes, shape (n, 8). Otherwise a made-up signal.
    #[arg(long, value_name = "FILE.npy")]
    recording: Option<PathBuf>,
}

/// Builds, counts and prints the table. Over the budget is no failure: the table says so.
pub fn print(arguments: &Arguments) -> Result<()> {
    let samples = match &arguments.recording {
        Some(path) => read_npy(path)?,
        None => made_up(),
    };
    let toolchain = toolchain::find(false)?;
    qemu::find()?;
    let image = device::build(&toolchain, Image::Count)?;
    println!("{}", count(&image, &samples)?);
    Ok(())
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
    parts: Vec<Part>,
}

impl Table {
    /// A part, or one of the two sums: `total`, and `encoder`, its four parts without marks between.
    pub fn part(&self, name: &str) -> Option<&Part> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// From what the image printed.
    pub fn parse(output: &str) -> Result<Self> {
        let mut lines = output.lines();
        let first = lines.next().and_then(|line| line.strip_prefix("patches "));
        let patches = first
            .with_context(|| format!("no count in: {output}"))?
            .parse()?;
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
            parts: lines.map(part).collect::<Result<_>>()?,
        };
        for name in PARTS.iter().chain(&["total", "encoder"]) {
            ensure!(table.part(name).is_some(), "no part {name} in: {output}");
        }
        Ok(table)
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "instructions per patch, {} patches", self.patches)?;
        writeln!(f, "{:<14}{:>9}{:>9}", "part", "mean", "largest")?;
        for Part {
            name,
            mean,
            largest,
        } in &self.parts
        {
            if name == "total" || PARTS.contains(&name.as_str()) {
                writeln!(f, "{name:<14}{mean:>9}{largest:>9}")?;
            }
        }
        if let Some(encoder) = self.part("encoder") {
            let mean = encoder.mean;
            writeln!(f, "embed to head without marks between them: {mean}")?;
        }
        let largest = self.part("total").map_or(0, |total| total.largest);
        let verdict = if largest > BUDGET { "over" } else { "within" };
        let times = largest as f64 / BUDGET as f64;
        write!(f, "budget {BUDGET}: {verdict}, {times:.2} times as many")
    }
}

/// Runs the image over samples of 8 bytes each.
pub fn count(image: &Path, samples: &[u8]) -> Result<Table> {
    // One file per process and thread: tests count side by side.
    let name = format!("samples-{}-{:?}", process::id(), thread::current().id());
    let file = image.with_file_name(name);
    fs::write(&file, samples).with_context(|| format!("{} cannot be written", file.display()))?;
    let outcome = device::run(image, &[&file], Clock::Instructions, LIMIT);
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

    fn output(without: &str) -> String {
        let names = PARTS.iter().chain(&["total", "encoder"]);
        let parts = names.filter(|name| **name != without);
        let lines: Vec<_> = parts.map(|name| format!("{name} 10 160000\n")).collect();
        format!("patches 5\n{}", lines.concat())
    }

    #[test]
    fn every_part_is_read_and_a_missing_one_missed() {
        let table = Table::parse(&output("")).unwrap();
        let total = table.part("total").unwrap();
        assert_eq!((table.patches, total.mean, total.largest), (5, 10, 160_000));
        assert!(
            table
                .to_string()
                .ends_with("budget 150000: over, 1.07 times as many")
        );
        for name in PARTS {
            assert!(Table::parse(&output(name)).is_err(), "{name}");
        }
        assert!(Table::parse("hard fault at 0x0").is_err());
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
