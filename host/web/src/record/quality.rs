//! Quality of recordings: whether they are good enough to tune a model on, and if not, why and what to do.

use std::collections::BTreeMap;

use crate::outcome::FindingText;
use crate::said::Said;
use serde::Serialize;
use shared::units::{CHANNELS, SAMPLE_PERIOD_MS};

use super::assembly::{AssembledRecording, Assembly};
use recordings::Severity;
use recordings::examiner::electrodes::{SATURATED, SILENT, levels, saturation};
use recordings::labels::cued::Response;
use recordings::labels::motion::Motion;
use recordings::runs;
use recordings::statistics::median;

/// Number of times that `personalize` needs each gesture: it holds back a third, and needs two there.
const FEWEST: usize = 6;
/// Number of times that docs/personalization.md asks for.
const ENOUGH: usize = 8;
/// Shares of lost samples from which scores suffer (`LOSSES`), and from which a board gives no label (60 of 600).
const LOSSES: f64 = 0.02;
const MANY_LOSSES: f64 = 0.1;
/// Contrast of a gesture with rest below which labels cannot be found, as for labels of the muscle.
const LEAST_CONTRAST: f64 = 0.4;

/// Flaw of a session.
#[derive(Clone, PartialEq, Debug, Serialize, thiserror::Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
pub enum Finding {
    /// No sample was recorded.
    #[error("nothing was recorded")]
    Nothing,
    /// A gesture was done too seldom.
    #[error("{class} {found} times: {enough} are enough, {better} are better")]
    Seldom {
        /// The gesture.
        class: &'static str,
        /// Number of its labelled stretches.
        found: usize,
        /// Number that is enough.
        enough: usize,
        /// Number that is better.
        better: usize,
    },
    /// The muscle did not follow cues.
    #[error("{class}: {found} of {of} cues were not followed")]
    NotFollowed {
        /// The gesture.
        class: &'static str,
        /// Number of cues not followed, followed too late or too weakly.
        found: usize,
        /// Number of cues that count.
        of: usize,
    },
    /// A gesture looks like rest.
    #[error("{class} hardly rises above rest: {factor:.1} times its amplitude")]
    NoContrast {
        /// The gesture.
        class: &'static str,
        /// Median amplitude over that of rest.
        factor: f64,
    },
    /// An electrode gives no signal.
    #[error("channel {channel} is silent")]
    Silent {
        /// Channel, from 1 as on the armband.
        channel: usize,
    },
    /// An electrode's signal exceeds the armband's range.
    #[error("channel {channel} is saturated in {percent:.0} % of the samples")]
    Saturated {
        /// Channel, from 1.
        channel: usize,
        /// Share of the samples in percent.
        percent: f64,
    },
    /// Samples were lost.
    #[error(
        "{samples} samples were lost, {percent:.1} %; gaps of up to 25 ms are bridged, longer ones begin another file"
    )]
    Lost {
        /// Number of lost samples.
        samples: u64,
        /// Share of all samples in percent.
        percent: f64,
    },
    /// Delay of the muscle after its cue.
    #[error("the muscle follows its cue after {late_ms} ms")]
    Late {
        /// Median in milliseconds.
        late_ms: i32,
    },
    /// The session was ended before its end.
    #[error("the session ended early")]
    Early,
    /// The disk has damaged the journal.
    #[error(
        "the journal is damaged: lines lost: {lines}, seconds of samples in them: {seconds:.1}"
    )]
    Damaged {
        /// Number of lines lost.
        lines: u32,
        /// Duration of the samples lost.
        seconds: f64,
    },
}

impl Finding {
    /// Severity of the finding.
    pub fn severity(&self) -> Severity {
        match self {
            Self::Nothing | Self::Silent { .. } | Self::NoContrast { .. } => Severity::Serious,
            Self::Seldom { found, .. } if *found < FEWEST => Severity::Serious,
            Self::NotFollowed { found, of, .. } if 2 * found > *of => Severity::Serious,
            Self::Lost { percent, .. } if *percent > 100.0 * MANY_LOSSES => Severity::Serious,
            Self::Late { .. } | Self::Early => Severity::Note,
            _ => Severity::Warning,
        }
    }

    /// Advice to the person.
    pub const fn advice(&self) -> &'static str {
        match self {
            Self::Nothing => "begin the session and do what it asks for to its end",
            Self::Seldom { .. } => {
                "record another session: all of a person's recordings count together"
            }
            Self::NotFollowed { .. } => {
                "begin as soon as the picture changes, hold until it changes again, and repeat a trial that went wrong with R"
            }
            Self::NoContrast { .. } => {
                "tighten the armband, move it to the thickest part of the forearm, or make the gesture more firmly"
            }
            Self::Silent { .. } => {
                "press the electrode against the skin, wipe skin and electrode; if it stays silent, it is broken"
            }
            Self::Saturated { .. } => "less force, or move the armband a little",
            Self::Lost { .. } => {
                "bring armband and board closer together, away from other radios; unplug what also reads the port"
            }
            Self::Late { .. } => "this is normal and does no harm",
            Self::Early => "what was recorded is kept; record another session for the rest",
            Self::Damaged { .. } => {
                "check the disk; the journal is kept beside the recordings, and the trial in progress there is not used"
            }
        }
    }
}

impl From<&Finding> for FindingText {
    fn from(finding: &Finding) -> Self {
        Self {
            severity: finding.severity(),
            said: Said::of("finding", finding),
            advice: finding.advice(),
        }
    }
}

/// Quality of recordings.
#[derive(Clone, PartialEq, Debug)]
pub struct Quality {
    /// Findings, the worst first.
    pub findings: Vec<Finding>,
    /// Number of labelled stretches of each class.
    pub counts: BTreeMap<&'static str, usize>,
    /// Duration of all recordings in seconds.
    pub seconds: f64,
}

impl Quality {
    /// Whether nothing serious was found.
    pub fn is_good_enough(&self) -> bool {
        let mut findings = self.findings.iter();
        findings.all(|finding| finding.severity() < Severity::Serious)
    }
}

/// Judges the recordings of one session, or all of a person's together.
pub fn judge(assembly: &Assembly) -> Quality {
    let samples: usize = assembly.parts.iter().map(|part| part.samples.len()).sum();
    let seconds = samples as f64 * f64::from(SAMPLE_PERIOD_MS) / 1000.0;
    let mut findings = Vec::new();
    let asked = assembly.asked();
    let counts = asked
        .iter()
        .map(|&motion| (motion.name(), count(assembly, motion)))
        .collect::<BTreeMap<_, _>>();
    if samples == 0 {
        findings.push(Finding::Nothing);
    } else {
        gestures(assembly, &asked, &mut findings);
        electrodes(&assembly.parts, &mut findings);
        let percent = 100.0 * assembly.lost as f64 / (samples as f64 + assembly.lost as f64);
        if percent > 100.0 * LOSSES {
            let samples = assembly.lost;
            findings.push(Finding::Lost { samples, percent });
        }
    }
    if !assembly.complete {
        findings.push(Finding::Early);
    }
    let (lines, samples) = assembly.damaged;
    if lines > 0 {
        let seconds = samples as f64 * f64::from(SAMPLE_PERIOD_MS) / 1000.0;
        findings.push(Finding::Damaged { lines, seconds });
    }
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity()));
    Quality {
        findings,
        counts,
        seconds,
    }
}

fn count(assembly: &Assembly, motion: Motion) -> usize {
    let parts = assembly.parts.iter();
    let labelled = |part: &AssembledRecording| {
        let runs = runs(&part.motions).into_iter();
        runs.filter(|run| run.label == motion).count()
    };
    parts.map(labelled).sum()
}

fn gestures(assembly: &Assembly, asked: &[Motion], findings: &mut Vec<Finding>) {
    let mut late = Vec::new();
    for &motion in asked.iter().filter(|&&motion| motion != Motion::RELAX) {
        let class = motion.name();
        let (mut of, mut unfollowed, mut contrasts) = (0, 0, Vec::new());
        for hold in assembly.parts.iter().flat_map(|part| &part.holds) {
            let cued = hold.gestures.iter().zip(&hold.contrasts);
            for (_, &contrast) in cued.filter(|((_, own), _)| *own == motion) {
                of += 1;
                contrasts.push(contrast);
                match hold.response {
                    // A cue for whatever the person does has no delay.
                    Response::Followed(_) if motion == Motion::OTHER => {}
                    Response::Followed(samples) => late.push(f64::from(samples)),
                    Response::Weak | Response::Elsewhere => unfollowed += 1,
                }
            }
        }
        let found = count(assembly, motion);
        // Other movement needs no number of its own.
        if found < ENOUGH && motion.label().is_some() {
            findings.push(Finding::Seldom {
                class,
                found,
                enough: FEWEST,
                better: ENOUGH,
            });
        }
        match median(&contrasts) {
            Some(contrast) if contrast < LEAST_CONTRAST => {
                let factor = contrast.exp();
                findings.push(Finding::NoContrast { class, factor });
            }
            _ if unfollowed > 0 => findings.push(Finding::NotFollowed {
                class,
                found: unfollowed,
                of,
            }),
            _ => {}
        }
    }
    if let Some(late) = median(&late) {
        #[expect(clippy::cast_possible_truncation, reason = "some hundred samples")]
        let late_ms = late.round() as i32 * SAMPLE_PERIOD_MS as i32;
        findings.push(Finding::Late { late_ms });
    }
}

fn electrodes(parts: &[AssembledRecording], findings: &mut Vec<Finding>) {
    let samples: Vec<_> = parts
        .iter()
        .flat_map(|part| &part.samples)
        .copied()
        .collect();
    let saturated = saturation(&samples);
    let levels = levels(&samples);
    for channel in 0..CHANNELS {
        let number = channel + 1;
        if levels[channel] < SILENT {
            findings.push(Finding::Silent { channel: number });
        }
        if saturated[channel] > SATURATED {
            findings.push(Finding::Saturated {
                channel: number,
                percent: 100.0 * saturated[channel],
            });
        }
    }
}

#[cfg(test)]
mod tests;
