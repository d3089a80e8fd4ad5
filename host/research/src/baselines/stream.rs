//! Streams as baselines hear them: raw and cleaned, with a lead-in, window by window.

use shared::intent::Intent;
use shared::units::{CleanSample, Sample};

use super::output_steps::OutputSteps;
use myointent::dataset::corpus::Corpus;
use myointent::dataset::lead_in::lead_in;

/// Samples in front of a stream. A whole number of the lead-in's 100 samples, so that the newest
/// 600 are those that every other model gets, and enough for ED-TCN's 625.
const LEAD: usize = 700;

/// A stream with its lead-in, whose labels nobody knows.
#[derive(Clone, Debug)]
pub struct PaddedStream {
    raw: Vec<Sample>,
    emg: Vec<CleanSample>,
    labels: Vec<Option<Intent>>,
}

/// The samples of one window.
#[derive(Clone, Copy, Debug)]
pub struct WindowSamples<'a> {
    /// As the armband sends them.
    pub raw: &'a [Sample],
    /// The same, cleaned.
    pub emg: &'a [CleanSample],
}

/// A window to learn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Which stream.
    pub stream: usize,
    /// Samples of the stream, lead-in not counted, up to the window's end.
    pub end: usize,
}

impl PaddedStream {
    /// Puts the lead-in in front; all three are of one length.
    #[must_use]
    pub fn new(raw: &[Sample], emg: &[CleanSample], labels: &[Option<Intent>]) -> Self {
        let unknown = if raw.is_empty() { 0 } else { LEAD };
        let unknown = std::iter::repeat_n(None, unknown);
        Self {
            raw: lead_in(raw, LEAD),
            emg: lead_in(emg, LEAD),
            labels: unknown.chain(labels.iter().copied()).collect(),
        }
    }

    /// The `length` samples before a place of the stream; the place is 1 or later, the length 700 or less.
    #[must_use]
    pub fn window(&self, end: usize, length: usize) -> WindowSamples<'_> {
        let range = LEAD + end - length..LEAD + end;
        WindowSamples {
            raw: &self.raw[range.clone()],
            emg: &self.emg[range],
        }
    }

    /// What the steps about that window should be.
    #[must_use]
    pub fn labels(&self, end: usize, steps: OutputSteps) -> Vec<Option<Intent>> {
        steps.labels(&self.labels[LEAD + end - steps.window..LEAD + end])
    }
}

/// All streams of a corpus, and the windows among them that teach something.
#[derive(Clone, Debug)]
pub struct Windows {
    /// The streams.
    pub streams: Vec<PaddedStream>,
    /// The windows, every `stride` samples, of which at least one step is known.
    pub windows: Vec<Window>,
    /// How many classes there are.
    pub classes: usize,
}

impl Windows {
    /// Lists the windows of a corpus.
    #[must_use]
    pub fn of(corpus: &Corpus, steps: OutputSteps, stride: usize) -> Self {
        let streams: Vec<PaddedStream> = corpus
            .streams
            .iter()
            .map(|stream| PaddedStream::new(&stream.raw, &stream.emg, &stream.labels))
            .collect();
        let mut windows = Vec::new();
        for (stream, own) in corpus.streams.iter().enumerate() {
            windows.extend(
                (stride..=own.raw.len())
                    .step_by(stride)
                    .filter(|&end| {
                        streams[stream]
                            .labels(end, steps)
                            .iter()
                            .any(Option::is_some)
                    })
                    .map(|end| Window { stream, end }),
            );
        }
        Self {
            streams,
            windows,
            classes: corpus.vocabulary.classes(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::Baseline;
    use myointent::dataset::corpus::Stream;
    use myointent::dataset::lead_in::padded;
    use shared::intent::Vocabulary;

    fn corpus() -> Corpus {
        let raw: Vec<Sample> = (0..350_i32).map(|t| [(t % 120) as i8; 8]).collect();
        let mut labels = vec![Some(Intent::Open); 350];
        labels[200..260].fill(None);
        Corpus {
            vocabulary: Vocabulary::Three,
            streams: vec![Stream::new(raw, labels)],
        }
    }

    #[test]
    fn a_window_is_the_one_that_every_other_model_gets() {
        let corpus = corpus();
        let windows_of = Windows::of(&corpus, OutputSteps::of(Baseline::Lda, 1), 30);
        let expected = padded(&corpus.streams[0].emg);
        assert_eq!(
            windows_of.streams[0].window(10, 600).emg,
            &expected[10..610]
        );
        let long = windows_of.streams[0].window(10, 625);
        assert_eq!(long.raw.len(), 625);
        assert_eq!(long.raw[615..], corpus.streams[0].raw[..10]);
    }

    #[test]
    fn windows_whose_label_nobody_knows_are_left_out() {
        let corpus = corpus();
        let ends = |baseline| {
            let windows = Windows::of(&corpus, OutputSteps::of(baseline, 10), 30).windows;
            windows.iter().map(|window| window.end).collect::<Vec<_>>()
        };
        // The last samples of 210, 240 are unknown; LSTM and ED-TCN know older ones.
        assert_eq!(
            ends(Baseline::Mlp),
            [30, 60, 90, 120, 150, 180, 270, 300, 330]
        );
        assert_eq!(ends(Baseline::EdTcn).len(), 11);
        // Half an inner window of labels is the least that LSTM learns from.
        assert_eq!(ends(Baseline::Lstm)[0], 60);
    }
}
