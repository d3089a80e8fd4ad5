//! Streams divided into windows: samples with a lead-in, and labels.

use shared::intent::Intent;
use shared::units::Sample;

use super::frame_layout::FrameLayout;
use recordings::corpus::{Corpus, lead_in};

/// Number of samples in front of a stream: a multiple of the lead-in's patch, so that the newest 600 are those of every
/// other model, and enough for ED-TCN's 625.
const LEAD: usize = 700;

/// Stream with its lead-in, which has no labels.
#[derive(Clone, Debug)]
pub(crate) struct PaddedStream {
    raw: Vec<Sample>,
    labels: Vec<Option<Intent>>,
}

/// Position of a window in a corpus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    pub(crate) stream: usize,
    /// Number of samples of the stream up to the window's end, without the lead-in.
    pub(crate) end: usize,
}

impl PaddedStream {
    /// Adds the lead-in to a stream. `raw` and `labels` have the same length; `labels` may be empty if no targets are needed.
    pub(crate) fn new(raw: &[Sample], labels: &[Option<Intent>]) -> Self {
        let unlabelled = if raw.is_empty() { 0 } else { LEAD };
        let unlabelled = std::iter::repeat_n(None, unlabelled);
        Self {
            raw: lead_in(raw, LEAD),
            labels: unlabelled.chain(labels.iter().copied()).collect(),
        }
    }

    /// Returns the `length` samples up to `end`, as in [`Window::end`]; `end` is 1 or more, `length` at most 700.
    pub(crate) fn window(&self, end: usize, length: usize) -> &[Sample] {
        &self.raw[LEAD + end - length..LEAD + end]
    }

    fn targets(&self, end: usize, layout: FrameLayout) -> Vec<Option<Intent>> {
        layout.targets(&self.labels[LEAD + end - layout.window..LEAD + end])
    }
}

/// Streams of a corpus, and the windows that can be trained or validated with.
#[derive(Clone, Debug)]
pub(crate) struct WindowedCorpus {
    streams: Vec<PaddedStream>,
    layout: FrameLayout,
    /// Windows, `stride` samples apart; each has a frame with a target.
    pub(crate) windows: Vec<Window>,
}

impl WindowedCorpus {
    pub(crate) fn new(corpus: &Corpus, layout: FrameLayout, stride: usize) -> Self {
        let streams: Vec<PaddedStream> = corpus
            .streams
            .iter()
            .map(|stream| PaddedStream::new(&stream.raw, &stream.labels))
            .collect();
        let mut windows = Vec::new();
        for (stream, padded) in streams.iter().enumerate() {
            let has_target = |&end: &usize| padded.targets(end, layout).iter().any(Option::is_some);
            windows.extend(
                (stride..=corpus.streams[stream].raw.len())
                    .step_by(stride)
                    .filter(has_target)
                    .map(|end| Window { stream, end }),
            );
        }
        Self {
            streams,
            layout,
            windows,
        }
    }

    pub(crate) fn samples(&self, window: Window) -> &[Sample] {
        self.streams[window.stream].window(window.end, self.layout.window)
    }

    /// Targets of a window's frames; none where the label is unknown.
    pub(crate) fn targets(&self, window: Window) -> Vec<Option<Intent>> {
        self.streams[window.stream].targets(window.end, self.layout)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::Baseline;
    use recordings::corpus::Stream;
    use shared::intent::Vocabulary;

    fn corpus() -> Corpus {
        let raw: Vec<Sample> = (0..350_i32).map(|t| [(t % 120) as i8; 8]).collect();
        let mut labels = vec![Some(Intent::Open); 350];
        labels[200..260].fill(None);
        Corpus {
            vocabulary: Vocabulary::Three,
            other: false,
            streams: vec![Stream::new(raw, labels)],
        }
    }

    #[test]
    fn a_window_has_the_samples_that_every_other_model_gets() {
        let corpus = corpus();
        let windowed = WindowedCorpus::new(&corpus, FrameLayout::of(Baseline::Lstm, 10), 30);
        let expected = lead_in(&corpus.streams[0].raw, 600);
        let window = Window { stream: 0, end: 10 };
        assert_eq!(windowed.samples(window), &expected[10..610]);
        let windowed = WindowedCorpus::new(&corpus, FrameLayout::of(Baseline::EdTcn, 1), 30);
        let long = windowed.samples(window);
        assert_eq!(long.len(), 625);
        assert_eq!(long[615..], corpus.streams[0].raw[..10]);
    }

    #[test]
    fn windows_without_a_target_are_left_out() {
        let corpus = corpus();
        let ends = |baseline| {
            let layout = FrameLayout::of(baseline, 10);
            let windows = WindowedCorpus::new(&corpus, layout, 30).windows;
            windows.iter().map(|window| window.end).collect::<Vec<_>>()
        };
        assert_eq!(ends(Baseline::EdTcn).len(), 11);
        // The LSTM's targets need labels for half of a frame.
        assert_eq!(ends(Baseline::Lstm)[0], 60);
    }
}
