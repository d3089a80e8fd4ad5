//! Division of a baseline's window into frames, and the labels and samples that a frame stands for.

use shared::intent::Intent;
use shared::model::LookBackLogits;
use shared::units::{LOOK_BACK, PATCH, WINDOW};

use crate::baselines::Baseline;

/// Frames of one window, oldest first. Each has one feature vector, one target label and one vector of logits.
///
/// Frames overlap, and the last one ends with the window. The logits of a frame refer to its newest `hop`
/// samples, those of the first frame also to everything before them.
///
/// It deviates from the reference's code in two ways. For LSTM and ED-TCN, the reference assigns the logits of frame i to
/// the samples from `frame + i * hop` on. That is after the frame, one hop later than here, and leaves a stretch without
/// logits and ED-TCN's last frame unused. Its last LSTM frame ends one sample before the window does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameLayout {
    /// Number of samples of a window.
    pub(crate) window: usize,
    /// Number of samples of a frame.
    pub(crate) frame: usize,
    /// Number of samples from the start of one frame to the start of the next.
    pub(crate) hop: usize,
    /// Number of frames of a window.
    pub(crate) count: usize,
    target: Target,
}

/// Rule for the training target of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    /// Label of the newest sample.
    Last,
    /// Most frequent label.
    MostFrequent,
}

impl FrameLayout {
    /// Layout of a baseline. The LSTM's hop is `lstm_step`, 1 to 500; ED-TCN does not use it.
    pub(crate) const fn of(baseline: Baseline, lstm_step: usize) -> Self {
        match baseline {
            Baseline::Lstm => Self {
                window: WINDOW,
                frame: 100,
                hop: lstm_step,
                count: (WINDOW - 100) / lstm_step,
                target: Target::MostFrequent,
            },
            Baseline::EdTcn => Self {
                window: 625,
                frame: 150,
                hop: 25,
                count: 20,
                target: Target::Last,
            },
        }
    }

    /// Index of the first sample of each frame, counted from the window's start.
    pub(crate) fn starts(self) -> impl Iterator<Item = usize> {
        (0..self.count)
            .map(move |frame| self.window - self.frame - self.hop * (self.count - 1 - frame))
    }

    /// Index of the frame whose logits refer to a sample of the window.
    const fn frame_of(self, sample: usize) -> usize {
        (self.count - 1).saturating_sub((self.window - 1 - sample) / self.hop)
    }

    /// Targets of the frames, from the labels of a window's samples; none where the label is unknown.
    pub(crate) fn targets(self, labels: &[Option<Intent>]) -> Vec<Option<Intent>> {
        self.starts()
            .map(|start| {
                let frame = &labels[start..start + self.frame];
                match self.target {
                    Target::Last => frame[self.frame - 1],
                    Target::MostFrequent => most_frequent(frame),
                }
            })
            .collect()
    }

    /// Computes the logits of the newest patches from the logits of a window's frames, `[count][classes]`.
    ///
    /// A patch gets the mean over its samples.
    pub(crate) fn look_back_logits(self, logits: &[f32], classes: usize) -> LookBackLogits {
        let mut rows = LookBackLogits::default();
        for (back, row) in rows.iter_mut().enumerate().take(LOOK_BACK) {
            let end = self.window - back * PATCH;
            for sample in end - PATCH..end {
                let frame = self.frame_of(sample) * classes;
                for (sum, logit) in row.iter_mut().zip(&logits[frame..frame + classes]) {
                    *sum += logit / PATCH as f32;
                }
            }
        }
        rows
    }
}

/// Most frequent label, the lowest class on ties; none if more samples are unlabelled than have any one label.
fn most_frequent(labels: &[Option<Intent>]) -> Option<Intent> {
    let count = |label: Option<Intent>| labels.iter().filter(|&&own| own == label).count();
    let mut best = (None, count(None));
    for intent in Intent::ALL.into_iter().map(Some) {
        let own = count(intent);
        if own > best.1 || (own > 0 && own == best.1 && best.0.is_none()) {
            best = (intent, own);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const RELAX: Option<Intent> = Some(Intent::Relax);
    const CLOSE: Option<Intent> = Some(Intent::Close);

    #[test]
    fn frames_are_those_of_the_reference_and_reach_the_newest_sample() {
        let starts = |baseline, step| FrameLayout::of(baseline, step).starts().collect::<Vec<_>>();
        assert_eq!(
            starts(Baseline::EdTcn, 1),
            (0..500).step_by(25).collect::<Vec<_>>()
        );
        assert_eq!(starts(Baseline::Lstm, 1), (1..=500).collect::<Vec<_>>());
        assert_eq!(
            starts(Baseline::Lstm, 10),
            (10..=500).step_by(10).collect::<Vec<_>>()
        );
        for baseline in Baseline::ALL {
            for step in [1, 3, 10, 500] {
                let layout = FrameLayout::of(baseline, step);
                let last = layout.starts().last().unwrap();
                assert_eq!(last + layout.frame, layout.window);
                assert_eq!(layout.starts().count(), layout.count);
            }
        }
    }

    #[test]
    fn a_sample_belongs_to_the_first_frame_that_contains_it() {
        for (baseline, step) in [
            (Baseline::EdTcn, 1),
            (Baseline::Lstm, 1),
            (Baseline::Lstm, 10),
        ] {
            let layout = FrameLayout::of(baseline, step);
            let ends: Vec<usize> = layout.starts().map(|start| start + layout.frame).collect();
            for sample in 0..layout.window {
                // The naive version: the first frame that ends after the sample.
                let expected = ends.iter().position(|&end| sample < end).unwrap();
                assert_eq!(
                    layout.frame_of(sample),
                    expected,
                    "{baseline:?}, sample {sample}"
                );
            }
        }
    }

    #[test]
    fn targets_are_the_last_or_the_most_frequent_label_of_the_frame() {
        let mut labels = vec![RELAX; 600];
        labels[560..].fill(CLOSE);
        let found = FrameLayout::of(Baseline::EdTcn, 1).targets(&[&labels[..25], &labels].concat());
        assert_eq!(found[17..], [RELAX, CLOSE, CLOSE]);
        let found = FrameLayout::of(Baseline::Lstm, 100).targets(&labels);
        assert_eq!(found, [RELAX; 5]);
        labels[540..].fill(CLOSE);
        assert_eq!(
            FrameLayout::of(Baseline::Lstm, 100).targets(&labels)[4],
            CLOSE
        );
        labels[500..].fill(None);
        assert_eq!(
            FrameLayout::of(Baseline::Lstm, 100).targets(&labels)[4],
            None
        );
        assert_eq!(most_frequent(&[CLOSE, RELAX]), RELAX);
        assert_eq!(most_frequent(&[None, CLOSE]), CLOSE);
    }

    #[test]
    fn logits_of_a_patch_are_means_over_its_samples() {
        // The only logit of a frame is its number; frame 19 refers to the newest 25 samples.
        let logits: Vec<f32> = (0..20_u8).map(f32::from).collect();
        let rows = FrameLayout::of(Baseline::EdTcn, 1).look_back_logits(&logits, 1);
        let found: Vec<f32> = rows.iter().map(|row| row[0]).collect();
        for (found, expected) in found.iter().zip([19.0, 19.0, 18.5, 18.0, 18.0, 17.0]) {
            assert!((found - expected).abs() < 1e-4, "{found:?}");
        }
        let logits: Vec<f32> = (0..50_u8).map(f32::from).collect();
        let rows = FrameLayout::of(Baseline::Lstm, 10).look_back_logits(&logits, 1);
        for (row, expected) in rows.iter().zip([49.0, 48.0, 47.0, 46.0, 45.0, 44.0]) {
            assert!((row[0] - expected).abs() < 1e-4, "{row:?}");
        }
    }
}
