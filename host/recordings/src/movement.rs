//! Movement that is none of the intents, of which no gesture's label should come.

use std::ops::Range;

use shared::intent::Intent;

/// What is done.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum MovementKind {
    /// An intent that is outside the vocabulary in use.
    Intent(Intent),
    /// The wrist bends towards the thumb.
    RadialDeviation,
    /// The wrist bends towards the little finger.
    UlnarDeviation,
    /// The forearm turns palm down.
    Pronation,
    /// The forearm turns palm up.
    Supination,
    /// The index finger is stretched.
    Point,
    /// Index and middle finger are stretched: the scissors of rock, paper, scissors.
    TwoFingers,
    /// Three fingers are stretched.
    ThreeFingers,
    /// All fingers but the thumb are stretched and spread.
    FourFingers,
    /// All fingers are stretched, side by side.
    FingersTogether,
    /// The thumb is stretched.
    ThumbUp,
}

impl MovementKind {
    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Intent(intent) => intent.name(),
            Self::RadialDeviation => "radial-deviation",
            Self::UlnarDeviation => "ulnar-deviation",
            Self::Pronation => "pronation",
            Self::Supination => "supination",
            Self::Point => "point",
            Self::TwoFingers => "two-fingers",
            Self::ThreeFingers => "three-fingers",
            Self::FourFingers => "four-fingers",
            Self::FingersTogether => "fingers-together",
            Self::ThumbUp => "thumb-up",
        }
    }
}

/// What movement outside the vocabulary is in training: pointing, pronation, intents of a larger vocabulary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OtherMovement {
    /// Unknown: nothing is learnt from it.
    #[default]
    Unknown,
    /// A class of its own, which the student's head has an output for and of which no label comes.
    Class,
}

impl OtherMovement {
    /// Whether the movement has no name.
    pub fn is_unknown(&self) -> bool {
        *self == Self::Unknown
    }
}

/// A movement in a recording.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Movement {
    /// What is done.
    pub kind: MovementKind,
    /// When.
    pub samples: Range<usize>,
}

impl Movement {
    /// A movement of these samples.
    #[must_use]
    pub const fn new(kind: MovementKind, samples: Range<usize>) -> Self {
        Self { kind, samples }
    }
}

/// Which of so many samples are in one of the movements.
#[must_use]
pub fn mask(movements: &[Movement], samples: usize) -> Vec<bool> {
    let mut mask = vec![false; samples];
    for movement in movements {
        mask[movement.samples.clone()].fill(true);
    }
    mask
}
