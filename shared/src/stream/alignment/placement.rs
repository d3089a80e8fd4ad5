//! The 16 placements of the ring of electrodes on an arm.

use crate::units::CHANNELS;

/// Mapping from the armband's electrodes to those that the model was trained on.
///
/// Electrode `c` of the model is electrode `c + turn` of the armband, or `turn - c` where it is mirrored, as it is on the
/// other arm (modulo 8).
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Alignment {
    turn: u8,
    mirrored: bool,
}

/// Knowledge of the arm: the placements that an alignment chooses among.
///
/// An armband that is put on the other way round, its first end towards the hand, runs as on the other arm.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Arm {
    /// Unknown arm: all 16 placements.
    #[default]
    Unknown,
    /// Direction in which the electrodes run ([`Alignment::mirrored`]): the 8 that do.
    Known {
        /// Whether they run the other way round than in training.
        mirrored: bool,
    },
}

impl Arm {
    /// The arm as seen from an alignment.
    #[must_use]
    pub const fn seen_from(self, alignment: Alignment) -> Self {
        match self {
            Self::Unknown => Self::Unknown,
            Self::Known { mirrored } => Self::Known {
                mirrored: mirrored != alignment.mirrored,
            },
        }
    }
}

impl Alignment {
    /// The armband sits as in training.
    pub const NONE: Self = Self {
        turn: 0,
        mirrored: false,
    };

    /// An armband turned by `turn` places, modulo 8.
    #[must_use]
    pub const fn new(turn: u8, mirrored: bool) -> Self {
        Self {
            turn: turn % CHANNELS as u8,
            mirrored,
        }
    }

    /// All 16 alignments, the unmirrored ones first.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..2 * CHANNELS as u8).map(|place| Self::new(place, place >= CHANNELS as u8))
    }

    /// Places that the armband is turned by, 0 to 7.
    #[must_use]
    pub const fn turn(self) -> u8 {
        self.turn
    }

    /// Whether the electrodes run the other way round.
    #[must_use]
    pub const fn mirrored(self) -> bool {
        self.mirrored
    }

    /// Values of the armband's electrodes in the order of the model's.
    #[must_use]
    pub fn apply<T: Copy>(self, armband: [T; CHANNELS]) -> [T; CHANNELS] {
        // As it nearly always is; this runs for every sample.
        if self.turn == 0 && !self.mirrored {
            return armband;
        }
        self.rearranged(armband)
    }

    /// [`Alignment::apply`] where something changes. Not inlined: it has five callers, and 100 bytes of flash.
    #[inline(never)]
    fn rearranged<T: Copy>(self, armband: [T; CHANNELS]) -> [T; CHANNELS] {
        core::array::from_fn(|electrode| armband[self.source(electrode)])
    }

    /// [`Alignment::apply`] to many at once, which finds the order of the electrodes only once.
    pub(crate) fn apply_to_all<T: Copy>(self, samples: &mut [[T; CHANNELS]]) {
        for sample in samples {
            let armband = *sample;
            *sample = core::array::from_fn(|electrode| armband[self.source(electrode)]);
        }
    }

    /// The alignment that applies this one and then `next`.
    #[must_use]
    pub const fn then(self, next: Self) -> Self {
        Self {
            turn: self.source(next.turn as usize) as u8,
            mirrored: self.mirrored != next.mirrored,
        }
    }

    /// The alignment that undoes this one.
    #[must_use]
    pub const fn inverse(self) -> Self {
        Self {
            turn: if self.mirrored {
                self.turn
            } else {
                (CHANNELS as u8 - self.turn) % CHANNELS as u8
            },
            mirrored: self.mirrored,
        }
    }

    /// Places between two alignments of the same arm, 0 to 4; none if one of them is mirrored.
    #[must_use]
    pub const fn places_from(self, other: Self) -> Option<u8> {
        if self.mirrored != other.mirrored {
            return None;
        }
        let apart = self.turn.abs_diff(other.turn);
        let round = CHANNELS as u8 - apart;
        Some(if apart < round { apart } else { round })
    }

    /// The armband's electrode that is electrode `electrode` of the model, which is below 8.
    const fn source(self, electrode: usize) -> usize {
        let turn = self.turn as usize;
        let place = if self.mirrored {
            turn + CHANNELS - electrode
        } else {
            turn + electrode
        };
        place % CHANNELS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    const NUMBERS: [u8; CHANNELS] = [0, 1, 2, 3, 4, 5, 6, 7];

    #[test]
    fn electrodes_come_from_where_the_definition_says() {
        let [turned, mirrored] = [false, true].map(|own| Alignment::new(3, own).apply(NUMBERS));
        assert_eq!(turned, [3, 4, 5, 6, 7, 0, 1, 2]);
        assert_eq!(mirrored, [3, 2, 1, 0, 7, 6, 5, 4]);
        assert_eq!(Alignment::default(), Alignment::NONE);
        assert_eq!(Alignment::NONE.apply(NUMBERS), NUMBERS);
        assert_eq!(Alignment::new(11, true), Alignment::new(3, true));
    }

    #[test]
    fn there_are_sixteen_and_each_can_be_undone() {
        let orders: Vec<_> = Alignment::all().map(|own| own.apply(NUMBERS)).collect();
        for (index, own) in Alignment::all().enumerate() {
            assert!(!orders[..index].contains(&orders[index]));
            assert_eq!(own.inverse().apply(own.apply(NUMBERS)), NUMBERS);
            assert_eq!(own.then(own.inverse()), Alignment::NONE);
            let mut all = [NUMBERS; 3];
            own.apply_to_all(&mut all);
            assert_eq!(all, [own.apply(NUMBERS); 3]);
        }
        assert_eq!(orders.len(), 16);
    }

    #[test]
    fn two_in_a_row_are_one() {
        for first in Alignment::all() {
            for next in Alignment::all() {
                let both = next.apply(first.apply(NUMBERS));
                assert_eq!(first.then(next).apply(NUMBERS), both);
            }
        }
    }

    #[test]
    fn places_are_counted_the_shorter_way_round() {
        let places = |a, b| Alignment::new(a, false).places_from(Alignment::new(b, false));
        assert_eq!(
            [places(1, 7), places(0, 4), places(5, 5)],
            [Some(2), Some(4), Some(0)]
        );
        assert_eq!(Alignment::NONE.places_from(Alignment::new(0, true)), None);
    }
}
