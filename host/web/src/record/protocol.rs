//! Protocols of recording sessions: which gestures, in which order and for how long, as a TOML file.
//!
//! Guided: a sequence of motions, from rest to rest, in rounds; each round is a recording. Free: the person names the gestures
//! by keys. A cue block is a rest and the gestures up to the next rest; it is repeated as a whole. A gesture is an intent or
//! another movement: a named one (`point`), or `other`, whatever the person does.

mod error;

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

use serde::Deserialize;
use shared::units::SAMPLE_RATE_HZ;

use execution::bounded_read;
use recordings::labels::motion::Motion;

pub use self::error::{Fault, ProtocolError};

/// Built-in protocols: name and TOML text.
pub const BUILT_IN: [(&str, &str); 6] = [
    ("quick", include_str!("../../protocols/quick.toml")),
    (
        "quick-five",
        include_str!("../../protocols/quick-five.toml"),
    ),
    ("quick-six", include_str!("../../protocols/quick-six.toml")),
    ("daily", include_str!("../../protocols/daily.toml")),
    ("paper", include_str!("../../protocols/paper.toml")),
    ("free", include_str!("../../protocols/free.toml")),
];

/// Seconds of a class: a muscle needs a second to follow and to settle.
const SECONDS: RangeInclusive<f64> = 1.0..=60.0;
/// Seconds of pause before a round.
const PAUSE: RangeInclusive<f64> = 1.0..=120.0;
/// Hours of a session: a journal has room for it, even if each block is repeated once.
const HOURS: RangeInclusive<f64> = 0.0..=8.0;
const MOST_ROUNDS: u32 = 50;
/// Greatest number of motions in a sequence.
const MOST_STEPS: usize = 500;

/// Step of a cue block: a motion and its duration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MotionStep {
    /// The motion.
    pub motion: Motion,
    /// Duration in samples.
    pub samples: u32,
}

/// Rest and the gestures after it; the last block of a round is only a rest.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CueBlock {
    /// Steps: at least one, rest first.
    pub steps: Vec<MotionStep>,
}

/// Course of a session.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Course {
    /// Cue blocks in order, in each of several rounds.
    Guided {
        /// Number of rounds, at least one.
        rounds: u32,
        /// Cue blocks, at least one with a gesture.
        blocks: Vec<CueBlock>,
    },
    /// Free choice of the person among these gestures.
    Free {
        /// Gestures, rest first.
        gestures: Vec<Motion>,
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

/// Keys of a protocol's TOML file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProtocolFile {
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
    /// [`Fault::Toml`] with line and column, or the first reason why the protocol is impossible.
    pub fn parse(name: &str, text: &str) -> Result<Self, ProtocolError> {
        let stem = Path::new(name).file_stem().unwrap_or_default();
        Self::named(stem.to_string_lossy().into_owned(), text)
            .map_err(|fault| ProtocolError::Impossible(name.to_owned(), fault))
    }

    fn named(name: String, text: &str) -> Result<Self, Fault> {
        let file: ProtocolFile = toml::from_str(text)
            .map_err(|error| Fault::Toml(error.to_string().trim_end().to_owned()))?;
        let protocol = Self {
            name,
            course: file.course()?,
            pause: samples(bounded("pause", file.pause, &PAUSE)?),
        };
        let hours = protocol.samples().unwrap_or(0) as f64 / f64::from(3600 * SAMPLE_RATE_HZ);
        bounded("hours of a session", hours, &HOURS)?;
        Ok(protocol)
    }

    /// Whether the person chooses the gestures.
    pub const fn is_free(&self) -> bool {
        matches!(self.course, Course::Free { .. })
    }

    /// Names of the motions of the protocol, in the order of [`Motion::named`].
    pub fn names(&self) -> Vec<&'static str> {
        self.motions().into_iter().map(Motion::name).collect()
    }

    /// Motions of the protocol, in the order of [`Motion::named`].
    pub fn motions(&self) -> Vec<Motion> {
        let is_used = |motion: &Motion| match &self.course {
            Course::Guided { blocks, .. } => {
                let mut steps = blocks.iter().flat_map(|block| &block.steps);
                steps.any(|step| step.motion == *motion)
            }
            Course::Free { gestures } => gestures.contains(motion),
        };
        Motion::named().filter(is_used).collect()
    }

    /// Samples of the session without a repeated block; none if it is free.
    pub fn samples(&self) -> Option<u64> {
        let Course::Guided { rounds, blocks } = &self.course else {
            return None;
        };
        let steps = blocks.iter().flat_map(|block| &block.steps);
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
        return Err(ProtocolError::UnknownProtocol(name.to_owned()));
    }
    bounded_read::read_text(path, bounded_read::PRESET)
        .map_err(|error| ProtocolError::UnreadableProtocol(name.to_owned(), error.to_string()))
}

impl ProtocolFile {
    /// Course that the keys describe.
    fn course(&self) -> Result<Course, Fault> {
        match (&self.sequence, &self.gestures) {
            (Some(sequence), None) => self.guided(sequence),
            (None, Some(gestures)) => self.free(gestures),
            (Some(_), Some(_)) => Err(Fault::Course("both")),
            (None, None) => Err(Fault::Course("neither")),
        }
    }

    fn guided(&self, sequence: &[String]) -> Result<Course, Fault> {
        let rounds = self.rounds.unwrap_or(1);
        bounded("rounds", f64::from(rounds), &(1.0..=f64::from(MOST_ROUNDS)))?;
        let steps = 3.0..=MOST_STEPS as f64;
        bounded("motions in the sequence", sequence.len() as f64, &steps)?;
        let none = BTreeMap::new();
        let seconds = self.seconds.as_ref().unwrap_or(&none);
        for (motion, &value) in seconds {
            named(motion)?;
            bounded(&format!("seconds of {motion}"), value, &SECONDS)?;
        }
        let mut blocks: Vec<CueBlock> = Vec::new();
        let mut last = None;
        for found in sequence {
            let motion = named(found)?;
            if last == Some(motion) {
                return Err(Fault::Twice(motion.name()));
            }
            last = Some(motion);
            let own = seconds.get(motion.name());
            let samples = samples(*own.ok_or(Fault::NoSeconds(motion.name()))?);
            let step = MotionStep { motion, samples };
            match blocks.last_mut() {
                Some(block) if motion != Motion::RELAX => block.steps.push(step),
                None if motion != Motion::RELAX => return Err(Fault::Ends),
                _ => blocks.push(CueBlock { steps: vec![step] }),
            }
        }
        if last != Some(Motion::RELAX) {
            return Err(Fault::Ends);
        }
        Ok(Course::Guided { rounds, blocks })
    }

    fn free(&self, motions: &[String]) -> Result<Course, Fault> {
        for (key, given) in [
            ("rounds", self.rounds.is_some()),
            ("seconds", self.seconds.is_some()),
        ] {
            if given {
                return Err(Fault::Meaningless(key));
            }
        }
        let found = motions.iter().map(|motion| named(motion));
        let found: Vec<Motion> = found.collect::<Result<_, _>>()?;
        let is_used = |motion: &Motion| found.contains(motion);
        let gestures: Vec<Motion> = Motion::named().filter(is_used).collect();
        if gestures.first() != Some(&Motion::RELAX)
            || gestures.len() < 2
            || gestures.len() != motions.len()
        {
            return Err(Fault::Gestures);
        }
        Ok(Course::Free { gestures })
    }
}

/// Motion of this name.
fn named(found: &str) -> Result<Motion, Fault> {
    let motion = Motion::from_name(found).filter(|motion| *motion != Motion::Unknown);
    motion.ok_or_else(|| Fault::Motion(found.to_owned()))
}

/// Checks a number and returns it.
fn bounded(what: &str, found: f64, range: &RangeInclusive<f64>) -> Result<f64, Fault> {
    if range.contains(&found) {
        return Ok(found);
    }
    let what = what.to_owned();
    Err(Fault::Number(what, *range.start(), *range.end(), found))
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
