//! The counts of one run, as the image prints them.

use anyhow::{Context as _, Result, bail, ensure};

/// The parts of the pipeline, in its order, and the cycles that an instruction of each takes: estimated
/// once, from a trace of every executed block and the timing tables of the Cortex-M4 (docs/budgets.md).
pub const PARTS: [(&str, f64); 8] = [
    ("preprocess", 1.03),
    ("ring", 1.3),
    ("embed", 1.5),
    ("attention", 1.56),
    ("feed-forward", 1.51),
    ("head", 1.55),
    ("smoother", 1.4),
    ("rest", 1.4),
];
/// Names of further counts: the whole pipeline, and the encoder without a probe between its parts.
pub const MORE: [&str; 2] = ["total", "encoder"];

/// Names of an alignment's counts: a patch while gestures are waited for; the sample that ends it; each sample with
/// which the encoder takes the window again; the fit alone; the change of the window alone; each sample while the model
/// decides on the arm. Older counts lack them.
pub const ALIGNMENT: [&str; 6] = [
    "align-patch",
    "align-end",
    "align-again",
    "align-fit",
    "align-turn",
    "align-arm",
];

/// Names of a calibration's counts: a patch of each round, and the sample with which the last layer is solved.
pub const CALIBRATION: [&str; 3] = ["calibrate-teach", "calibrate-judge", "calibrate-solve"];

/// Milliseconds of `instructions` at 64 MHz, by the cycles an instruction of the encoder's largest parts.
pub fn milliseconds(instructions: u64) -> f64 {
    instructions as f64 * 1.54 / 64e3
}

/// Instructions of a part, per patch.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CountedPart {
    /// Its name.
    pub name: String,
    /// Mean over the patches.
    pub mean: u64,
    /// Largest of the patches.
    pub largest: u64,
}

/// The instruction count of a run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CountTable {
    /// Patches counted.
    pub patches: u64,
    /// Bytes of the encoder's state.
    pub state: u64,
    parts: Vec<CountedPart>,
}

impl CountTable {
    /// The counts of a part, by its name.
    pub fn part(&self, name: &str) -> Option<&CountedPart> {
        self.parts.iter().find(|part| part.name == name)
    }

    /// Mean of a part; 0 if it was not counted.
    pub fn mean(&self, name: &str) -> u64 {
        self.part(name).map_or(0, |part| part.mean)
    }

    /// Largest count of a part; 0 if it was not counted.
    pub fn largest(&self, name: &str) -> u64 {
        self.part(name).map_or(0, |part| part.largest)
    }

    /// Parses what the image printed.
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
            Ok(CountedPart {
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
        for name in PARTS.map(|(name, _)| name).iter().chain(&MORE) {
            ensure!(table.part(name).is_some(), "no part {name} in: {output}");
        }
        Ok(table)
    }

    /// Formats the table as the image prints it.
    pub fn text(&self) -> String {
        let part = |part: &CountedPart| format!("{} {} {}\n", part.name, part.mean, part.largest);
        let parts: String = self.parts.iter().map(part).collect();
        format!("patches {}\nstate {}\n{parts}", self.patches, self.state)
    }

    /// Estimated cycles of a part's mean; of the total, the sum over all parts.
    pub fn cycles(&self, name: &str) -> f64 {
        let of = |(name, ratio): &(&str, f64)| self.mean(name) as f64 * ratio;
        PARTS
            .iter()
            .filter(|part| name == "total" || part.0 == name)
            .map(of)
            .sum()
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Returns the output of an image that counts the same for every part but `without`, which it leaves out.
    pub fn output(without: &str, mean: u64) -> String {
        let names = PARTS.map(|(name, _)| name);
        let names = names.iter().chain(&MORE);
        let parts = names.filter(|name| **name != without);
        let lines: Vec<_> = parts
            .map(|name| format!("{name} {mean} 160000\n"))
            .collect();
        format!("patches 5\nstate 7\n{}", lines.concat())
    }

    #[test]
    fn every_part_is_read_and_a_missing_one_is_an_error() {
        let table = CountTable::parse(&output("", 10)).unwrap();
        let total = table.part("total").unwrap();
        assert_eq!((table.patches, total.mean, total.largest), (5, 10, 160_000));
        assert_eq!(table.text(), output("", 10));
        for (name, _) in PARTS {
            assert!(CountTable::parse(&output(name, 10)).is_err(), "{name}");
        }
        assert!(CountTable::parse("hard fault at 0x0").is_err());
    }
}
