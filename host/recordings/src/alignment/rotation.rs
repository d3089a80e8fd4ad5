//! Electrode rotation: which electrode lies on top of the arm differs between the sets.

use shared::units::{CHANNELS, Sample};

use crate::recording::{DataSet, Recording};

/// Order of a set's channels on the arm: channel c of the common frame is channel `c - rotation` of the set's, or
/// `rotation - c` where the ring runs the other way round (modulo 8).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Frame {
    reversed: bool,
    rotation: usize,
}

impl Frame {
    const COMMON: Self = Self::rotated(0);

    const fn rotated(rotation: usize) -> Self {
        Self {
            reversed: false,
            rotation,
        }
    }

    const fn reversed(rotation: usize) -> Self {
        Self {
            reversed: true,
            rotation,
        }
    }

    /// A sample in the common frame.
    fn align(self, sample: Sample) -> Sample {
        std::array::from_fn(|channel| {
            let own = if self.reversed {
                self.rotation + CHANNELS - channel
            } else {
                channel + CHANNELS - self.rotation
            };
            sample[own % CHANNELS]
        })
    }
}

impl DataSet {
    /// The set's frame; in the common frame wrist extension is strongest on the third channel, as in `ss-stm`
    /// and `myo-readings`.
    ///
    /// `cote-allard` has it on the second, `one-subject-myo` on the fourth. `roshambo` records no
    /// extension; its pattern of open against close correlates best with that of `cote-allard`
    /// rotated by this one electrode (mean over pairs of people 0.35, as recorded 0.12). The others
    /// are fitted on the mean patterns of the gestures that two sets share (tests/recordings.rs).
    const fn electrode_frame(self) -> Frame {
        match self {
            Self::CoteAllard => Frame::rotated(1),
            Self::OneSubjectMyo => Frame::rotated(CHANNELS - 1),
            Self::WangMyo => Frame::rotated(2),
            Self::Myoup => Frame::rotated(CHANNELS - 2),
            Self::UciGestures => Frame::reversed(6),
            _ => Frame::COMMON,
        }
    }
}

impl DataSet {
    /// Brings samples of this set into the common frame of all data sets.
    pub fn align(self, samples: &mut [Sample]) {
        let frame = self.electrode_frame();
        for sample in samples {
            *sample = frame.align(*sample);
        }
    }
}

impl Recording {
    /// The samples with the electrodes in the common frame of all data sets.
    #[must_use]
    pub fn aligned_samples(&self) -> Vec<Sample> {
        let mut samples = self.samples.clone();
        self.data_set.align(&mut samples);
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrist_extension_comes_to_lie_on_the_third_channel() {
        for (data_set, extension) in [
            (DataSet::SsStm, 2),
            (DataSet::CoteAllard, 1),
            (DataSet::OneSubjectMyo, 3),
            (DataSet::Epn, 2),
            (DataSet::Myoup, 4),
            (DataSet::UciGestures, 4),
        ] {
            let mut sample = [0; CHANNELS];
            sample[extension] = 50;
            let recording = Recording::new(data_set, "", vec![sample], vec![None]);
            assert_eq!(recording.aligned_samples()[0][2], 50, "{data_set:?}");
        }
    }

    #[test]
    fn frames_are_those_that_were_measured() {
        // Channel c of the common frame, in the numbering of each set, modulo 8.
        let own = |data_set, c: usize| match data_set {
            DataSet::CoteAllard => c + 7,
            DataSet::WangMyo => c + 6,
            DataSet::Myoup => c + 2,
            DataSet::UciGestures => 14 - c,
            _ => c,
        };
        let numbers = [0, 1, 2, 3, 4, 5, 6, 7];
        for data_set in [
            DataSet::Roshambo,
            DataSet::MyoRps,
            DataSet::Epn,
            DataSet::MyoReadings,
            DataSet::CoteAllard,
            DataSet::WangMyo,
            DataSet::Myoup,
            DataSet::UciGestures,
        ] {
            let recording = Recording::new(data_set, "", vec![numbers], vec![None]);
            let expected: Vec<i8> = (0..CHANNELS)
                .map(|c| (own(data_set, c) % 8) as i8)
                .collect();
            assert_eq!(
                recording.aligned_samples()[0].as_slice(),
                expected,
                "{data_set:?}"
            );
        }
    }
}
