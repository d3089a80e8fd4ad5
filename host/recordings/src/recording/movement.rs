//! Movement that is none of the intents, and that no gesture's label should follow.

use std::ops::Range;

use shared::intent::Intent;

use super::daily_life::DailyKind;

/// Kind of a movement.
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
    /// Any movement that is none of the six intents.
    Other,
    /// Daily life: hours of movement in which no gesture is meant.
    Daily(DailyKind),
}

impl MovementKind {
    /// Kinds that a person can be asked for and that are no intent, in the order of the names in tables.
    pub const NO_INTENT: [Self; 11] = [
        Self::RadialDeviation,
        Self::UlnarDeviation,
        Self::Pronation,
        Self::Supination,
        Self::Point,
        Self::TwoFingers,
        Self::ThreeFingers,
        Self::FourFingers,
        Self::FingersTogether,
        Self::ThumbUp,
        Self::Other,
    ];

    /// Kind of a name in tables; none for an intent or an unknown name.
    pub fn from_name(name: &str) -> Option<Self> {
        let daily = DailyKind::ALL.map(Self::Daily);
        let mut kinds = Self::NO_INTENT.into_iter().chain(daily);
        kinds.find(|kind| kind.name() == name)
    }

    /// Whether the movement is daily life.
    pub const fn is_daily(self) -> bool {
        matches!(self, Self::Daily(_))
    }

    /// Name in tables.
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
            Self::Other => "other",
            Self::Daily(kind) => kind.name(),
        }
    }
}

/// Role in training of movement outside the vocabulary: pointing, pronation, intents of a larger vocabulary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OtherMovement {
    /// Unknown: nothing is learnt from it.
    #[default]
    Unknown,
    /// A class of its own: the student's head has an output for it, which never becomes a label.
    Class,
}

/// A movement in a recording.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Movement {
    /// Kind of the movement.
    pub kind: MovementKind,
    /// Samples of the movement.
    pub samples: Range<usize>,
}

impl Movement {
    /// A movement of these samples.
    pub const fn new(kind: MovementKind, samples: Range<usize>) -> Self {
        Self { kind, samples }
    }
}

/// Flags, as many as there are samples, of those that are in one of the movements.
pub fn mask(movements: &[Movement], samples: usize) -> Vec<bool> {
    let mut mask = vec![false; samples];
    for movement in movements {
        mask[movement.samples.clone()].fill(true);
    }
    mask
}

/// Parts of movements within a range of samples, counted from its start.
pub fn within(movements: &[Movement], range: &Range<usize>) -> Vec<Movement> {
    let part = |movement: &Movement| {
        let Range { start, end } = movement.samples;
        let [start, end] = [start, end].map(|at| at.clamp(range.start, range.end) - range.start);
        (start < end).then(|| Movement::new(movement.kind, start..end))
    };
    let before = movements.partition_point(|movement| movement.samples.end <= range.start);
    let within = movements[before..]
        .iter()
        .take_while(|movement| movement.samples.start < range.end);
    within.filter_map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_a_name_of_its_own() {
        let daily = DailyKind::ALL.map(MovementKind::Daily);
        for kind in MovementKind::NO_INTENT.into_iter().chain(daily) {
            assert_eq!(MovementKind::from_name(kind.name()), Some(kind));
            assert_eq!(Intent::from_name(kind.name()), None);
        }
    }

    #[test]
    fn a_movement_across_an_edge_is_cut_there() {
        let movements =
            [2..5, 5..7, 8..12].map(|samples| Movement::new(MovementKind::Other, samples));
        let expected =
            [0..2, 2..4, 5..6].map(|samples| Movement::new(MovementKind::Other, samples));
        assert_eq!(within(&movements, &(3..9)), expected);
    }
}
