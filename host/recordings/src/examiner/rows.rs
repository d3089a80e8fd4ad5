//! Rows that are samples of a 200 Hz stream, and pieces of a recording between gaps.
//!
//! Another rate makes duration, latency and flicker wrong by factors. Repeats are dropped only where the rest is at 200
//! Hz for certain: by the clock, or because neighbours then correlate as the armband's do.

use std::ops::Range;

use shared::units::{SAMPLE_RATE_HZ, Sample, WINDOW};

use super::FEWEST;
use super::clock::{Clock, Timebase};
use super::repeats::{Repeats, first_of_each, judge, standstill};
use super::signal::{Signal, mean};
use crate::examiner::finding::Finding;
use crate::labels::motion::{Motion, motions};
use crate::recording::Recording;

/// Largest deviation of a clock's rate, as a share, that is not reported: the armband's own is within 2 %.
const QUIETLY_OFF: f64 = 0.03;
/// Largest deviation of a clock's rate, as a share, that gives a warning; beyond it a recording is refused.
const OFF: f64 = 0.1;
/// Share of uneven repeats above which a recording is refused: a board fills in at most as many samples.
const REPEATED: f64 = 0.15;
/// Range of the correlation of neighbours, in every loud channel, that shows missing samples between them.
const UNRELATED: Range<f64> = -0.13..0.1;
/// Correlation of neighbours below which they are 5 ms apart for certain.
const RELATED: f64 = -0.12;
/// Mean correlation of neighbours, each loud channel's above [`UNRELATED`], from which samples resemble each other: one
/// public recording does, of 6 000.
const RESEMBLING: f64 = 0.25;
/// Minimum number of samples for that judgement: at rest, single channels of raw recordings drift for seconds.
const ENOUGH_RESEMBLING: usize = 1200;
/// Minimum number of rows for which a clock is used.
const CLOCKED: usize = 20;
/// Minimum number of samples for which neighbours are judged, since rest is noise; `CHANNELS`: of loud channels.
const ENOUGH: usize = 4000;
const CHANNELS: usize = 4;

/// Rows that are samples, and the pieces that they form.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct JudgedRows {
    keep: Vec<bool>,
    /// Ranges of the rows that are kept.
    pieces: Vec<Range<usize>>,
    findings: Vec<Finding>,
}

impl JudgedRows {
    /// Judges the rows of a recording, with their clock if there is one. Where samples were filled in and marked,
    /// repeats are not judged.
    ///
    /// # Errors
    /// When the rows are not at 200 Hz, or gaps leave less than half of them in pieces of a window or more.
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
            let column = &clock.name;
            if let Some(Timebase { hz, gaps }) = clock.timebase() {
                judge_rate(hz, column, &mut findings)?;
                pieces = split(rows, &gaps);
                findings.extend(judge_gaps(&gaps, column, &pieces)?);
            } else {
                findings.push(Finding::warning(
                    "clock-unclear",
                    format!(
                        "column \"{column}\" is not used: its values are no times, do not rise, or have no known unit"
                    ),
                    "check that the rows are 200 a second, or give times in s, ms, us or ns (time_ms)",
                ));
            }
        }
        if let Some((row, rows)) = standstill(samples).filter(|&(_, rows)| rows < samples.len()) {
            let (row, seconds) = (row + 1, rows as f64 / f64::from(SAMPLE_RATE_HZ));
            findings.push(Finding::warning(
                "standstill",
                format!("the samples stand still for {seconds:.1} s from row {row} on"),
                "the armband did not stream then: cut the rows out, into two files",
            ));
        }
        Ok(Self {
            keep,
            pieces,
            findings,
        })
    }

    /// Rows of a set of which some recordings are known to have been polled faster than the armband sends: where more
    /// repeat than a board fills in, repeats are dropped. At rest, neighbours do not show the rate.
    pub fn polled(samples: &[Sample]) -> Self {
        let mut keep = first_of_each(samples);
        let dropped = keep.iter().filter(|keep| !**keep).count();
        let mut findings = Vec::new();
        if dropped as f64 >= REPEATED * samples.len() as f64 && dropped > 0 {
            let times = samples.len() as f64 / (samples.len() - dropped) as f64;
            findings.push(polled(times, dropped));
        } else {
            keep.fill(true);
        }
        Self {
            pieces: Vec::new(),
            keep,
            findings,
        }
    }

    /// Removes the rows that are no samples, and splits the recording into pieces without a gap.
    pub fn apply(self, mut recording: Recording) -> Vec<Recording> {
        let keep = self.keep.iter();
        let motions = motions(&recording.labels, &recording.other_movement);
        // Taken out: a copy of the whole for each piece would be work of the square of the rows.
        let samples = std::mem::take(&mut recording.samples).into_iter();
        let (samples, motions): (Vec<Sample>, Vec<Motion>) = samples
            .zip(motions)
            .zip(keep)
            .filter_map(|(row, keep)| keep.then_some(row))
            .unzip();
        recording.labels.clear();
        recording.other_movement.clear();
        // Findings are reported once, with the first piece.
        let mut findings = std::mem::take(&mut recording.findings);
        findings.extend(self.findings);
        let whole = 0..samples.len();
        let pieces = match &self.pieces[..] {
            [] | [_] => std::slice::from_ref(&whole),
            several => several,
        };
        let piece = |(number, piece): (usize, &Range<usize>)| {
            let own = Recording {
                samples: samples[piece.clone()].to_vec(),
                findings: std::mem::take(&mut findings),
                ..recording.clone()
            };
            let motions = motions[piece.clone()].iter().copied();
            let mut own = own.with_truth(motions.collect());
            if pieces.len() > 1 {
                own.name += &format!(".{}", number + 1);
            }
            own
        };
        pieces.iter().enumerate().map(piece).collect()
    }
}

/// Flags of the rows that are kept, and the clock of these rows.
fn kept(
    samples: &[Sample],
    repeats: Repeats,
    clock: Option<&Clock>,
    findings: &mut Vec<Finding>,
) -> Result<(Vec<bool>, Option<Clock>), Finding> {
    let all = vec![true; samples.len()];
    let Repeats::Even(times) = repeats else {
        if let Repeats::Uneven(share) = repeats {
            let percent = 100.0 * share;
            let what = format!(
                "{percent:.0} % of the rows repeat the one before in no pattern: as many samples may be lost"
            );
            let finding = Finding::warning("repeats", what, ONCE);
            if share > REPEATED {
                return Err(finding);
            }
            findings.push(finding);
        }
        return Ok((all, clock.cloned()));
    };
    let keep = first_of_each(samples);
    let left = samples.iter().zip(&keep).filter(|(_, keep)| **keep);
    let left: Vec<Sample> = left.map(|(sample, _)| *sample).collect();
    // A counter counts repeated rows too, so it cannot give the rate without them.
    let clock = clock
        .filter(|clock| !clock.counts())
        .map(|clock| clock.kept(&keep));
    let at_200_hz = match clock.as_ref().map(Clock::timebase) {
        Some(Some(Timebase { hz, .. })) => (hz / f64::from(SAMPLE_RATE_HZ) - 1.0).abs() < OFF,
        _ => left.len() >= FEWEST && mean(&Signal::of(&left).autocorrelations(1, 0, 1)) < RELATED,
    };
    if !at_200_hz {
        let what = format!(
            "each row is there {times:.2} times, and what is left without repeats is not at {SAMPLE_RATE_HZ} Hz: samples are missing"
        );
        return Err(Finding::warning("held", what, ONCE));
    }
    findings.push(polled(times, samples.len() - left.len()));
    Ok((keep, clock))
}

/// Advice on rows that repeat.
const ONCE: &str =
    "take each sample once, from the armband's notifications, not at a rate of your own";

/// Finding of repeats that are left out.
fn polled(times: f64, dropped: usize) -> Finding {
    Finding::warning(
        "polled",
        format!(
            "each sample is there {times:.2} times, evenly: polled faster than {SAMPLE_RATE_HZ} Hz; {dropped} repeats are left out"
        ),
        "take samples from the armband's notifications, not at a rate of your own",
    )
}

fn judge_rate(hz: f64, column: &str, findings: &mut Vec<Finding>) -> Result<(), Finding> {
    let off = (hz / f64::from(SAMPLE_RATE_HZ) - 1.0).abs();
    if off <= QUIETLY_OFF {
        return Ok(());
    }
    let finding = Finding::warning(
        "rate",
        format!("expected {SAMPLE_RATE_HZ} rows a second, found {hz:.0} by column \"{column}\""),
        "record at 200 Hz: missing samples cannot be made, and times would be wrong by this factor",
    );
    if off > OFF {
        return Err(finding);
    }
    findings.push(finding);
    Ok(())
}

/// Finding of the largest gap.
///
/// # Errors
/// When gaps leave less than half of the rows in pieces of a window or more.
fn judge_gaps(
    gaps: &[(usize, f64)],
    column: &str,
    pieces: &[Range<usize>],
) -> Result<Option<Finding>, Finding> {
    let largest = gaps
        .iter()
        .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
    let Some((row, seconds)) = largest else {
        return Ok(None);
    };
    let finding = Finding::warning(
        "gap",
        format!(
            "column \"{column}\" leaps {} times, by {seconds:.2} s at row {}: read as {} recordings",
            gaps.len(),
            row + 1,
            pieces.len()
        ),
        "nothing is joined across a gap; record without losses if there are many",
    );
    let lengths = pieces.iter().map(Range::len);
    let whole = lengths.clone().filter(|rows| *rows >= WINDOW);
    let rows: usize = lengths.sum();
    if 2 * whole.sum::<usize>() < rows && rows >= WINDOW {
        return Err(finding);
    }
    Ok(Some(finding))
}

/// The pieces between gaps.
fn split(rows: usize, gaps: &[(usize, f64)]) -> Vec<Range<usize>> {
    let ends = gaps.iter().map(|&(row, _)| row).chain([rows]);
    let mut from = 0;
    ends.map(|end| std::mem::replace(&mut from, end)..end)
        .collect()
}

/// Finding that neighbours are unrelated, as where every second sample is missing, or resemble each other, as where
/// samples come faster.
pub(super) fn neighbours(signal: &Signal<'_>) -> Option<Finding> {
    let correlations = signal.autocorrelations(1, 0, 1);
    if correlations.len() < CHANNELS {
        return None;
    }
    let (samples, correlation) = (signal.samples.len(), mean(&correlations));
    let all = |related: &dyn Fn(f64) -> bool| correlations.iter().all(|&own| related(own));
    if samples >= ENOUGH && all(&|own| UNRELATED.contains(&own)) {
        return Some(Finding::warning(
            "unrelated-samples",
            format!(
                "samples hardly correlate with the next ({correlation:.2}; -0.2 to -0.4 at {SAMPLE_RATE_HZ} Hz): every second one may be missing"
            ),
            "check that the armband was recorded at 200 Hz, each sample once",
        ));
    }
    let resembling = correlation > RESEMBLING && all(&|own| own > UNRELATED.end);
    (samples >= ENOUGH_RESEMBLING && resembling).then(|| {
        Finding::warning(
            "resembling-samples",
            format!(
                "samples resemble the next (correlation {correlation:.2}; -0.2 to -0.4 at {SAMPLE_RATE_HZ} Hz): sampled faster than \
                 {SAMPLE_RATE_HZ} Hz, filtered, or of another device"
            ),
            "give the armband's own samples, 200 a second, as EMG mode 2 sends them",
        )
    })
}
