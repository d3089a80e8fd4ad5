//! Electrode rotation: which electrode lies on top of the arm differs between the sets.

use shared::units::{CHANNELS, Sample};

use super::recording::{DataSet, Recording};

impl DataSet {
    /// Electrodes to rotate the channels by, upwards, into the common frame: there, wrist
    /// extension is strongest on the third channel, as in `ss-stm` and `myo-readings`.
    ///
    /// `cote-allard` has it on the second, `one-subject-myo` on the fourth. `roshambo` records no
    /// extension; its pattern of open against close correlates best with that of `cote-allard`
    /// rotated by this one electrode (mean over pairs of people 0.35, as recorded 0.12).
    const fn electrode_rotation(self) -> usize {
        match self {
            Self::CoteAllard => 1,
            Self::OneSubjectMyo => CHANNELS - 1,
            _ => 0,
        }
    }
}

impl Recording {
    /// The samples with the electrodes rotated into the common frame of all data sets.
    #[must_use]
    pub fn aligned_samples(&self) -> Vec<Sample> {
        let rotation = self.data_set.electrode_rotation();
        let rotated = |mut sample: Sample| {
            sample.rotate_right(rotation);
            sample
        };
        self.samples.iter().copied().map(rotated).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn wrist_extension_comes_to_lie_on_the_third_channel() {
        for (data_set, extension) in [
            (DataSet::SsStm, 2),
            (DataSet::CoteAllard, 1),
            (DataSet::OneSubjectMyo, 3),
        ] {
            let mut sample = [0; CHANNELS];
            sample[extension] = 50;
            let recording = Recording {
                data_set,
                subject: String::new(),
                name: String::new(),
                path: PathBuf::new(),
                samples: vec![sample],
                labels: vec![None],
                notes: Vec::new(),
            };
            assert_eq!(recording.aligned_samples()[0][2], 50, "{data_set:?}");
        }
    }
}
