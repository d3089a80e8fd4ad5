//! Windows of a corpus, and training examples: a window presented as one task.

use shared::intent::Intent;

use presets::masking::Task;
pub use presets::teacher::WindowShape;
use recordings::corpus::Corpus;

/// Position of a window in a corpus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowPosition {
    /// Index of the stream.
    pub stream: usize,
    /// Index of the first sample.
    pub start: usize,
}

impl WindowPosition {
    /// Labels of the window's samples.
    pub(super) fn labels(self, corpus: &Corpus, samples: usize) -> &[Option<Intent>] {
        &corpus.streams[self.stream].labels[self.start..self.start + samples]
    }
}

/// One training example: a window, presented as one task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// The window.
    pub window: WindowPosition,
    /// The task.
    pub task: Task,
}

/// Positions of all windows of `samples` samples in a corpus, `stride` apart; there are no partial windows.
fn windows(corpus: &Corpus, stride: usize, samples: usize) -> Vec<WindowPosition> {
    let mut windows = Vec::new();
    for (stream, recording) in corpus.streams.iter().enumerate() {
        let starts = (0..)
            .step_by(stride)
            .take_while(|start| start + samples <= recording.emg.len());
        windows.extend(starts.map(|start| WindowPosition { stream, start }));
    }
    windows
}

/// Examples of every window, once per task. A window without any label is used for the self-supervised task alone, and that
/// task for such windows alone.
pub(super) fn examples(
    corpus: &Corpus,
    stride: usize,
    samples: usize,
    tasks: &[Task],
) -> Vec<Example> {
    let mut examples = Vec::new();
    for window in windows(corpus, stride, samples) {
        let labels = window.labels(corpus, samples);
        let labelled = labels.iter().any(Option::is_some);
        let fitting = tasks
            .iter()
            .filter(|&&task| (task == Task::SelfSupervised) != labelled);
        examples.extend(fitting.map(|&task| Example { window, task }));
    }
    examples
}

/// Position of the last sample before the first change from one label to another.
pub(super) fn last_before_change(labels: &[Option<Intent>]) -> Option<usize> {
    labels
        .windows(2)
        .position(|pair| matches!(pair, [Some(before), Some(after)] if before != after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_found_only_between_two_labels() {
        let relax = Some(Intent::Relax);
        let open = Some(Intent::Open);
        assert_eq!(last_before_change(&[relax, relax, open, relax]), Some(1));
        assert_eq!(last_before_change(&[relax, None, open]), None);
    }
}
