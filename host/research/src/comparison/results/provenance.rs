//! Where the numbers of a variant come from, and what limits them.

use std::collections::BTreeSet;
use std::path::Path;

use super::evaluated_run::EvaluatedRun;
use super::variant_results::VariantResults;

impl VariantResults {
    /// The source of the numbers in one line: preset, seed, revisions, folds, subjects.
    pub(crate) fn provenance(&self) -> String {
        let config = &self.runs[0].config;
        let revisions: BTreeSet<&str> =
            self.runs.iter().flat_map(EvaluatedRun::revisions).collect();
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
            "`{}`: preset {}, seed {}, revision {}; {} of {} folds; trained on {trained} subjects{start}; {} subjects held out{synthetic}",
            self.name,
            config.preset.name,
            config.preset.seed,
            revisions.join(" and "),
            self.runs.len(),
            self.fold_count(),
            self.merged.held_out.len(),
        )
    }

    /// Limits of the numbers: missing folds, folds that differ, models that were not evaluated everywhere.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let missing = self.missing_folds();
        if !missing.is_empty() {
            let missing: Vec<String> = missing.iter().map(ToString::to_string).collect();
            warnings.push(format!(
                "`{}` has {} of {} folds: {} missing, their subjects are not included",
                self.name,
                self.runs.len(),
                self.fold_count(),
                missing.join(", ")
            ));
        }
        let modes = self.runs.iter().map(|run| run.results.aggregation.name());
        let differ = modes.clone().collect::<BTreeSet<_>>().len() > 1;
        if differ {
            let chosen: Vec<String> = self
                .runs
                .iter()
                .zip(modes)
                .map(|(run, mode)| format!("fold {}: {mode}", run.fold().number))
                .collect();
            warnings.push(format!(
                "`{}`: the folds chose different aggregation modes ({}); shown is `{}`, the paper's",
                self.name,
                chosen.join("; "),
                self.merged.aggregation.name()
            ));
        }
        for model in self.models() {
            let has = |run: &&EvaluatedRun| run.results.published.iter().any(|s| s.model == model);
            let count = self.runs.iter().filter(has).count();
            if count < self.runs.len() {
                warnings.push(format!(
                    "`{}`: {model} was evaluated in {count} of {} folds only",
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
    use crate::comparison::results::fixture::Fixture;
    use myointent::evaluation::LookAhead;

    #[test]
    fn a_missing_fold_is_reported_and_counted() {
        let fixture = Fixture::new();
        fixture.fold("main", 3, 3).held_out("roshambo/03").write();
        fixture.fold("main", 1, 3).held_out("roshambo/01").write();
        let main = fixture.variant("main");
        assert_eq!(main.missing_folds(), [2]);
        assert!(main.provenance().contains("2 of 3 folds"));
        assert!(main.warnings()[0].contains("2 of 3 folds: 2 missing"));
    }

    #[test]
    fn a_model_that_some_folds_lack_is_reported() {
        let fixture = Fixture::new();
        let first = fixture.fold("main", 1, 2).held_out("roshambo/01");
        first.model("LDA", false).write();
        fixture.fold("main", 2, 2).held_out("roshambo/02").write();
        let warnings = fixture.variant("main").warnings();
        assert_eq!(warnings, ["`main`: LDA was evaluated in 1 of 2 folds only"]);
    }

    #[test]
    fn folds_that_chose_different_modes_are_shown_with_the_papers() {
        let fixture = Fixture::new();
        let first = fixture.fold("main", 1, 2).held_out("roshambo/01");
        first.aggregation(LookAhead::SameInstant).write();
        fixture.fold("main", 2, 2).held_out("roshambo/02").write();
        let main = fixture.variant("main");
        assert_eq!(main.merged.aggregation, LookAhead::AllRows);
        let warning = &main.warnings()[0];
        assert!(
            warning.contains("fold 1: 0.25 s, same instant"),
            "{warning}"
        );
    }
}
