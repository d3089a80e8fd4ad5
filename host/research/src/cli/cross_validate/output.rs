//! Tables of a cross-validation, printed and written.

use std::path::{Path, PathBuf};

use evaluation::report::{Table, recognition};
use evaluation::{CONSTANT, ENERGY, Group, LookAhead};
use execution::run_folder::write_whole;
use presets::OperatingPoint;

use crate::cross_validation::{
    Contender, FoldScore, JobScores, Merged, Origin, daily_life, differences, emission, movements,
    over_sets, people, scores, test_scores,
};

/// Tables of a cross-validation, a row for each person, and a picture.
pub(super) struct Tables {
    tables: Vec<Table>,
    people: Table,
    /// Picture of the gestures recognised by the time since their onset, as SVG.
    picture: Option<String>,
}

impl Tables {
    /// Creates the tables of the development people, then those of the test people, if they were evaluated.
    pub(super) fn new(development: &[Merged<'_>], test: &[Merged<'_>]) -> Self {
        let mut tables = vec![
            scores(development),
            over_sets(development),
            emission(development),
            differences(development),
            movements(development),
            daily_life(development),
        ];
        tables.extend((!test.is_empty()).then(|| test_scores(test)));
        Self {
            tables,
            people: people(development, test),
            picture: picture(development),
        }
    }

    /// Formats all tables for a terminal.
    pub(super) fn plain(&self) -> String {
        let tables: Vec<String> = self.tables.iter().map(Table::plain).collect();
        tables.join("\n")
    }

    /// Writes the tables, a row for each person, seed, fold, preset and mode, and the picture. Returns the paths.
    pub(super) fn write(&self, folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
        let [page, rows] = ["tables.md", "people.csv"].map(|name| folder.join(name));
        let tables: Vec<String> = self.tables.iter().map(Table::markdown).collect();
        write_whole(&page, tables.join("\n").as_bytes())?;
        write_whole(&rows, &self.people.csv()?)?;
        let mut paths = vec![page, rows];
        if let Some(picture) = &self.picture {
            let path = folder.join("recognition.svg");
            write_whole(&path, picture.as_bytes())?;
            paths.push(path);
        }
        Ok(paths)
    }
}

/// Picture of the gestures recognised by the time since their onset, of people who have all classes: by the energy detector,
/// and by labels that use all rows of the look-ahead or none.
fn picture(merged: &[Merged<'_>]) -> Option<String> {
    let curve = |own: &Merged<'_>| {
        let section = (None, Group::AllClasses);
        recognition::curve(own.short_name(), |ms| own.recognised_within(ms, section))
    };
    let is_system = |own: &&Merged<'_>| {
        own.look_ahead != LookAhead::SameInstant && ![CONSTANT, ENERGY].contains(&own.model)
    };
    let systems = merged.iter().filter(is_system).filter_map(curve);
    let energy = merged.iter().find(|own| own.model == ENERGY);
    recognition::svg(systems, energy.and_then(curve))
}

/// Merges the scores of every contender under each operating point and look-ahead, on some of the people. Without
/// look-ahead, only contenders without one are included.
pub(super) fn merged<'a, G: Iterator<Item = Option<OperatingPoint>>>(
    contenders: &'a [Contender],
    results: &'a [Vec<(Origin, JobScores)>],
    gates: impl Fn() -> G,
    people: fn(&JobScores) -> Option<&Vec<FoldScore>>,
) -> Vec<Merged<'a>> {
    let mut merged: Vec<Merged> = Vec::new();
    for (contender, own) in contenders.iter().zip(results) {
        for gate in gates() {
            let of = |look_ahead| {
                let scores = own.iter().flat_map(|(origin, scores)| {
                    let scores = people(scores).into_iter().flatten();
                    scores.map(|score| (*origin, score))
                });
                let merged = Merged::new(contender.name(), look_ahead, gate, scores);
                (!merged.is_empty()).then_some(merged)
            };
            let ahead = [LookAhead::AllRows, LookAhead::SameInstant].map(of);
            let looks_back = ahead.iter().any(Option::is_some);
            merged.extend(ahead.into_iter().flatten());
            if !looks_back {
                merged.extend(of(LookAhead::None));
            }
        }
    }
    merged
}
