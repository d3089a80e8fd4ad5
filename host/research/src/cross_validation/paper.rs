//! Tables in the paper's form: mean (sample deviation) over people, without look-ahead and with 0.25 s.

use evaluation::metric::offset;
use evaluation::report::Table;
use evaluation::report::cell;
use evaluation::{Group, LookAhead, Measure};
use recordings::statistics::MeanSd;

use super::merged::{Merged, Section};
use super::teacher::{PaperTeacher, TARGET};

/// Measures of a table of accuracies; raw accuracy and TA are the paper's.
const ACCURACIES: [Measure; 3] = [
    Measure::RawAccuracy,
    Measure::BalancedAccuracy,
    Measure::TransitionAccuracy,
];
/// Measures of TA, by the width of its buffer.
const BUFFERS: [Measure; 3] = [
    Measure::TransitionAccuracyNarrow,
    Measure::TransitionAccuracyMiddle,
    Measure::TransitionAccuracy,
];
/// Look-aheads of the paper's tables.
const LOOK_AHEADS: [LookAhead; 2] = [LookAhead::None, LookAhead::AllRows];

/// Row of a table: its label, and the name of the model.
type Row<'a> = (&'a str, &'a str);

/// Makes the tables whose models are available. `window` is the window of the preset's teacher, in samples.
pub(crate) fn paper_tables(merged: &[Merged<'_>], window: usize) -> Vec<Table> {
    let page = Page { merged };
    let models = page.models();
    let window = window.to_string();
    let windows = [
        ("100", PaperTeacher::Window100.name()),
        ("300", PaperTeacher::Window300.name()),
        (window.as_str(), PaperTeacher::Whole.name()),
    ];
    let training = [
        ("target only", PaperTeacher::Scratch.name()),
        ("pre-trained", PaperTeacher::PreTrained.name()),
        ("pre-trained, fine-tuned", PaperTeacher::FineTuned.name()),
        ("pre-trained, LoRA", PaperTeacher::Lora.name()),
    ];
    let target = TARGET.name();
    let mut tables = vec![
        page.table(
            "Main result. Mean (sample deviation) over people; labels compensated for their lag; look-ahead 0 and 0.25 s, all rows",
            "model",
            &models,
            ACCURACIES,
            None,
        ),
        page.offsets(&models),
        page.table(
            &format!("Pre-training: the teacher on {target}, trained on {target} alone, on all other sets, or on these and then {target}"),
            "training",
            &training,
            ACCURACIES,
            Some(target),
        ),
        page.table("Window of the teacher, in samples of 5 ms", "window", &windows, ACCURACIES, None),
        page.table("TA by the buffer around a transition, in samples of 5 ms; TA without a number: 200", "model", &models, BUFFERS, None),
        page.look_aheads(&models),
    ];
    tables.retain(|table| !table.rows.is_empty());
    tables
}

/// Scores of the paper's tables.
struct Page<'m, 'a> {
    merged: &'m [Merged<'a>],
}

impl<'a> Page<'_, 'a> {
    fn at(&self, model: &str, look_ahead: LookAhead) -> Option<&Merged<'a>> {
        let mut merged = self.merged.iter();
        merged.find(|own| own.model == model && own.look_ahead == look_ahead)
    }

    /// Rows for every model but the variants of the teacher, in their order.
    fn models(&self) -> Vec<Row<'a>> {
        let mut models: Vec<Row> = Vec::new();
        let is_variant = |model: &str| PaperTeacher::ALL[1..].iter().any(|own| own.name() == model);
        for own in self.merged {
            let row = (own.model, own.model);
            if !is_variant(own.model) && !models.contains(&row) {
                models.push(row);
            }
        }
        models
    }

    /// Table with a row for each model and group of people, `measures` at either look-ahead; only of one data set, if it is
    /// given.
    fn table(
        &self,
        caption: &str,
        what: &str,
        rows: &[Row<'_>],
        measures: [Measure; 3],
        data_set: Option<&str>,
    ) -> Table {
        let columns = ["0", "0.25 s"]
            .into_iter()
            .flat_map(|ahead| measures.map(|measure| format!("{}, {ahead}", measure.name())));
        let start = ["classes", what].map(str::to_owned).into_iter();
        let end = ["people / transitions".to_owned()];
        let mut table = Table::new(caption, start.chain(columns).chain(end));
        for group in Group::ALL {
            let section = (data_set, group);
            for (label, model) in rows {
                let both = LOOK_AHEADS.map(|look_ahead| self.at(model, look_ahead));
                let Some(any) = both.into_iter().flatten().next() else {
                    continue;
                };
                let people = any.people(section).len();
                if people == 0 {
                    continue;
                }
                let cells = both
                    .into_iter()
                    .flat_map(|own| measures.map(|measure| share(own, measure, section, people)));
                let names = [group.name(any.classes()), (*label).to_owned()];
                let (_, transitions) = any.offsets(section);
                let support = [cell::support(people, transitions)];
                table.push(names.into_iter().chain(cells).chain(support));
            }
        }
        table
    }

    /// Table of the offsets of followed transitions, over all people together.
    fn offsets(&self, rows: &[Row<'_>]) -> Table {
        let caption = "Prediction offsets in ms, of the transitions that are followed, each label at its reference time: mean (sample \
            deviation) over transitions";
        let columns = [
            "classes",
            "model",
            "look-ahead",
            "absolute",
            "median",
            "signed",
            "median signed",
            "followed / transitions",
        ];
        let mut table = Table::new(caption, columns);
        for group in Group::ALL {
            for (label, model) in rows {
                for own in LOOK_AHEADS.iter().filter_map(|at| self.at(model, *at)) {
                    let (offsets, transitions) = own.offsets((None, group));
                    if transitions == 0 {
                        continue;
                    }
                    let of = offset::summary(&offsets);
                    table.push([
                        group.name(own.classes()),
                        (*label).to_owned(),
                        own.look_ahead.name().to_owned(),
                        cell::absolute_ms(of.map(|of| of.absolute)),
                        of.map_or_else(cell::none, |of| format!("{:.0}", of.absolute_median)),
                        cell::signed_ms(of.map(|of| of.signed)),
                        cell::one_ms(of.map(|of| of.signed_median)),
                        cell::support(offsets.len(), transitions),
                    ]);
                }
            }
        }
        table
    }

    /// Table of every look-ahead and aggregation mode, for the models that look back.
    fn look_aheads(&self, rows: &[Row<'_>]) -> Table {
        let caption = "Look-ahead, and which rows of the later windows are summed; latency from the muscle's onset to the emitted \
            label, median / 90 %, in ms";
        let start = ["classes", "model", "look-ahead"].into_iter();
        let columns = start
            .chain(ACCURACIES.map(Measure::name))
            .chain(["latency", "people"]);
        let mut table = Table::new(caption, columns);
        let looks_back = |model: &str| self.at(model, LookAhead::AllRows).is_some();
        for group in Group::ALL {
            let section = (None, group);
            for (label, model) in rows.iter().filter(|(_, model)| looks_back(model)) {
                for own in LookAhead::ALL.iter().filter_map(|at| self.at(model, *at)) {
                    let people = own.people(section).len();
                    if people == 0 {
                        continue;
                    }
                    let names = [
                        group.name(own.classes()),
                        (*label).to_owned(),
                        own.look_ahead.name().to_owned(),
                    ];
                    let cells =
                        ACCURACIES.map(|measure| share(Some(own), measure, section, people));
                    let end = [cell::latency(own.latency(section)), people.to_string()];
                    table.push(names.into_iter().chain(cells).chain(end));
                }
            }
        }
        table
    }
}

/// Formats the mean (sample deviation) over the people of a section.
fn share(
    own: Option<&Merged<'_>>,
    measure: Measure,
    section: Section<'_>,
    people: usize,
) -> String {
    let numbers = own.map_or_else(Vec::new, |own| own.numbers(measure, section));
    cell::of_people(cell::share(MeanSd::of(&numbers)), numbers.len(), people)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cross_validation::fixture::{fold, origin};

    #[test]
    fn a_row_is_a_mean_and_deviation_over_the_people_of_all_folds() {
        let folds = [
            fold("teacher", &[("x/a", 0.5, &[-20, 0, 10], 4)]),
            fold("teacher", &[("x/b", 0.7, &[20], 1)]),
        ];
        let scores = || {
            let all = folds.iter().zip(1..);
            all.flat_map(|(own, number)| own.iter().map(move |score| (origin(1, number), score)))
        };
        let merged =
            LookAhead::ALL.map(|look_ahead| Merged::new("teacher", look_ahead, None, scores()));
        let tables = paper_tables(&merged, 600);
        let [main, offsets, windows, buffers, look_aheads] = &tables[..] else {
            panic!("{tables:?}");
        };
        let share = ["0.600 (0.14)", "0.600 (0.14)", "0.875 (0.18)"];
        assert_eq!(main.rows.len(), 1);
        assert_eq!(main.rows[0][..2], ["all 3", "teacher"]);
        assert_eq!(main.rows[0][2..5], share);
        assert_eq!(main.rows[0][5..8], share);
        assert_eq!(main.rows[0][8], "2 / 5");
        // Computed by hand: -100, 0, 50 and 100 ms.
        assert_eq!(
            offsets.rows[0],
            [
                "all 3", "teacher", "0", "63 (48)", "75", "+13 (85)", "+25", "4 / 5"
            ]
        );
        assert_eq!(windows.rows[0][..2], ["all 3", "600"]);
        assert_eq!(buffers.rows[0][2..5], [share[2]; 3]);
        assert_eq!(look_aheads.rows.len(), 3);
    }
}
