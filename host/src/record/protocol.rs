//! Protocols of recording sessions: which gestures, in which order and for how long, as a TOML file.
//!
//! Guided: a sequence of classes, from rest to rest, in rounds; each round is a recording. Free: the person names the gestures
//! by keys. A trial is a rest and the gestures up to the next rest; it is repeated as a whole.

mod error;

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

use serde::Deserialize;
use shared::intent::Intent;
use shared::units::SAMPLE_RATE_HZ;

pub use self::error::{ProtocolError, ProtocolFault};
use execution::bounded_read;

/// Built-in protocols: name and TOML text.
pub const BUILT_IN: [(&str, &str); 5] = [
    ("quick", include_str!("../../protocols/quick.toml")),
    (
        "quick-five",
        include_str!("../../protocols/quick-five.toml"),
    ),
    ("quick-six", include_str!("../../protocols/quick-six.toml")),
    ("paper", include_str!("../../protocols/paper.toml")),
    ("free", include_str!("../../protocols/free.toml")),
];

/// Seconds of a class: a muscle needs a second to follow and to settle.
const SECONDS: RangeInclusive<f64> = 1.0..=60.0;
/// Seconds of pause before a round.
const PAUSE: RangeInclusive<f64> = 1.0..=120.0;
/// Hours of a session: a journal has room for it, even if each trial is repeated once.
const HOURS: RangeInclusive<f64> = 0.0..=8.0;
const MOST_ROUNDS: u32 = 50;
/// Greatest number of classes in a sequence.
const MOST_STEPS: usize = 500;

/// Step of a trial: a class and its duration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Step {
    /// The class.
    pub intent: Intent,
    /// Duration in samples.
    pub samples: u32,
}

/// Rest and the gestures after it; the last trial of a round is only a rest.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Trial {
    /// Steps: at least one, rest first.
    pub steps: Vec<Step>,
}

/// Course of a session.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Course {
    /// Trials in order, in each of several rounds.
    Guided {
        /// Number of rounds, at least one.
        rounds: u32,
        /// Trials, at least one with a gesture.
        trials: Vec<Trial>,
    },
    /// Free choice of the person among these gestures.
    Free {
        /// Gestures, rest first.
        gestures: Vec<Intent>,
    },
}

/// Protocol of a recording session.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Protocol {
    /// Name of the built-in protocol or of the file.
    pub name: String,
    /// Samples of pause before each round.
    pub pause: u32,
    /// Course of the session.
    pub course: Course,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    rounds: Option<u32>,
    pause: f64,
    sequence: Option<Vec<String>>,
    gestures: Option<Vec<String>>,
    seconds: Option<BTreeMap<String, f64>>,
}

impl Protocol {
    /// Finds a built-in protocol by its name, or reads it from a file.
    ///
    /// # Errors
    /// When there is no such protocol, or it is invalid.
    pub fn find(name: &str) -> Result<Self, ProtocolError> {
        Self::parse(name, &text(name)?)
    }

    /// Parses the text of a protocol; `name` is for messages.
    ///
    /// # Errors
    /// [`ProtocolError::Toml`] with line and column, or [`ProtocolError::Wrong`].
    pub fn parse(name: &str, text: &str) -> Result<Self, ProtocolError> {
        let found: Text = toml::from_str(text).map_err(|error| ProtocolError::Toml {
            name: name.to_owned(),
            error: error.to_string().trim_end().to_owned(),
        })?;
        let wrong = |fault| ProtocolError::Wrong {
            name: name.to_owned(),
            fault,
        };
        let stem = Path::new(name).file_stem().unwrap_or_default();
        let protocol = Self {
            name: stem.to_string_lossy().into_owned(),
            course: found.course().map_err(wrong)?,
            pause: samples(bounded("pause", found.pause, &PAUSE).map_err(wrong)?),
        };
        let hours = protocol.samples().unwrap_or(0) as f64 / f64::from(3600 * SAMPLE_RATE_HZ);
        bounded("hours of a session", hours, &HOURS).map_err(wrong)?;
        Ok(protocol)
    }

    /// Classes of the protocol, in class order.
    #[must_use]
    pub fn intents(&self) -> Vec<Intent> {
        let asked = |intent: &Intent| match &self.course {
            Course::Guided { trials, .. } => {
                let mut steps = trials.iter().flat_map(|trial| &trial.steps);
                steps.any(|step| step.intent == *intent)
            }
            Course::Free { gestures } => gestures.contains(intent),
        };
        Intent::ALL.into_iter().filter(asked).collect()
    }

    /// Samples of the session without a repeated trial; none if it is free.
    #[must_use]
    pub fn samples(&self) -> Option<u64> {
        let Course::Guided { rounds, trials } = &self.course else {
            return None;
        };
        let steps = trials.iter().flat_map(|trial| &trial.steps);
        let round: u64 = steps.map(|step| u64::from(step.samples)).sum();
        Some(u64::from(*rounds) * (round + u64::from(self.pause)))
    }
}

/// Reads the text of a protocol, comments included.
///
/// # Errors
/// When there is no such protocol or the file cannot be read.
pub fn text(name: &str) -> Result<String, ProtocolError> {
    if let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
        return Ok((*text).to_owned());
    }
    let path = Path::new(name);
    if !path.exists() {
        return Err(ProtocolError::Unknown {
            name: name.to_owned(),
        });
    }
    bounded_read::read_text(path, bounded_read::PRESET).map_err(|error| ProtocolError::Unreadable {
        name: name.to_owned(),
        error: error.to_string(),
    })
}

impl Text {
    fn course(&self) -> Result<Course, ProtocolFault> {
        match (&self.sequence, &self.gestures) {
            (Some(sequence), None) => self.guided(sequence),
            (None, Some(gestures)) => self.free(gestures),
            (Some(_), Some(_)) => Err(ProtocolFault::Kind { found: "both" }),
            (None, None) => Err(ProtocolFault::Kind { found: "neither" }),
        }
    }

    fn guided(&self, sequence: &[String]) -> Result<Course, ProtocolFault> {
        let rounds = self.rounds.unwrap_or(1);
        bounded("rounds", f64::from(rounds), &(1.0..=f64::from(MOST_ROUNDS)))?;
        bounded(
            "classes in the sequence",
            sequence.len() as f64,
            &(3.0..=MOST_STEPS as f64),
        )?;
        let none = BTreeMap::new();
        let seconds = self.seconds.as_ref().unwrap_or(&none);
        for (name, &value) in seconds {
            intent(name)?;
            bounded(&format!("seconds of {name}"), value, &SECONDS)?;
        }
        let mut trials: Vec<Trial> = Vec::new();
        let mut last = None;
        for name in sequence {
            let intent = intent(name)?;
            if last == Some(intent) {
                let class = intent.name();
                return Err(ProtocolFault::Twice { class });
            }
            last = Some(intent);
            let own = seconds.get(intent.name());
            let step = Step {
                intent,
                samples: samples(*own.ok_or(ProtocolFault::NoSeconds {
                    missing: intent.name(),
                })?),
            };
            match trials.last_mut() {
                Some(trial) if intent != Intent::Relax => trial.steps.push(step),
                None if intent != Intent::Relax => return Err(ProtocolFault::Ends),
                _ => trials.push(Trial { steps: vec![step] }),
            }
        }
        if last != Some(Intent::Relax) {
            return Err(ProtocolFault::Ends);
        }
        Ok(Course::Guided { rounds, trials })
    }

    fn free(&self, names: &[String]) -> Result<Course, ProtocolFault> {
        for (key, given) in [
            ("rounds", self.rounds.is_some()),
            ("seconds", self.seconds.is_some()),
        ] {
            if given {
                return Err(ProtocolFault::Meaningless { key });
            }
        }
        let found = names.iter().map(|name| intent(name));
        let gestures: Vec<Intent> = found.collect::<Result<_, _>>()?;
        let mut sorted = gestures.clone();
        sorted.sort_unstable();
        sorted.dedup();
        if sorted.first() != Some(&Intent::Relax)
            || sorted.len() < 2
            || sorted.len() != gestures.len()
        {
            return Err(ProtocolFault::Gestures);
        }
        Ok(Course::Free { gestures: sorted })
    }
}

fn intent(name: &str) -> Result<Intent, ProtocolFault> {
    let found = name.to_owned();
    Intent::from_name(name).ok_or(ProtocolFault::Class { found })
}

fn bounded(what: &str, found: f64, range: &RangeInclusive<f64>) -> Result<f64, ProtocolFault> {
    if range.contains(&found) {
        return Ok(found);
    }
    Err(ProtocolFault::Number {
        what: what.to_owned(),
        least: *range.start(),
        most: *range.end(),
        found,
    })
}

/// Converts seconds within bounds to samples.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most two minutes, never negative"
)]
fn samples(seconds: f64) -> u32 {
    (seconds * f64::from(SAMPLE_RATE_HZ)).round() as u32
}

#[cfg(test)]
mod tests;
