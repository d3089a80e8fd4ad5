//! Small studies on disk for tests.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::{StudyResults, VariantResults};
use myointent::dataset::split::Split;
use myointent::evaluation::metric::event::activation::Rate;
use myointent::evaluation::metric::event::latency;
use myointent::evaluation::metric::event::summary::{EventSummary, SubjectEvents};
use myointent::evaluation::metric::offset;
use myointent::evaluation::metric::summary::{SubjectScore, Summary};
use myointent::evaluation::{ALL, Group, LookAhead, Score, Truth};
use myointent::execution::fingerprint::Fingerprint;
use myointent::execution::run_folder::{RunFolder, Stamped};
use myointent::run::config::{Fold, ResolvedConfig};
use myointent::run::evaluate::{RESULTS, Results, TEACHER};
use myointent::run::preset::Preset;

/// A study's folder, removed when dropped.
pub(crate) struct Fixture(tempfile::TempDir);

type Edit<T> = Box<dyn FnOnce(&mut T)>;

/// A synthetic fold: one teacher, evaluated with and without look-ahead.
pub(crate) struct SyntheticFold {
    path: PathBuf,
    config: ResolvedConfig,
    scores: Vec<SubjectScore>,
    models: Vec<(&'static str, bool)>,
    aggregation: LookAhead,
    config_edit: Option<Edit<ResolvedConfig>>,
    results_edit: Option<Edit<Results>>,
}

impl Fixture {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn study(&self) -> StudyResults {
        StudyResults::load(self.path()).unwrap()
    }

    pub(crate) fn variant(&self, name: &str) -> VariantResults {
        VariantResults::load(&self.path().join(name)).unwrap()
    }

    pub(crate) fn fold(&self, variant: &str, number: usize, of: usize) -> SyntheticFold {
        let preset = Preset::find("quickstart").unwrap();
        SyntheticFold {
            path: self.path().join(variant).join(format!("fold-{number}")),
            config: ResolvedConfig {
                variant: variant.to_owned(),
                fold: Some(Fold { number, of }),
                preset,
                start: None,
                seen_before: Vec::new(),
                data: Some("recordings".into()),
                strict: false,
                split: Split {
                    training: vec!["roshambo/08".to_owned()],
                    validation: vec!["ss-stm/sub1".to_owned()],
                    held_out: Vec::new(),
                    test: Vec::new(),
                },
                lags: BTreeMap::new(),
                template: None,
                recordings: Fingerprint::of_bytes(b"recordings"),
                start_weights: None,
                git_revision: Some("abc".to_owned()),
            },
            scores: Vec::new(),
            models: vec![(TEACHER, true)],
            aggregation: LookAhead::AllRows,
            config_edit: None,
            results_edit: None,
        }
    }
}

impl SyntheticFold {
    /// A held-out subject with some score.
    pub(crate) fn held_out(self, subject: &str) -> Self {
        self.score(score(subject, 0.9, &[10], 2))
    }

    pub(crate) fn score(mut self, score: SubjectScore) -> Self {
        self.scores.push(score);
        self
    }

    /// One more model with the teacher's scores.
    pub(crate) fn model(mut self, name: &'static str, look_ahead: bool) -> Self {
        self.models.push((name, look_ahead));
        self
    }

    pub(crate) fn aggregation(mut self, aggregation: LookAhead) -> Self {
        self.aggregation = aggregation;
        self
    }

    /// Changes the configuration before it is written.
    pub(crate) fn config(mut self, edit: impl FnOnce(&mut ResolvedConfig) + 'static) -> Self {
        self.config_edit = Some(Box::new(edit));
        self
    }

    /// Changes the results before they are written.
    pub(crate) fn results(mut self, edit: impl FnOnce(&mut Results) + 'static) -> Self {
        self.results_edit = Some(Box::new(edit));
        self
    }

    pub(crate) fn write(mut self) -> PathBuf {
        let mut results = results(self.scores, &self.models);
        results.aggregation = self.aggregation;
        self.config.split.held_out.clone_from(&results.held_out);
        if let Some(edit) = self.config_edit {
            edit(&mut self.config);
        }
        if let Some(edit) = self.results_edit {
            edit(&mut results);
        }
        let folder = RunFolder::open(&self.path).unwrap();
        self.config.save(&folder).unwrap();
        let results = Stamped {
            made_from: self.config.fingerprint(),
            revision: self.config.git_revision.clone(),
            content: results,
        };
        folder.save_json(RESULTS, &results).unwrap();
        self.path
    }
}

/// A subject for whom the model follows one transition per offset; balanced and raw accuracy are the same.
pub(crate) fn score(subject: &str, raw: f64, offsets: &[i32], events: usize) -> SubjectScore {
    SubjectScore {
        subject: subject.to_owned(),
        recordings: 1,
        classes: 3,
        balanced_accuracy: Some(raw),
        raw_accuracy: Some(raw),
        correct: offsets.len(),
        events,
        transition_accuracy: (events > 0).then(|| offsets.len() as f64 / events as f64),
        offset: offset::summary(offsets),
        offsets: offsets.to_vec(),
    }
}

/// The events of a subject: every transition is the onset of a gesture, and labels are emitted 50 samples after
/// their reference time; one false activation in half a minute of rest, three changes too many in a minute.
fn events(score: &SubjectScore) -> SubjectEvents {
    let latencies: Vec<i32> = score.offsets.iter().map(|offset| offset + 50).collect();
    let rate = |count, seconds| Rate { count, seconds };
    SubjectEvents {
        subject: score.subject.clone(),
        gestures: score.events,
        recognised: score.correct,
        recognition: score.transition_accuracy,
        latency: latency::summary(&latencies, score.events),
        latencies,
        rest: rate(1, 30.0),
        other_movement: rate(0, 0.0),
        raised: BTreeMap::new(),
        flicker: rate(3, 60.0),
    }
}

/// The same scores for every model.
pub(crate) fn results(
    scores: impl IntoIterator<Item = SubjectScore>,
    models: &[(&str, bool)],
) -> Results {
    let scores: Vec<SubjectScore> = scores.into_iter().collect();
    let mut sets: Vec<&str> = scores
        .iter()
        .filter_map(|score| score.subject.split('/').next())
        .collect();
    sets.sort_unstable();
    sets.dedup();
    if sets.len() > 1 {
        sets.push(ALL);
    }
    let mut published = Vec::new();
    for truth in [Truth::Published, Truth::LagCompensated] {
        for &(model, with_look_ahead) in models {
            let conditions = if with_look_ahead { 3 } else { 1 };
            for look_ahead in LookAhead::ALL.into_iter().take(conditions) {
                published.extend(sets.iter().map(|&set| {
                    let of = |score: &&SubjectScore| {
                        set == ALL || score.subject.split('/').next() == Some(set)
                    };
                    let own = || scores.iter().filter(of);
                    let reference = Summary::of_subjects(own().cloned().collect());
                    Score {
                        model: model.to_owned(),
                        data_set: set.to_owned(),
                        classes: 3,
                        people: Group::AllClasses,
                        look_ahead,
                        truth,
                        reference: [reference.clone(), reference.clone(), reference],
                        events: EventSummary::of_subjects(own().map(events).collect()),
                    }
                }));
            }
        }
    }
    let mut held_out: Vec<String> = scores.into_iter().map(|score| score.subject).collect();
    held_out.sort_unstable();
    Results {
        held_out,
        aggregation: LookAhead::AllRows,
        gestures: BTreeMap::new(),
        published,
        spliced: Vec::new(),
    }
}
