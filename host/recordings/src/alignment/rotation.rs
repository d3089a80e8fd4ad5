//! Electrode rotation: which electrode lies on top of the arm differs between the sets.
//!
//! In the common frame wrist extension is strongest on the third channel, as in `ss-stm` and `myo-readings`.
//! `cote-allard` has it on the second, `one-subject-myo` on the fourth. `roshambo` records no extension; its pattern of
//! open against close correlates best with that of `cote-allard` rotated by this one electrode (mean over pairs of people
//! 0.35, as recorded 0.12). The others are fitted on the mean patterns of the gestures that two sets share
//! (tests/recordings/main.rs).

use serde::Deserialize;
use shared::stream::alignment::Alignment;
use shared::units::{CHANNELS, Sample};

use crate::catalogue::DataSet;
use crate::library::Library;
use crate::recording::by_data_set;

/// Order of a set's channels on the arm: channel c of the common frame is channel `c - rotation` of the set's, or
/// `rotation - c` where the ring runs the other way round (modulo 8).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Frame {
    #[serde(default)]
    reversed: bool,
    rotation: u8,
}

impl Frame {
    /// Order that brings channels into the common frame.
    const fn alignment(self) -> Alignment {
        let places = if self.reversed {
            self.rotation
        } else {
            CHANNELS as u8 - self.rotation
        };
        Alignment::new(places, self.reversed)
    }

    /// Turn that brings channels into the common frame, in words; none if they are in it.
    fn words(self) -> Option<String> {
        let places = match self.rotation {
            1 => "1 place".to_owned(),
            places => format!("{places} places"),
        };
        match (self.reversed, self.rotation) {
            (false, 0) => None,
            (false, _) => Some(format!("turned by {places}")),
            (true, 0) => Some("mirrored".to_owned()),
            (true, _) => Some(format!("mirrored and turned by {places}")),
        }
    }
}

impl DataSet {
    /// Brings samples of this set into the common frame of all data sets.
    pub fn align(self, samples: &mut [Sample]) {
        let alignment = self.electrode_frame().alignment();
        for sample in samples {
            *sample = alignment.apply(*sample);
        }
    }
}

impl Library {
    /// Sentences on the sets whose own frame is another than the common one: how their channels come into it.
    pub fn frames(&self) -> Vec<String> {
        let sets = by_data_set(&self.recordings);
        let told = sets.keys().filter_map(|set| {
            let how = set.electrode_frame().words()?;
            Some(format!("{}: {}", set.name(), into(&how)))
        });
        told.collect()
    }

    /// Turns channels into the common frame; notes of the recordings say so.
    pub(crate) fn turn(&mut self) {
        for recording in &mut self.recordings {
            let frame = recording.data_set.electrode_frame();
            if let Some(how) = frame.words() {
                recording.data_set.align(&mut recording.samples);
                recording.notes.push(into(&how));
            }
        }
        self.in_common_frame = true;
    }
}

fn into(how: &str) -> String {
    format!("channels {how} into the common frame of the models")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Recording;

    #[test]
    fn each_set_with_a_frame_of_its_own_is_told_and_no_other() {
        let sets = ["roshambo", "cote-allard", "one-subject-myo", "uci-gestures"];
        let sets = sets.map(DataSet::named).into_iter().chain([DataSet::OWN]);
        let recordings = sets.map(|set| Recording::new(set, "", vec![[0; CHANNELS]], vec![None]));
        let library = Library {
            recordings: recordings.collect(),
            ..Library::default()
        };
        assert_eq!(
            library.frames(),
            [
                "cote-allard: channels turned by 1 place into the common frame of the models",
                "one-subject-myo: channels turned by 7 places into the common frame of the models",
                "uci-gestures: channels mirrored and turned by 6 places into the common frame of the models",
            ]
        );
    }

    #[test]
    fn channels_are_turned_either_way_round_the_arm() {
        let numbers = [0, 1, 2, 3, 4, 5, 6, 7];
        let aligned = |reversed, rotation| {
            let frame = Frame { reversed, rotation };
            frame.alignment().apply(numbers)
        };
        assert_eq!(aligned(false, 1), [7, 0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(aligned(true, 6), [6, 5, 4, 3, 2, 1, 0, 7]);
    }
}
