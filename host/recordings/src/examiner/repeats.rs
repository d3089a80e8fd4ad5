//! Repeats: rows that equal the row before.
//!
//! Two samples of eight channels are equal once in thousands. A program that polls the newest sample faster than the
//! armband sends writes it again, and evenly: at 250 Hz every fifth row. A program that polls at the armband's own rate
//! repeats and loses samples without a pattern.

use shared::units::Sample;

use super::FEWEST;

/// Share of repeated rows from which they are judged; radio losses that a recorder filled in stay below it.
const SHARE: f64 = 0.02;
/// Equal consecutive rows from which there is a standstill: no program polls so fast.
const STANDSTILL: usize = 40;
/// Runs of rows whose lengths are summed, to tell an even pattern from chance.
const BLOCK: usize = 50;
/// Minimum number of blocks for that test.
const BLOCKS: usize = 4;
/// Largest variance of an even pattern, as a share of the variance of random repeats.
const EVEN: f64 = 0.3;

/// Pattern of repeated rows.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Repeats {
    /// Few repeats, as in a recording of the armband.
    Few,
    /// Even repeats: mean number of rows per sample.
    Even(f64),
    /// Repeats without a pattern: the share of rows that repeat.
    Uneven(f64),
}

/// Judges the pattern of the rows that repeat the one before.
pub(crate) fn judge(samples: &[Sample]) -> Repeats {
    let runs: Vec<usize> = runs(samples).filter(|&run| run < STANDSTILL).collect();
    let rows: usize = runs.iter().sum();
    if rows < FEWEST {
        return Repeats::Few;
    }
    let share = (rows - runs.len()) as f64 / rows as f64;
    if share < SHARE {
        return Repeats::Few;
    }
    let times = rows as f64 / runs.len() as f64;
    if is_even(&runs, times) {
        Repeats::Even(times)
    } else {
        Repeats::Uneven(share)
    }
}

/// Lengths of the runs of equal rows.
fn runs(samples: &[Sample]) -> impl Iterator<Item = usize> {
    samples.chunk_by(|a, b| a == b).map(<[Sample]>::len)
}

/// Whether the sums of runs vary less than those of random runs, whose lengths are geometric with the same mean.
fn is_even(runs: &[usize], mean: f64) -> bool {
    let blocks = runs.chunks_exact(BLOCK);
    if blocks.len() < BLOCKS {
        // Too short for statistics: only a constant number is a pattern.
        return runs.len() >= BLOCK && runs.iter().all(|&run| run == runs[0]);
    }
    let expected = BLOCK as f64 * mean;
    let count = blocks.len() as f64;
    let off = blocks.map(|block| (block.iter().sum::<usize>() as f64 - expected).powi(2));
    let variance = off.sum::<f64>() / count;
    // Blocks end at whole rows, which adds half a row of variance even to the most even pattern.
    variance < EVEN * BLOCK as f64 * mean * (mean - 1.0) + 0.5
}

/// Flags of the rows that do not repeat the one before.
pub(crate) fn first_of_each(samples: &[Sample]) -> Vec<bool> {
    let differs = samples.windows(2).map(|pair| pair[0] != pair[1]);
    let first = std::iter::once(true).take(samples.len());
    first.chain(differs).collect()
}

/// First row and number of rows of the longest standstill, if there is one.
pub(crate) fn standstill(samples: &[Sample]) -> Option<(usize, usize)> {
    let mut begin = 0;
    let mut longest: Option<(usize, usize)> = None;
    for run in runs(samples) {
        if run >= STANDSTILL && longest.is_none_or(|(_, rows)| run > rows) {
            longest = Some((begin, run));
        }
        begin += run;
    }
    longest
}
