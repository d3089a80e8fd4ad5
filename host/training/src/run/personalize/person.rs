//! Recordings of a person as a model sees them.

use shared::intent::{Intent, Vocabulary};
use shared::model::file::Header;
use shared::units::Sample;

use super::error::PersonalizeError;
use evaluation::EvaluatedRecording;
use recordings::labels::lag::LabelLag;
use recordings::labels::set_lag::Lag;
use recordings::split::predefined;
use recordings::{DataSet, Library, Recording};

/// Recording in the two forms that are needed.
pub(super) struct Own {
    /// Samples as the model's input before preprocessing; labels in its vocabulary, lag-compensated; other movement is all
    /// outside the vocabulary.
    pub(super) recording: Recording,
    pub(super) evaluated: EvaluatedRecording,
}

/// Labelled recordings of a person, in path order, as a model sees them: in its vocabulary, normalized to the wearer if the model
/// is, with labels compensated for their lag.
///
/// The lag is that of `evaluate --model`: each cue's own, or one constant. It is estimated on training people whom the model has
/// seen. If the set has no such people, it is estimated on all of the person's own recordings, held-back ones included, and reported so.
pub struct PersonRecordings {
    subject: String,
    pub(super) vocabulary: Vocabulary,
    pub(super) data_set: DataSet,
    pub(super) recordings: Vec<Own>,
    lag: Lag,
    outside: Vec<&'static str>,
}

impl PersonRecordings {
    /// Selects the recordings of a person (`data-set/subject`, or the part after the slash); without a name, of the only person.
    pub fn new(
        library: &Library,
        subject: Option<&str>,
        model: &Header<'_>,
    ) -> Result<Self, PersonalizeError> {
        let subject = person(library, subject)?;
        let vocabulary = model.dimensions.vocabulary;
        let own = || {
            let recordings = library.recordings.iter();
            recordings.filter(|recording| recording.subject == subject)
        };
        let names = |wanted: &dyn Fn(Intent) -> bool| -> Vec<&'static str> {
            let present =
                |intent: &Intent| own().any(|recording| recording.labels.contains(&Some(*intent)));
            let all = Intent::ALL.into_iter();
            all.filter(|&intent| wanted(intent))
                .filter(present)
                .map(Intent::name)
                .collect()
        };
        let found = names(&|_| true);
        if found.is_empty() {
            return Err(PersonalizeError::NoLabels { subject });
        }
        let expected: Vec<&'static str> = vocabulary
            .intents()
            .iter()
            .map(|intent| intent.name())
            .collect();
        let gestures = &expected[1..];
        if !found.iter().any(|name| gestures.contains(name)) {
            return Err(PersonalizeError::Vocabulary {
                expected,
                recorded: found,
            });
        }
        if let Some(&missing) = expected.iter().find(|name| !found.contains(name)) {
            return Err(PersonalizeError::MissingClass { missing, expected });
        }
        let used: Vec<&Recording> = own()
            .filter(|recording| recording.can_be_evaluated(vocabulary))
            .collect();
        let Some(data_set) = used.first().map(|recording| recording.data_set) else {
            return Err(PersonalizeError::NoLabels { subject });
        };
        let is_training = |person: &str| {
            let mut seen = model.provenance.subjects_seen.iter();
            person != subject && predefined::is_training(person) && seen.any(|own| own == person)
        };
        let others = library.recordings.iter();
        let at_hand: Vec<&Recording> = others
            .filter(|own| own.data_set == data_set)
            .filter(|own| own.subject == subject || is_training(&own.subject))
            .filter(|own| own.can_be_evaluated(vocabulary))
            .collect();
        let lag = Lag::of(data_set, &at_hand, LabelLag::default(), &is_training);
        let recordings = used
            .into_iter()
            .map(|recording| as_seen(recording, vocabulary, model.preprocessing.normalized, &lag))
            .collect();
        let outside = names(&|intent| !vocabulary.contains(intent));
        Ok(Self {
            subject,
            vocabulary,
            data_set,
            recordings,
            lag,
            outside,
        })
    }

    /// Name of the person, as `data-set/subject`.
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// Compensation of the labels for their lag.
    pub const fn lag(&self) -> &Lag {
        &self.lag
    }

    /// Names of gestures in the recordings that the model does not have.
    pub fn outside(&self) -> &[&'static str] {
        &self.outside
    }
}

/// Converts a recording to the model's view.
fn as_seen(recording: &Recording, vocabulary: Vocabulary, normalized: bool, lag: &Lag) -> Own {
    let as_it_is = |_: &mut Vec<Sample>| ();
    let compensation = lag.of_recording(recording);
    let evaluated = EvaluatedRecording::new(recording, as_it_is, vocabulary, compensation);
    let samples = if normalized {
        recording.normalized_samples()
    } else {
        recording.samples.clone()
    };
    Own {
        recording: Recording {
            labels: evaluated.lag_compensated.clone(),
            other_movement: evaluated.other_movement.clone(),
            samples,
            ..recording.clone()
        },
        evaluated,
    }
}

/// Finds the person of a name.
fn person(library: &Library, wanted: Option<&str>) -> Result<String, PersonalizeError> {
    let mut named = library.named(wanted);
    match (named.pop(), wanted) {
        (Some(only), _) if named.is_empty() => Ok(only),
        (None, Some(wanted)) => Err(PersonalizeError::UnknownPerson {
            wanted: wanted.to_owned(),
            found: library.subjects(),
        }),
        (last, _) => {
            named.extend(last);
            Err(PersonalizeError::SeveralPeople { found: named })
        }
    }
}
