//! What a variant's numbers come from, and what speaks against believing them.

use std::collections::BTreeSet;
use std::path::Path;

use super::{Outcome, Run};

impl Outcome {
    /// What produced the numbers, in a line: preset, seed, revisions, folds, people.
    #[must_use]
    pub fn provenance(&self) -> String {
        let config = &self.runs[0].config;
        let revisions: BTreeSet<&str> = self.runs.iter().map(Run::revision).collect();
        let revisions: Vec<&str> = revisions.into_iter().collect();
        let trained = self.runs.iter().map(|run| run.config.split.training.len());
        let (least, most) = trained.fold((usize::MAX, 0), |(least, most), count| {
            (least.min(count), most.max(count))
        });
        let trained = if least == most {
            most.to_string()
        } else {
            format!("{least} to {most}")
        };
        let synthetic = if config.data.is_none() {
            "; SYNTHETIC recordings"
        } else {
            ""
        };
        let start = config.start.as_deref().and_then(Path::file_name);
        let start = start.map_or_else(String::new, |name| {
            format!(", starting from `{}`", name.to_string_lossy())
        });
        format!(
            "`{}`: preset {}, seed {}, revision {}; {} of {} folds; trained on {trained} subjects{start}; {} subjects left out{synthetic}",
            self.name,
            config.preset.name,
            config.preset.seed,
            revisions.join(" and "),
            self.runs.len(),
            self.of(),
            self.results.held_out.len(),
        )
    }

    /// What a reader must know before believing the numbers; nothing if all is as it should be.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let missing = self.missing();
        if !missing.is_empty() {
            let missing: Vec<String> = missing.iter().map(ToString::to_string).collect();
            warnings.push(format!(
                "`{}` has {} of {} folds: {} missing, whose people are in no number",
                self.name,
                self.runs.len(),
                self.of(),
                missing.join(", ")
            ));
        }
        let readings = self.runs.iter().map(|run| run.results.aggregation.name());
        let differ = readings.clone().collect::<BTreeSet<_>>().len() > 1;
        if differ {
            let chosen: Vec<String> = self
                .runs
                .iter()
                .zip(readings)
                .map(|(run, reading)| format!("fold {}: {reading}", run.fold().number))
                .collect();
            warnings.push(format!(
                "`{}`: the folds chose different readings of the look-ahead ({}); shown is `{}`, the paper's",
                self.name,
                chosen.join("; "),
                self.results.aggregation.name()
            ));
        }
        for model in self.models() {
            let judged = |run: &&Run| run.results.published.iter().any(|v| v.model == model);
            let count = self.runs.iter().filter(judged).count();
            if count < self.runs.len() {
                warnings.push(format!(
                    "`{}`: {model} was judged in {count} of {} folds only",
                    self.name,
                    self.runs.len()
                ));
            }
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use crate::comparison::fixture::Fixture;
    use myointent::evaluation::LookAhead;

    #[test]
    fn a_fold_that_is_not_there_is_told_and_counted() {
        let fixture = Fixture::new();
        fixture.fold("main", 3, 3).left_out("roshambo/03").write();
        fixture.fold("main", 1, 3).left_out("roshambo/01").write();
        let main = fixture.variant("main");
        assert_eq!(main.missing(), [2]);
        assert!(main.provenance().contains("2 of 3 folds"));
        assert!(main.warnings()[0].contains("2 of 3 folds: 2 missing"));
    }

    #[test]
    fn a_model_that_some_folds_lack_is_told() {
        let fixture = Fixture::new();
        let first = fixture.fold("main", 1, 2).left_out("roshambo/01");
        first.model("LDA", false).write();
        fixture.fold("main", 2, 2).left_out("roshambo/02").write();
        let warnings = fixture.variant("main").warnings();
        assert_eq!(warnings, ["`main`: LDA was judged in 1 of 2 folds only"]);
    }

    #[test]
    fn folds_that_chose_other_readings_are_shown_in_the_papers() {
        let fixture = Fixture::new();
        let first = fixture.fold("main", 1, 2).left_out("roshambo/01");
        first.reading(LookAhead::SameInstant).write();
        fixture.fold("main", 2, 2).left_out("roshambo/02").write();
        let main = fixture.variant("main");
        assert_eq!(main.results.aggregation, LookAhead::AllRows);
        let warning = &main.warnings()[0];
        assert!(
            warning.contains("fold 1: 0.25 s, same instant"),
            "{warning}"
        );
    }
}
