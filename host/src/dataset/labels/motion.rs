//! What a person does, as the published sets name it: an intent, another movement, or unknown.

use std::ops::Range;

use shared::intent::Intent;

/// What is done at one sample.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Motion {
    /// One of the six intents, relax included.
    Intent(Intent),
    /// Movement that is none of the six intents.
    Other,
    /// Not known, or on neither side: a grasp near to a fist, an edge that cannot be placed.
    Unknown,
}

impl Motion {
    /// Rest.
    pub const RELAX: Self = Self::Intent(Intent::Relax);

    /// The label of a sample.
    pub const fn label(self) -> Option<Intent> {
        match self {
            Self::Intent(intent) => Some(intent),
            Self::Other | Self::Unknown => None,
        }
    }
}

/// Labels and other movement of a recording, as [`Recording`](crate::dataset::Recording) holds them.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct Truth {
    pub labels: Vec<Option<Intent>>,
    pub other_movement: Vec<Range<usize>>,
}

impl FromIterator<Motion> for Truth {
    /// One motion a sample.
    fn from_iter<I: IntoIterator<Item = Motion>>(motions: I) -> Self {
        let mut truth = Self::default();
        for (at, motion) in motions.into_iter().enumerate() {
            truth.labels.push(motion.label());
            if motion != Motion::Other {
                continue;
            }
            match truth.other_movement.last_mut() {
                Some(last) if last.end == at => last.end += 1,
                _ => truth.other_movement.push(at..at + 1),
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
        const OTHER: Motion = Motion::Other;
        let motions = [OTHER, OTHER, Motion::Unknown, OTHER, Motion::RELAX];
        let truth: Truth = motions.into_iter().collect();
        let relax = Some(Intent::Relax);
        assert_eq!(truth.labels, [None, None, None, None, relax]);
        assert_eq!(truth.other_movement, [0..2, 3..4]);
    }
}
