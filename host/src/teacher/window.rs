//! Windows of a corpus, and batches of them as tensors.

use burn::tensor::{Device, Int, Tensor, TensorData};
use rand::RngExt;
use shared::intent::Intent;
use shared::units::CHANNELS;

use super::masking::{Masks, Task};
use super::model::TeacherInput;
use crate::dataset::corpus::Corpus;
use crate::training::augmentation::{Augmentation, Variation};

/// How the samples of a teacher's window are grouped into tokens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Samples of a window, a multiple of the patch; 600 in the paper.
    pub window: usize,
    /// Samples of a token.
    pub patch: usize,
}

impl Grid {
    /// Tokens of one modality.
    #[must_use]
    pub const fn tokens(self) -> usize {
        self.window / self.patch
    }
}

/// Where a window lies in a corpus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Index of the stream.
    pub stream: usize,
    /// First sample.
    pub start: usize,
}

/// One training example: a window, presented as one task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// The window.
    pub window: Window,
    /// The task.
    pub task: Task,
}

/// Every window of so many samples of a corpus, `stride` samples apart; partial windows are never made.
#[must_use]
pub fn windows(corpus: &Corpus, stride: usize, samples: usize) -> Vec<Window> {
    let mut windows = Vec::new();
    for (stream, recording) in corpus.streams.iter().enumerate() {
        let starts = (0..)
            .step_by(stride)
            .take_while(|start| start + samples <= recording.emg.len());
        windows.extend(starts.map(|start| Window { stream, start }));
    }
    windows
}

/// Every window once per task; windows without any label only as the self-supervised task.
#[must_use]
pub fn examples(corpus: &Corpus, stride: usize, samples: usize, tasks: &[Task]) -> Vec<Example> {
    let mut examples = Vec::new();
    for window in windows(corpus, stride, samples) {
        let labels = labels_of(corpus, window, samples);
        let labelled = labels.iter().any(Option::is_some);
        let fitting = tasks
            .iter()
            .filter(|&&task| (task == Task::SelfSupervised) != labelled);
        examples.extend(fitting.map(|&task| Example { window, task }));
    }
    examples
}

fn labels_of(corpus: &Corpus, window: Window, samples: usize) -> &[Option<Intent>] {
    &corpus.streams[window.stream].labels[window.start..window.start + samples]
}

/// Position of the last sample before the first change from one label to another.
#[must_use]
pub fn last_before_change(labels: &[Option<Intent>]) -> Option<usize> {
    labels
        .windows(2)
        .position(|pair| matches!(pair, [Some(before), Some(after)] if before != after))
}

/// A batch of examples: what the model sees and what it is asked.
#[derive(Debug)]
pub struct Batch {
    /// What the model sees.
    pub input: TeacherInput,
    /// The unmasked, unscaled EMG, `[b, tokens, patch * 8]`.
    pub emg_target: Tensor<3>,
    /// Masked cells of the EMG loss.
    pub emg_cells: usize,
    /// Class of each sample, 0 where it does not count, `[b, window]`.
    pub intent_target: Tensor<2, Int>,
    /// 1 where the sample counts in the intent loss, `[b, window]`.
    pub intent_weight: Tensor<2>,
    /// Samples in the intent loss.
    pub intent_samples: usize,
}

/// Assembles a batch; draws masks and variations in the order of the examples.
pub fn batch(
    corpus: &Corpus,
    examples: &[Example],
    grid: Grid,
    augmentation: Option<&Augmentation>,
    rng: &mut impl RngExt,
    device: &Device,
) -> Batch {
    let classes = corpus.vocabulary.classes();
    let (b, tokens) = (examples.len(), grid.tokens());
    let Grid { window, patch } = grid;
    let mut emg = Vec::with_capacity(b * window * CHANNELS);
    let mut emg_mask = Vec::with_capacity(b * tokens);
    let mut intent = vec![0.0_f32; b * tokens * (classes + 1)];
    let mut target = Vec::with_capacity(b * window);
    let mut weight = Vec::with_capacity(b * window);
    let mut blocked = Vec::with_capacity(b);

    for (row, example) in examples.iter().enumerate() {
        let labels = labels_of(corpus, example.window, window);
        let masks = example.task.draw(window, last_before_change(labels), rng);
        let variation = augmentation.map_or(Variation::NONE, |augmentation| augmentation.draw(rng));
        let stream = &corpus.streams[example.window.stream];
        let samples = &stream.emg[example.window.start..example.window.start + window];
        variation.write(samples, &mut emg);

        let Masks {
            emg: hidden_emg,
            intent: hidden_intent,
            blocked: block,
        } = masks;
        let hidden_intent = snap(&hidden_intent, patch);
        emg_mask.extend(
            hidden_emg
                .chunks(patch)
                .map(|token| f32::from(u8::from(majority(token)))),
        );
        blocked.push(f32::from(u8::from(block)));
        for (sample, (&label, &hidden)) in labels.iter().zip(&hidden_intent).enumerate() {
            let seen = match label {
                Some(intent) if !hidden && !block => intent.class(),
                _ => classes,
            };
            let token = row * tokens + sample / patch;
            intent[token * (classes + 1) + seen] += 1.0 / patch as f32;
            target.push(label.map_or(0, |intent| intent.class() as i32));
            weight.push(f32::from(u8::from(hidden && label.is_some())));
        }
    }

    let intent_samples = weight.iter().filter(|&&counts| counts > 0.0).count();
    let emg_cells = emg_mask.iter().filter(|&&hidden| hidden > 0.0).count() * patch * CHANNELS;
    let any_blocked = blocked.iter().any(|&block| block > 0.0);
    let emg = Tensor::from_data(TensorData::new(emg, [b, tokens, patch * CHANNELS]), device);
    Batch {
        input: TeacherInput {
            emg: emg.clone(),
            emg_mask: Tensor::from_data(TensorData::new(emg_mask, [b, tokens, 1]), device),
            intent: Tensor::from_data(TensorData::new(intent, [b, tokens, classes + 1]), device),
            blocked: any_blocked.then(|| Tensor::from_data(TensorData::new(blocked, [b]), device)),
        },
        emg_target: emg,
        emg_cells,
        intent_target: Tensor::from_data(TensorData::new(target, [b, window]), device),
        intent_weight: Tensor::from_data(TensorData::new(weight, [b, window]), device),
        intent_samples,
    }
}

/// Masks are drawn on samples; a token is hidden when at least half of its samples are.
fn snap(mask: &[bool], patch: usize) -> Vec<bool> {
    mask.chunks(patch)
        .flat_map(|token| std::iter::repeat_n(majority(token), token.len()))
        .collect()
}

fn majority(token: &[bool]) -> bool {
    2 * token.iter().filter(|&&hidden| hidden).count() >= token.len()
}

/// What the model sees when it is used: whole EMG, every intent masked.
#[must_use]
pub fn inference_input(emg: Vec<f32>, grid: Grid, classes: usize, device: &Device) -> TeacherInput {
    let (tokens, patch) = (grid.tokens(), grid.patch);
    let b = emg.len() / (grid.window * CHANNELS);
    let mut intent = vec![0.0_f32; b * tokens * (classes + 1)];
    for token in intent.chunks_exact_mut(classes + 1) {
        token[classes] = 1.0;
    }
    TeacherInput {
        emg: Tensor::from_data(TensorData::new(emg, [b, tokens, patch * CHANNELS]), device),
        emg_mask: Tensor::zeros([b, tokens, 1], device),
        intent: Tensor::from_data(TensorData::new(intent, [b, tokens, classes + 1]), device),
        blocked: None,
    }
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

    #[test]
    fn windows_without_labels_teach_only_what_needs_none() {
        use rand::SeedableRng as _;
        use shared::intent::Vocabulary;

        use crate::dataset::corpus::Stream;

        let stream = |label| Stream::new(vec![[1; CHANNELS]; 700], vec![label; 700]);
        let corpus = Corpus {
            vocabulary: Vocabulary::Three,
            streams: vec![stream(None), stream(Some(Intent::Open))],
        };
        let tasks = [Task::Intent, Task::SelfSupervised];
        let examples = examples(&corpus, 100, 600, &tasks);
        let of = |stream| {
            let own = examples.iter().filter(move |e| e.window.stream == stream);
            own.map(|e| e.task).collect::<Vec<_>>()
        };
        assert_eq!(of(0), [Task::SelfSupervised; 2]);
        assert_eq!(of(1), [Task::Intent; 2]);

        let grid = Grid {
            window: 600,
            patch: 10,
        };
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let batch = batch(&corpus, &examples, grid, None, &mut rng, &Device::default());
        assert!(batch.emg_cells > 0);
        assert_eq!(
            crate::training::tensor::read_back(batch.input.blocked.unwrap()),
            [1.0, 1.0, 0.0, 0.0]
        );
        let counts = crate::training::tensor::read_back(batch.intent_weight);
        assert!(counts[..1200].iter().all(|&weight| weight == 0.0));
        assert_eq!(
            batch.intent_samples,
            counts[1200..].iter().filter(|&&w| w > 0.0).count()
        );
    }

    #[test]
    fn half_a_token_hides_all_of_it() {
        let snapped = snap(&[true, false, false, false, true, true, true, true], 4);
        assert_eq!(
            snapped,
            [false, false, false, false, true, true, true, true]
        );
        assert_eq!(snap(&[true, false], 2), [true, true]);
    }
}
