//! Small studies on disk, for tests.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::{Outcome, Outcomes, load};
use myointent::dataset::split::Split;
use myointent::evaluation::metric::offset;
use myointent::evaluation::metric::summary::{SubjectScore, Summary};
use myointent::evaluation::{ALL, LookAhead, Score, Truth};
use myointent::execution::run_folder::RunFolder;
use myointent::run::config::{Fold, ResolvedConfig};
use myointent::run::evaluate::{RESULTS, Results, TEACHER};
use myointent::run::preset::Preset;

/// A study's folder, gone with the value.
pub struct Fixture(tempfile::TempDir);

type Edit<T> = Box<dyn FnOnce(&mut T)>;

/// A fold that is being made up: one teacher, judged with and without look-ahead.
pub struct MadeFold {
    path: PathBuf,
    config: ResolvedConfig,
    scores: Vec<SubjectScore>,
    models: Vec<(&'static str, bool)>,
    aggregation: LookAhead,
    config_edit: Option<Edit<ResolvedConfig>>,
    results_edit: Option<Edit<Results>>,
}

impl Fixture {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn study(&self) -> Outcomes {
        load(self.path()).unwrap()
    }

    pub fn variant(&self, name: &str) -> Outcome {
        Outcome::load(&self.path().join(name)).unwrap()
    }

    pub fn fold(&self, variant: &str, number: usize, of: usize) -> MadeFold {
        let preset = Preset::find("quickstart").unwrap();
        MadeFold {
            path: self.path().join(variant).join(format!("fold-{number}")),
            config: ResolvedConfig {
                variant: variant.to_owned(),
                fold: Some(Fold { number, of }),
                preset,
                start: None,
                data: Some("recordings".into()),
                strict: false,
                split: Split {
                    training: vec!["roshambo/08".to_owned()],
                    validation: vec!["ss-stm/sub1".to_owned()],
                    held_out: Vec::new(),
                },
                lags: BTreeMap::new(),
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

impl MadeFold {
    /// Somebody with some score.
    pub fn left_out(self, subject: &str) -> Self {
        self.score(score(subject, 0.9, &[10], 2))
    }

    pub fn score(mut self, score: SubjectScore) -> Self {
        self.scores.push(score);
        self
    }

    /// One more model with the teacher's scores.
    pub fn model(mut self, name: &'static str, look_ahead: bool) -> Self {
        self.models.push((name, look_ahead));
        self
    }

    pub fn reading(mut self, aggregation: LookAhead) -> Self {
        self.reading = reading;
        self
    }

    /// Changes the config after all.
    pub fn config(mut self, edit: impl FnOnce(&mut ResolvedConfig) + 'static) -> Self {
        self.config_edit = Some(Box::new(edit));
        self
    }

    /// Changes the results after all.
    pub fn results(mut self, edit: impl FnOnce(&mut Results) + 'static) -> Self {
        self.results_edit = Some(Box::new(edit));
        self
    }

    pub fn write(mut self) -> PathBuf {
        let mut results = results(self.scores, &self.models);
        results.aggregation = self.reading;
        self.config.split.held_out.clone_from(&results.held_out);
        if let Some(edit) = self.config_edit {
            edit(&mut self.config);
        }
        if let Some(edit) = self.results_edit {
            edit(&mut results);
        }
        let folder = RunFolder::open(&self.path).unwrap();
        self.config.save(&folder).unwrap();
        folder.save_json(RESULTS, &results).unwrap();
        self.path
    }
}

/// A person who follows one change for each offset.
pub fn score(subject: &str, raw: f64, offsets: &[i32], events: usize) -> SubjectScore {
    SubjectScore {
        subject: subject.to_owned(),
        recordings: 1,
        raw_accuracy: Some(raw),
        correct: offsets.len(),
        events,
        transition_accuracy: (events > 0).then(|| offsets.len() as f64 / events as f64),
        offset: offset::summary(offsets),
        offsets: offsets.to_vec(),
    }
}

/// The same scores for every model, all emitted 50 samples later than spoken.
pub fn results(scores: impl IntoIterator<Item = SubjectScore>, models: &[(&str, bool)]) -> Results {
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
    let late = |score: &SubjectScore| {
        let offsets: Vec<i32> = score.offsets.iter().map(|offset| offset + 50).collect();
        SubjectScore {
            offset: offset::summary(&offsets),
            offsets,
            ..score.clone()
        }
    };
    let mut published = Vec::new();
    for truth in [Truth::Published, Truth::LagCompensated] {
        for &(model, with_look_ahead) in models {
            let readings = if with_look_ahead { 3 } else { 1 };
            for look_ahead in LookAhead::ALL.into_iter().take(readings) {
                published.extend(sets.iter().map(|&set| {
                    let of = |score: &&SubjectScore| {
                        set == ALL || score.subject.split('/').next() == Some(set)
                    };
                    let own = || scores.iter().filter(of);
                    let spoken = Summary::of_subjects(own().cloned().collect());
                    Score {
                        model: model.to_owned(),
                        data_set: set.to_owned(),
                        look_ahead,
                        truth,
                        reference: [spoken.clone(), spoken.clone(), spoken],
                        emitted: Summary::of_subjects(own().map(late).collect()),
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
        published,
        spliced: Vec::new(),
    }
}
