//! Motion of a person, as the published sets name it: an intent, another movement, or unknown.

use shared::intent::Intent;

use crate::recording::Recording;
use crate::recording::movement::{Movement, MovementKind};

/// Motion at one sample.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Motion {
    /// One of the six intents, relax included.
    Intent(Intent),
    /// Movement that is none of the six intents.
    Other(MovementKind),
    /// Movement that is none of these, and of which nothing else is known.
    Unnamed,
    /// Motion that is unknown or ambiguous: a grasp near to a fist, an edge that cannot be placed.
    Unknown,
}

impl Motion {
    /// Rest.
    pub const RELAX: Self = Self::Intent(Intent::Relax);

    /// Any movement that is none of the six intents.
    pub const OTHER: Self = Self::Other(MovementKind::Other);

    /// All motions that have a name of their own: the intents in class order, then other movement.
    pub fn named() -> impl Iterator<Item = Self> {
        let others = MovementKind::NO_INTENT.map(Self::Other);
        Intent::ALL.map(Self::Intent).into_iter().chain(others)
    }

    /// Motion of a label in a file: the name of an intent, `other`, the name of another movement (`point`), `unknown`, or none for any
    /// other word.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "" | "none" | "unknown" => Some(Self::Unknown),
            _ => Intent::from_name(name)
                .map(Self::Intent)
                .or_else(|| MovementKind::from_name(name).map(Self::Other)),
        }
    }

    /// Motion of a gesture as data sets and LibEMG call it (`Hand_Open`, `waveIn`, `rock`); none for a name that says
    /// nothing for certain.
    pub fn of_gesture(name: &str) -> Option<Self> {
        use MovementKind as Kind;
        let name = name.to_lowercase().replace([' ', '-'], "_");
        Some(match name.trim_matches('_') {
            "no_motion" | "no_movement" | "rest" | "resting" | "relax" | "relaxed" | "neutral"
            | "nogesture" | "no_gesture" => Self::RELAX,
            "hand_open" | "open" | "open_hand" | "paper" | "extend_fingers" => {
                Self::Intent(Intent::Open)
            }
            "hand_close" | "close" | "closed" | "fist" | "rock" | "closed_fist" => {
                Self::Intent(Intent::Close)
            }
            "wrist_flexion" | "flexion" | "wavein" | "wave_in" => Self::Intent(Intent::WaveIn),
            "wrist_extension" | "extension" | "waveout" | "wave_out" => {
                Self::Intent(Intent::WaveOut)
            }
            "pinch" | "pinch_grip" => Self::Intent(Intent::Pinch),
            "pronation" | "wrist_pronation" => Self::Other(Kind::Pronation),
            "supination" | "wrist_supination" => Self::Other(Kind::Supination),
            "radial_deviation" => Self::Other(Kind::RadialDeviation),
            "ulnar_deviation" => Self::Other(Kind::UlnarDeviation),
            "point" | "pointing" => Self::Other(Kind::Point),
            "scissor" | "scissors" | "two" => Self::Other(Kind::TwoFingers),
            "three" => Self::Other(Kind::ThreeFingers),
            "thumb_up" | "thumbs_up" => Self::Other(Kind::ThumbUp),
            _ => return None,
        })
    }

    /// Name of the motion as a file has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Intent(intent) => intent.name(),
            Self::Other(kind) => kind.name(),
            Self::Unnamed | Self::Unknown => "unknown",
        }
    }

    /// Motion of a number in a file: the class of an intent, -1 if it is unknown, -2 for other movement.
    pub fn from_number(number: i64) -> Option<Self> {
        match number {
            -1 => Some(Self::Unknown),
            -2 => Some(Self::OTHER),
            _ => {
                let class = usize::try_from(number).ok();
                class.and_then(Intent::from_class).map(Self::Intent)
            }
        }
    }

    /// Number of the motion in a file, as [`Self::from_number`] reads it.
    pub const fn number(self) -> i8 {
        match self {
            Self::Intent(intent) => intent.class() as i8,
            Self::Unnamed | Self::Unknown => -1,
            Self::Other(_) => -2,
        }
    }

    /// The label of a sample.
    pub const fn label(self) -> Option<Intent> {
        match self {
            Self::Intent(intent) => Some(intent),
            Self::Other(_) | Self::Unnamed | Self::Unknown => None,
        }
    }
}

impl From<Intent> for Motion {
    fn from(intent: Intent) -> Self {
        Self::Intent(intent)
    }
}

/// Motion of each sample by labels and other movement; unknown where there is neither.
pub fn motions(labels: &[Option<Intent>], other_movement: &[Movement]) -> Vec<Motion> {
    let labels = labels.iter();
    let mut motions: Vec<Motion> = labels
        .map(|label| label.map_or(Motion::Unknown, Motion::Intent))
        .collect();
    for movement in other_movement {
        motions[movement.samples.clone()].fill(Motion::Other(movement.kind));
    }
    motions
}

/// Labels and other movement of a recording, as [`Recording`] holds them.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct GroundTruth {
    /// Label of each sample; none where no intent is known.
    pub labels: Vec<Option<Intent>>,
    /// Movement that is none of the intents, in order.
    pub other_movement: Vec<Movement>,
}

impl Recording {
    /// The recording with these labels and this other movement.
    pub(crate) fn with_truth(self, truth: GroundTruth) -> Self {
        Self {
            labels: truth.labels,
            other_movement: truth.other_movement,
            ..self
        }
    }
}

impl FromIterator<Motion> for GroundTruth {
    /// Collects the motion of each sample.
    fn from_iter<I: IntoIterator<Item = Motion>>(motions: I) -> Self {
        let mut truth = Self::default();
        for (at, motion) in motions.into_iter().enumerate() {
            truth.labels.push(motion.label());
            let Motion::Other(kind) = motion else {
                continue;
            };
            match truth.other_movement.last_mut() {
                Some(last) if last.kind == kind && last.samples.end == at => last.samples.end += 1,
                _ => truth.other_movement.push(Movement::new(kind, at..at + 1)),
            }
        }
        truth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_movement_is_ranges_without_labels() {
        use MovementKind::{Point, ThumbUp};
        const POINT: Motion = Motion::Other(Point);
        const THUMB: Motion = Motion::Other(ThumbUp);
        let motions = [POINT, POINT, Motion::Unknown, POINT, THUMB, Motion::RELAX];
        let truth: GroundTruth = motions.into_iter().collect();
        let relax = Some(Intent::Relax);
        assert_eq!(truth.labels, [None, None, None, None, None, relax]);
        let expected = [(Point, 0..2), (Point, 3..4), (ThumbUp, 4..5)];
        let expected = expected.map(|(kind, samples)| Movement::new(kind, samples));
        assert_eq!(truth.other_movement, expected);
    }
}
