//! Fine-tuning of a model file's weights.

use burn::module::Module as _;
use burn::tensor::Device;
use serde::{Deserialize, Serialize};
use shared::model::dimensions::Dimensions;
use shared::model::file::{Model, ProvenanceParts};
use shared::units::SAMPLE_RATE_HZ;

use super::error::PersonalizeError;
use super::part::PersonPart;
use crate::inference::student_logits;
use crate::optimization::tune;
use crate::student::dequantization::dequantize;
use crate::student::learner::{StudentLearner, Teaching};
use crate::student::quantization::quantize;
use execution::interrupt::Interrupt;
use execution::revision::revision;
use presets::augmentation::Augmentation;
use presets::distillation::Distillation;
use recordings::Recording;
use recordings::corpus::{Corpus, Stream};
use recordings::splice::{SpliceOptions, splice};

/// Name of the training in its progress bar and errors.
const NAME: &str = "personalize";
/// Seconds of the spliced recording that excerpts are drawn from.
const SPLICED_SECONDS: usize = 300;
/// Standard deviation of the logarithm of an excerpt's gain.
const GAIN: f64 = 0.1;

/// Settings of the tuning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TuningSettings {
    /// Number of optimizer steps.
    pub steps: usize,
    /// Number of them where other movement is shown: it takes longer to learn.
    pub steps_with_other: usize,
    /// Number of excerpts of 6 s in a step.
    pub batch: usize,
    /// Peak learning rate of AdamW.
    pub learning_rate: f64,
    /// Share of the old model's own outputs in the targets of gestures and rest, 0 to 1 (learning without forgetting, Li and Hoiem, IEEE TPAMI
    /// 40(12), 2018). Without them, rest raises labels in people whose recordings are steady holds.
    pub keep: f64,
    /// Most margin over other movement of a model that was shown other movement. It knows what is not meant, and a margin of 0 would
    /// cost gestures.
    pub other_margin: f32,
    /// Labels that other movement may raise a minute on half of that held back, for which the margin over it is raised; the other
    /// half judges.
    pub other_per_minute: Option<f64>,
    /// Seed of all draws.
    pub seed: u64,
}

impl Default for TuningSettings {
    fn default() -> Self {
        Self {
            steps: 40,
            steps_with_other: 100,
            batch: 16,
            learning_rate: 1e-3,
            keep: 0.5,
            other_margin: -1.0,
            other_per_minute: None,
            seed: 42,
        }
    }
}

/// Tunes a model file on a part of a person's recordings. Only the weights and the provenance change, and, where other movement is
/// shown, the margin over it. After each step, `report` gets the number of steps done and of all.
pub fn tune(
    file: &[u8],
    part: &PersonPart<'_>,
    settings: &TuningSettings,
    device: &Device,
    interrupt: &Interrupt,
    mut report: impl FnMut(usize, usize),
) -> Result<Vec<u8>, PersonalizeError> {
    let mut parts = Model::parse(file)?.to_parts();
    let recordings = part.recordings();
    let is_other = |own: &Recording| !own.other_movement.is_empty();
    let steps = if parts.dimensions.other && recordings.iter().any(is_other) {
        let own = &mut parts.smoother.margins.other;
        *own = own.map(|own| own.min(settings.other_margin));
        settings.steps_with_other
    } else {
        settings.steps
    };
    let (student, config) = dequantize(&parts, device);
    let corpus = spliced(recordings, parts.dimensions, settings.seed)?
        .with_median(parts.preprocessing.median);
    let plain = device.clone().inner();
    let teaching = if settings.keep > 0.0 {
        let old = student.valid();
        let own = |stream: &Stream| student_logits(&old, &stream.emg, &plain);
        Teaching::Own(corpus.streams.iter().map(own).collect())
    } else {
        Teaching::Labels
    };
    let training = Distillation {
        epochs: 1,
        steps,
        batch: settings.batch,
        patches: 120,
        learning_rate: settings.learning_rate,
        warm_up: 0.1,
        weight_decay: 0.0,
        ema_decay: 0.0,
        teacher_share: settings.keep,
        ensemble: None,
        temperature: 1.0,
        augmentation: Some(Augmentation {
            gain: GAIN,
            rotation: 0,
        }),
    };
    let nothing = Corpus {
        vocabulary: corpus.vocabulary,
        other: corpus.other,
        streams: Vec::new(),
    };
    let span = config.span;
    let learner = StudentLearner::new(NAME, span, &corpus, teaching, &nothing, &training, device);
    let fit = training.train_config(settings.seed);
    let tuned = tune::tune(&learner, student, fit, interrupt, |step| {
        report(step, steps)
    })
    .map_err(PersonalizeError::Training)?
    .ok_or(PersonalizeError::Interrupted)?;
    quantize(
        &tuned.valid(),
        &config,
        parts.dimensions.vocabulary,
        (parts.smoother, parts.preprocessing),
        parts.template,
        provenance(parts.provenance, part, settings),
    )
    .map_err(PersonalizeError::Tuned)
}

/// Splices the person's gestures in random order and of random length, so that the order of a protocol cannot be learnt. Movement
/// outside the vocabulary is a class if the model has one for it (`other`). A recording of it alone has no gesture to splice it with and
/// is a stream of its own.
fn spliced(
    recordings: Vec<Recording>,
    Dimensions {
        vocabulary, other, ..
    }: Dimensions,
    seed: u64,
) -> Result<Corpus, PersonalizeError> {
    let options = SpliceOptions {
        samples: SPLICED_SECONDS * SAMPLE_RATE_HZ as usize,
        count: 1,
        other,
        seed,
    };
    let mut streams: Vec<Stream> = splice(&recordings.iter().collect::<Vec<_>>(), &options)
        .into_iter()
        .map(Stream::from)
        .collect();
    if streams.is_empty() {
        return Err(PersonalizeError::NoChange);
    }
    if other {
        let alone = |own: &Recording| !own.has_labels() && !own.other_movement.is_empty();
        streams.extend(recordings.into_iter().filter(alone).map(Stream::from));
    }
    Ok(Corpus {
        vocabulary,
        other,
        streams,
    })
}

/// Provenance of the tuned model: the people of the old one and this person. It has no scores: they are of the old weights.
fn provenance(
    old: ProvenanceParts,
    part: &PersonPart<'_>,
    settings: &TuningSettings,
) -> ProvenanceParts {
    let person = part.person();
    let subject = person.subject().to_owned();
    let mut seen = old.subjects_seen;
    let mut sets = old.data_sets;
    let mut left_out = old.subjects_left_out;
    left_out.retain(|own| *own != subject);
    let set = person.data_set.name().to_owned();
    if !sets.contains(&set) {
        sets.push(set);
    }
    if !seen.contains(&subject) {
        seen.push(subject);
    }
    ProvenanceParts {
        data_sets: sets,
        subjects_seen: seen,
        subjects_left_out: left_out,
        git_revision: revision().unwrap_or_default().to_owned(),
        seed: settings.seed,
        metrics: Vec::new(),
    }
}
