//! Activity profile of a person's open hand, by electrode.

use shared::intent::Intent;
use shared::stream::alignment::{OCTAVE, Profile};
use shared::stream::preprocess::{Median, clean};
use shared::units::{CHANNELS, PATCH, Sample};

use crate::labels::runs::runs;

/// Shortest run of a label that counts as a gesture, in samples: 0.3 s.
const SHORTEST: usize = 60;

/// Profile of one person's open hand, in octaves, from samples with their lag-compensated labels; none if they never
/// open it.
///
/// In each run of the label, the patches count whose activity is at least half of the run's own 80 % quantile: labels
/// of cues extend beyond the muscle's activity. Every run has the same weight. The profile is the device's
/// ([`Profile`]).
pub fn open_hand<'r>(
    recordings: impl IntoIterator<Item = (&'r [Sample], &'r [Option<Intent>])>,
) -> Option<[f64; CHANNELS]> {
    let (mut sum, mut count) = ([0.0; CHANNELS], 0.0);
    for (samples, labels) in recordings {
        let emg: Vec<_> = clean(samples.iter().copied(), Median::Three).collect();
        let is_open = |label| label == Some(Intent::Open);
        for run in runs(labels).into_iter().filter(|run| is_open(run.label)) {
            if run.samples() < SHORTEST {
                continue;
            }
            let patches = emg[run.start..run.end].chunks_exact(PATCH);
            let patches = patches.map(|patch| mean(patch.iter().map(|own| own.map(f64::from))));
            let active = mean_of_active(&patches.collect::<Vec<_>>());
            sum = std::array::from_fn(|electrode| sum[electrode] + active[electrode]);
            count += 1.0;
        }
    }
    // Means of |x|, 0 to 128.
    let means = || sum.map(|sum| (64.0 * sum / count).round() as u32);
    let octaves = |value| f64::from(value) / f64::from(OCTAVE);
    (count > 0.0).then(|| Profile::new(means()).values().map(octaves))
}

/// Mean over the patches whose activity is at least half of the 80 % quantile.
fn mean_of_active(patches: &[[f64; CHANNELS]]) -> [f64; CHANNELS] {
    let level = |patch: &[f64; CHANNELS]| patch.iter().sum::<f64>();
    let mut levels: Vec<f64> = patches.iter().map(level).collect();
    levels.sort_unstable_by(f64::total_cmp);
    let least = levels[(levels.len() - 1) * 4 / 5] / 2.0;
    mean(patches.iter().copied().filter(|own| level(own) >= least))
}

/// Mean of each electrode.
fn mean(values: impl Iterator<Item = [f64; CHANNELS]>) -> [f64; CHANNELS] {
    let (mut sum, mut count) = ([0.0; CHANNELS], 0.0);
    for own in values {
        sum = std::array::from_fn(|electrode| sum[electrode] + own[electrode]);
        count += 1.0;
    }
    sum.map(|sum| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quiet_ends_of_a_run_do_not_count() {
        let loud: Sample = [80, 40, 20, 10, 10, 10, 20, 40];
        let quiet: Sample = [2; 8];
        let mut samples = vec![quiet; 100];
        samples.extend([loud; 100]);
        samples.extend([quiet; 60]);
        // The label begins late and ends late.
        let mut labels = vec![Some(Intent::Relax); 110];
        labels.extend([Some(Intent::Open); 120]);
        labels.extend([Some(Intent::Relax); 30]);
        let found = open_hand([(samples.as_slice(), labels.as_slice())]);
        let means = [80, 40, 20, 10, 10, 10, 20, 40].map(|counts| counts * 64);
        let expected = Profile::new(means)
            .values()
            .map(|value| f64::from(value) / 256.0);
        assert_eq!(found, Some(expected));
    }

    #[test]
    fn who_never_opens_the_hand_has_no_profile() {
        let samples = [[40; 8]; 200];
        for label in [None, Some(Intent::Relax), Some(Intent::Close)] {
            assert_eq!(open_hand([(&samples[..], &[label; 200][..])]), None);
        }
    }
}
