//! Intents: the classes that recordings, models and the device share.

use crate::names::names;

/// Most classes of a model.
pub const MAX_CLASSES: usize = 6;

/// Most logits of a model for one instant: the classes, and movement outside the vocabulary.
pub const MAX_LOGITS: usize = MAX_CLASSES + 1;

names! {
    /// Intended movement. The class numbers are the paper's, the same in all vocabularies.
    #[derive(PartialOrd, Ord)]
    #[repr(u8)]
    pub enum Intent {
        /// The hand is relaxed. Also the label of the safe state.
        Relax = "relax",
        /// The hand opens.
        Open = "open",
        /// The hand closes to a fist.
        Close = "close",
        /// The wrist flexes.
        WaveIn = "wave-in",
        /// The wrist extends.
        WaveOut = "wave-out",
        /// Thumb and fingertip touch.
        Pinch = "pinch",
    }
}

const _: () = assert!(Intent::ALL.len() == MAX_CLASSES);

impl Intent {
    /// The class number, 0..=5.
    #[must_use]
    pub const fn class(self) -> usize {
        self as usize
    }

    /// The intent of a class number; none from 6 on.
    #[must_use]
    pub const fn from_class(class: usize) -> Option<Self> {
        if class < MAX_CLASSES {
            Some(Self::ALL[class])
        } else {
            None
        }
    }
}

/// The intents of a model: the first three, the first five, or all six.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Vocabulary {
    /// relax, open, close.
    Three,
    /// relax, open, close, wave-in, wave-out.
    Five,
    /// relax, open, close, wave-in, wave-out, pinch.
    Six,
}

impl Vocabulary {
    /// Number of classes: 3, 5 or 6.
    #[must_use]
    pub const fn classes(self) -> usize {
        match self {
            Self::Three => 3,
            Self::Five => 5,
            Self::Six => 6,
        }
    }

    /// The vocabulary with this number of classes.
    #[must_use]
    pub const fn with_classes(classes: usize) -> Option<Self> {
        match classes {
            3 => Some(Self::Three),
            5 => Some(Self::Five),
            6 => Some(Self::Six),
            _ => None,
        }
    }

    /// The intents in class order.
    #[must_use]
    pub fn intents(self) -> &'static [Intent] {
        &Intent::ALL[..self.classes()]
    }

    /// Whether the intent is one of the vocabulary.
    #[must_use]
    pub const fn contains(self, intent: Intent) -> bool {
        intent.class() < self.classes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_classes_are_unique() {
        for intent in Intent::ALL {
            assert_eq!(Intent::from_name(intent.name()), Some(intent));
            assert_eq!(Intent::from_class(intent.class()), Some(intent));
        }
        assert_eq!(Intent::from_class(6), None);
        assert_eq!(Intent::from_name("fist"), None);
    }

    #[test]
    fn each_vocabulary_has_its_first_intents() {
        assert!(Vocabulary::Three.contains(Intent::Close));
        assert!(!Vocabulary::Three.contains(Intent::WaveIn));
        assert!(Vocabulary::Five.contains(Intent::WaveOut));
        assert!(!Vocabulary::Five.contains(Intent::Pinch));
        for vocabulary in [Vocabulary::Three, Vocabulary::Five, Vocabulary::Six] {
            let classes = vocabulary.classes();
            assert_eq!(Vocabulary::with_classes(classes), Some(vocabulary));
            assert_eq!(vocabulary.intents().len(), classes);
        }
        assert_eq!(Vocabulary::with_classes(4), None);
    }
}
