//! What a baseline's logits speak of: which samples of its window, and which labels teach them.

use shared::intent::Intent;
use shared::units::{LOOK_BACK, PATCH, WINDOW};

use super::Baseline;
use shared::model::LookBackLogits;

/// The steps that a baseline gives about one window, oldest first.
///
/// Each is drawn from an inner window; the last inner window ends with the window. An step speaks of
/// the newest `step` samples of its inner window, the first one of everything before it too.
///
/// The reference spreads the steps of LSTM and ED-TCN later than they were features: its i-th step
/// starts at `inner + i * step`, one sample or one step after its inner window, which leaves a stretch
/// without logits and ED-TCN's last step unused. It also stops LSTM's inner windows one sample short
/// of the window's end. Both are mended here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputSteps {
    /// Samples that the baseline hears.
    pub window: usize,
    /// Samples of an inner window.
    pub inner: usize,
    /// Samples from one inner window to the next.
    pub step: usize,
    /// OutputSteps.
    pub count: usize,
    /// Whether an step is taught the most frequent label of its inner window, not the last.
    most_frequent: bool,
}

impl OutputSteps {
    /// A baseline's steps; `lstm_step` matters to the LSTM alone and is 1..=500.
    #[must_use]
    pub const fn of(baseline: Baseline, lstm_step: usize) -> Self {
        match baseline {
            Baseline::Lda | Baseline::Mlp | Baseline::TraHgr => Self {
                window: WINDOW,
                inner: WINDOW,
                step: WINDOW,
                count: 1,
                most_frequent: false,
            },
            Baseline::Lstm => Self {
                window: WINDOW,
                inner: 100,
                step: lstm_step,
                count: (WINDOW - 100) / lstm_step,
                most_frequent: true,
            },
            Baseline::EdTcn => Self {
                window: 625,
                inner: 150,
                step: 25,
                count: 20,
                most_frequent: false,
            },
        }
    }

    /// Where each inner window starts.
    pub fn starts(self) -> impl Iterator<Item = usize> {
        (0..self.count)
            .map(move |step| self.window - self.inner - self.step * (self.count - 1 - step))
    }

    /// The step that speaks of a sample of the window.
    #[must_use]
    pub const fn about(self, sample: usize) -> usize {
        (self.count - 1).saturating_sub((self.window - 1 - sample) / self.step)
    }

    /// The labels that teach the steps, from a window's labels; none where nobody knows.
    #[must_use]
    pub fn labels(self, labels: &[Option<Intent>]) -> Vec<Option<Intent>> {
        self.starts()
            .map(|start| {
                let inner = &labels[start..start + self.inner];
                if self.most_frequent {
                    most_frequent(inner)
                } else {
                    inner[self.inner - 1]
                }
            })
            .collect()
    }

    /// LookBackLogits of the newest patches from one window's logits, `[count][classes]`.
    ///
    /// A patch's row is the mean over its samples. A baseline with one step fills the newest row alone.
    #[must_use]
    pub fn to_look_back(self, logits: &[f32], classes: usize) -> LookBackLogits {
        let mut rows = LookBackLogits::default();
        if self.count == 1 {
            rows[0][..classes].copy_from_slice(logits);
            return rows;
        }
        for (back, row) in rows.iter_mut().enumerate().take(LOOK_BACK) {
            let end = self.window - back * PATCH;
            for sample in end - PATCH..end {
                let step = self.about(sample) * classes;
                for (sum, logit) in row.iter_mut().zip(&logits[step..step + classes]) {
                    *sum += logit / PATCH as f32;
                }
            }
        }
        rows
    }
}

/// The most frequent label, the lowest class on ties; none if most samples have none.
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
    fn inner_windows_are_those_of_the_reference_and_reach_the_newest_sample() {
        let starts = |baseline, step| OutputSteps::of(baseline, step).starts().collect::<Vec<_>>();
        assert_eq!(
            starts(Baseline::EdTcn, 1),
            (0..500).step_by(25).collect::<Vec<_>>()
        );
        assert_eq!(starts(Baseline::Lstm, 1), (1..=500).collect::<Vec<_>>());
        assert_eq!(
            starts(Baseline::Lstm, 10),
            (10..=500).step_by(10).collect::<Vec<_>>()
        );
        assert_eq!(starts(Baseline::Mlp, 1), [0]);
        for baseline in Baseline::ALL {
            for step in [1, 3, 10, 500] {
                let steps = OutputSteps::of(baseline, step);
                let last = steps.starts().last().unwrap();
                assert_eq!(last + steps.inner, steps.window);
                assert_eq!(steps.starts().count(), steps.count);
            }
        }
    }

    #[test]
    fn every_sample_has_an_answer_that_has_heard_it_no_earlier_than_a_step_ago() {
        for (baseline, step) in [
            (Baseline::EdTcn, 1),
            (Baseline::Lstm, 1),
            (Baseline::Lstm, 10),
        ] {
            let steps = OutputSteps::of(baseline, step);
            let ends: Vec<usize> = steps.starts().map(|start| start + steps.inner).collect();
            for sample in 0..steps.window {
                // The naive twin: the first step whose inner window holds the sample.
                let expected = ends.iter().position(|&end| sample < end).unwrap();
                assert_eq!(
                    steps.about(sample),
                    expected,
                    "{baseline:?}, sample {sample}"
                );
            }
        }
    }

    #[test]
    fn labels_are_the_last_or_the_most_frequent_of_the_inner_window() {
        let mut labels = vec![RELAX; 600];
        labels[560..].fill(CLOSE);
        assert_eq!(OutputSteps::of(Baseline::Mlp, 1).labels(&labels), [CLOSE]);
        let found = OutputSteps::of(Baseline::Lstm, 100).labels(&labels);
        assert_eq!(found, [RELAX; 5]);
        labels[540..].fill(CLOSE);
        assert_eq!(
            OutputSteps::of(Baseline::Lstm, 100).labels(&labels)[4],
            CLOSE
        );
        labels[500..].fill(None);
        assert_eq!(
            OutputSteps::of(Baseline::Lstm, 100).labels(&labels)[4],
            None
        );
        assert_eq!(most_frequent(&[CLOSE, RELAX]), RELAX);
        assert_eq!(most_frequent(&[None, CLOSE]), CLOSE);
    }

    #[test]
    fn one_answer_fills_the_newest_row_alone() {
        let rows = OutputSteps::of(Baseline::TraHgr, 1).rows(&[1.0, 2.0, 3.0], 3);
        assert_eq!(rows[0][..3], [1.0, 2.0, 3.0]);
        assert!(rows[1..].iter().flatten().all(|&logit| logit == 0.0));
    }

    #[test]
    fn rows_are_means_over_the_samples_of_a_patch() {
        // Each step's only logit is its number: 19 speaks of the newest 25 samples.
        let logits: Vec<f32> = (0..20_u8).map(f32::from).collect();
        let rows = OutputSteps::of(Baseline::EdTcn, 1).rows(&logits, 1);
        let found: Vec<f32> = rows.iter().map(|row| row[0]).collect();
        for (found, expected) in found.iter().zip([19.0, 19.0, 18.5, 18.0, 18.0, 17.0]) {
            assert!((found - expected).abs() < 1e-4, "{found:?}");
        }
        let logits: Vec<f32> = (0..50_u8).map(f32::from).collect();
        let rows = OutputSteps::of(Baseline::Lstm, 10).rows(&logits, 1);
        for (row, expected) in rows.iter().zip([49.0, 48.0, 47.0, 46.0, 45.0, 44.0]) {
            assert!((row[0] - expected).abs() < 1e-4, "{row:?}");
        }
    }
}
