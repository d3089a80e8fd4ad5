//! Rows: which of them are samples of a 200 Hz stream, and where the recording breaks.
//!
//! Duration, latency and flicker are wrong by factors where the rate is another one. Repeats are dropped only where what is
//! left is at 200 Hz for certain: by the clock, or because neighbours then correlate as the armband's do.

use std::ops::Range;

use shared::units::{SAMPLE_RATE_HZ, Sample, WINDOW};

use super::FEWEST;
use super::clock::{Clock, Says};
use super::repeats::{Repeats, first_of_each, judge, standstill};
use super::signal::{Signal, mean};
use crate::finding::Finding;
use crate::recording::Recording;

/// Share of the rate by which a clock may be off without a word: the armband's own is within 2 %.
const QUIETLY_OFF: f64 = 0.03;
/// Share of the rate by which a clock may be off with a warning; beyond, a recording is refused.
const OFF: f64 = 0.1;
/// Uneven repeats from which a recording is refused: a board fills in at most as many samples.
const REPEATED: f64 = 0.15;
/// Correlation of neighbours, in every loud channel, within which samples are missing between them.
const UNRELATED: Range<f64> = -0.13..0.1;
/// Correlation of neighbours up to which they are 5 ms apart for certain.
const RELATED: f64 = -0.12;
/// Rows from which a clock is looked at.
const CLOCKED: usize = 20;
/// Samples, and loud channels, that are needed to judge neighbours: rest is noise.
const ENOUGH: usize = 4000;
const CHANNELS: usize = 4;

/// Rows that are samples, and the pieces that they are in.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Rows {
    keep: Vec<bool>,
    /// Ranges of the rows that are kept.
    pieces: Vec<Range<usize>>,
    findings: Vec<Finding>,
}

impl Rows {
    /// Judges the rows of a recording, with their clock if there is one. Where samples were filled in and marked, repeats
    /// are not judged.
    ///
    /// # Errors
    /// When the rows are not at 200 Hz, or gaps leave no piece of a window.
    pub fn of(samples: &[Sample], clock: Option<&Clock>, filled_in: bool) -> Result<Self, Finding> {
        let mut findings = Vec::new();
        let clock = clock.filter(|_| samples.len() >= CLOCKED);
        let repeats = if filled_in {
            Repeats::Few
        } else {
            judge(samples)
        };
        let (keep, clock) = kept(samples, repeats, clock, &mut findings)?;
        let rows = keep.iter().filter(|keep| **keep).count();
        let mut pieces = Vec::from_iter(std::iter::once(0..rows));
        if let Some(clock) = &clock {
            let column = clock.name.clone();
            match clock.says() {
                Says::Nothing => findings.push(Finding::ClockUnclear { column }),
                Says::Rate { hz, gaps } => {
                    judge_rate(hz, &column, &mut findings)?;
                    pieces = split(rows, &gaps);
                    if let Some(&(row, seconds)) = gaps
                        .iter()
                        .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
                    {
                        let finding = Finding::Gap {
                            column,
                            gaps: gaps.len(),
                            row: row + 1,
                            seconds,
                            pieces: pieces.len(),
                        };
                        let whole = pieces.iter().filter(|piece| piece.len() >= WINDOW);
                        if 2 * whole.map(|piece| piece.len()).sum::<usize>() < rows
                            && rows >= WINDOW
                        {
                            return Err(finding);
                        }
                        findings.push(finding);
                    }
                }
            }
        }
        if let Some((row, rows)) = standstill(samples).filter(|&(_, rows)| rows < samples.len()) {
            findings.push(Finding::Standstill {
                row: row + 1,
                seconds: rows as f64 / f64::from(SAMPLE_RATE_HZ),
            });
        }
        Ok(Self {
            keep,
            pieces,
            findings,
        })
    }

    /// The recording without rows that are no samples, in pieces without a gap.
    pub fn apply(self, mut recording: Recording) -> Vec<Recording> {
        let mut rows = self.keep.iter().copied();
        recording.samples.retain(|_| rows.next().unwrap_or(true));
        let mut rows = self.keep.iter().copied();
        recording.labels.retain(|_| rows.next().unwrap_or(true));
        recording.findings.extend(self.findings);
        if self.pieces.len() < 2 {
            return vec![recording];
        }
        let piece = |(number, piece): (usize, &Range<usize>)| Recording {
            name: format!("{}.{}", recording.name, number + 1),
            samples: recording.samples[piece.clone()].to_vec(),
            labels: recording.labels[piece.clone()].to_vec(),
            // Said once.
            findings: if number == 0 {
                recording.findings.clone()
            } else {
                Vec::new()
            },
            ..recording.clone()
        };
        self.pieces.iter().enumerate().map(piece).collect()
    }
}

/// The rows that are kept, and their clock.
fn kept(
    samples: &[Sample],
    repeats: Repeats,
    clock: Option<&Clock>,
    findings: &mut Vec<Finding>,
) -> Result<(Vec<bool>, Option<Clock>), Finding> {
    let all = vec![true; samples.len()];
    let Repeats::Even(times) = repeats else {
        if let Repeats::Uneven(share) = repeats {
            let finding = Finding::Repeats {
                percent: 100.0 * share,
            };
            if share > REPEATED {
                return Err(finding);
            }
            findings.push(finding);
        }
        return Ok((all, clock.cloned()));
    };
    let keep = first_of_each(samples);
    let left: Vec<Sample> = samples
        .iter()
        .zip(&keep)
        .filter(|(_, keep)| **keep)
        .map(|(sample, _)| *sample)
        .collect();
    // A counter of rows says nothing of repeats that it counts itself.
    let clock = clock
        .filter(|clock| !clock.counts())
        .map(|clock| clock.kept(&keep));
    let at_200_hz = match clock.as_ref().map(Clock::says) {
        Some(Says::Rate { hz, .. }) => (hz / f64::from(SAMPLE_RATE_HZ) - 1.0).abs() < OFF,
        _ => left.len() >= FEWEST && mean(&Signal::of(&left).autocorrelations(1, 0, 1)) < RELATED,
    };
    if !at_200_hz {
        return Err(Finding::Held { times });
    }
    findings.push(Finding::Polled {
        times,
        dropped: samples.len() - left.len(),
    });
    Ok((keep, clock))
}

fn judge_rate(hz: f64, column: &str, findings: &mut Vec<Finding>) -> Result<(), Finding> {
    let off = (hz / f64::from(SAMPLE_RATE_HZ) - 1.0).abs();
    let finding = || Finding::Rate {
        column: column.to_owned(),
        hz,
    };
    if off > OFF {
        return Err(finding());
    }
    if off > QUIETLY_OFF {
        findings.push(finding());
    }
    Ok(())
}

/// The pieces between gaps.
fn split(rows: usize, gaps: &[(usize, f64)]) -> Vec<Range<usize>> {
    let ends = gaps.iter().map(|&(row, _)| row).chain([rows]);
    let mut from = 0;
    ends.map(|end| std::mem::replace(&mut from, end)..end)
        .collect()
}

/// Whether neighbours are unrelated, as those of every second sample are.
pub(super) fn neighbours(signal: &Signal<'_>) -> Option<Finding> {
    let correlations = signal.autocorrelations(1, 0, 1);
    let enough = signal.samples.len() >= ENOUGH && correlations.len() >= CHANNELS;
    let unrelated = correlations.iter().all(|own| UNRELATED.contains(own));
    (enough && unrelated).then(|| Finding::Unrelated {
        correlation: mean(&correlations),
    })
}
