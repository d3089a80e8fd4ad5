//! Tuning of the model on the person's recordings, as `myointent personalize` does it, on a thread of its own.

use std::path::Path;

use super::{Keeper, free_path};
use crate::live::stream::Input;
use evaluation::Measure;
use execution::interrupt::Interrupt;
use execution::run_folder::write_whole;
use recordings::{LoadOptions, load};
use training::run::personalize::{Personalized, TuningSettings, personalize};
use web::event::Event;
use web::outcome::{MeasureRow, TuningState};

/// Measures that are shown where the recordings have them; the decision uses all of them.
const SHOWN: [(Measure, &str); 6] = [
    (Measure::BalancedAccuracy, "balanced accuracy"),
    (Measure::TransitionAccuracy, "transition accuracy"),
    (Measure::Recognition, "gestures recognised"),
    (Measure::FalseActivations, "false activations a minute"),
    (Measure::Raised, "other movements that raise a label"),
    (
        Measure::OtherActivations,
        "labels a minute of other movement",
    ),
];

/// Message for viewers, and the model file if it is kept.
type Outcome = (TuningState, Option<Vec<u8>>);

impl Keeper {
    /// Starts the tuning thread, unless one runs. It tells its progress and result.
    pub(super) fn tune(&mut self) {
        if self
            .tuning
            .as_ref()
            .is_some_and(|thread| !thread.is_finished())
        {
            return;
        }
        let (folder, model) = (self.folder.clone(), self.model.clone());
        let device = self.options.device.clone();
        let out = free_path(&folder, &self.options.person);
        let next = vec![
            self.install_command(&out),
            format!("myointent live {} --model {}", self.option, out.display()),
        ];
        let inputs = self.inputs.clone();
        // An engine that has ended needs nothing.
        let tell = move |state| drop(inputs.send(Input::Event(Event::Tuning(state))));
        let (inputs, report) = (self.inputs.clone(), tell.clone());
        let work = move || {
            let steps = |step, of| report(running(step, of));
            match tune(&model, &folder, &device, steps) {
                Ok(done) => {
                    let (state, tuned) = outcome(done, &out, next);
                    if let Some(tuned) = tuned {
                        let _ = inputs.send(Input::Tuned(tuned));
                    }
                    report(state);
                }
                Err(error) => report(failed(error)),
            }
        };
        tell(running(0, TuningSettings::default().steps));
        let thread = std::thread::Builder::new().name("tuning".to_owned());
        match thread.spawn(work) {
            Ok(thread) => self.tuning = Some(thread),
            Err(error) => tell(failed(error.to_string())),
        }
    }
}

/// State after this many steps.
fn running(steps: usize, of: usize) -> TuningState {
    let text = if steps == of {
        "both models are judged on what was held back"
    } else {
        "on all of this person's recordings"
    };
    TuningState {
        state: "running",
        text: text.to_owned(),
        steps,
        of,
        ..TuningState::default()
    }
}

fn tune(
    model: &[u8],
    folder: &Path,
    device: &training::backend::Device,
    report: impl FnMut(usize, usize),
) -> Result<Personalized, String> {
    let library = load(folder, &LoadOptions::default()).map_err(|error| error.to_string())?;
    let settings = TuningSettings::default();
    personalize(
        model,
        &library,
        None,
        &settings,
        device,
        &Interrupt::default(),
        report,
    )
    .map_err(|error| error.to_string())
}

fn failed(text: String) -> TuningState {
    TuningState {
        state: "failed",
        text,
        ..TuningState::default()
    }
}

fn outcome(done: Personalized, out: &Path, next: Vec<String>) -> Outcome {
    let [old, new, _] = &done.scores;
    let mean = |measure: Measure, score| measure.mean(score).map(|own| own.mean);
    let rows = SHOWN.map(|(measure, name)| MeasureRow {
        measure: name,
        before: mean(measure, old),
        after: mean(measure, new),
    });
    let of = |measure| mean(measure, old).zip(mean(measure, new));
    let judged_on = format!(
        "Judged on the {:.0} s held back, after {:.0} s to tune on.",
        done.judged_seconds, done.tuned_seconds
    );
    let mut sentences = vec![judged_on];
    sentences.extend(halves(
        of(Measure::Recognition),
        of(Measure::OtherActivations),
    ));
    let is_known = |row: &MeasureRow| row.before.is_some() || row.after.is_some();
    let judged = TuningState {
        rows: rows.into_iter().filter(is_known).collect(),
        ..TuningState::default()
    };
    let doubt = Some(done.doubt.clone()).filter(|doubt| !doubt.is_empty());
    let doubt = doubt.map(|doubt| format!("{doubt}."));
    if let Some(why) = done.worse() {
        sentences.insert(0, format!("{why}."));
        sentences.push("Nothing is written; more recordings may help.".to_owned());
        sentences.extend(doubt);
        let worse = TuningState {
            state: "worse",
            text: sentences.join(" "),
            ..judged
        };
        return (worse, None);
    }
    match write_whole(out, &done.bytes) {
        Ok(()) => {
            sentences.push(format!("It is in {}.", out.display()));
            sentences.extend(doubt);
            let better = TuningState {
                state: "better",
                text: sentences.join(" "),
                commands: next,
                ..judged
            };
            (better, Some(done.bytes))
        }
        Err(error) => (failed(error.to_string()), None),
    }
}

/// Sentences about what is meant and what is not, before and after, as far as the recordings have either.
fn halves(recognised: Option<(f64, f64)>, raised: Option<(f64, f64)>) -> Vec<String> {
    let recognised = recognised.map(|(before, after)| {
        let percent = |share: f64| 100.0 * share;
        format!(
            "Of the gestures {:.0} % are recognised, before {:.0} %.",
            percent(after),
            percent(before)
        )
    });
    let raised = raised.map(|(before, after)| {
        format!(
            "A minute of movement that means nothing raises {after:.1} labels, before {before:.1}."
        )
    });
    recognised.into_iter().chain(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::halves;

    #[test]
    fn what_is_meant_and_what_is_not_have_a_sentence_each() {
        assert_eq!(
            halves(Some((0.875, 1.0)), Some((12.0, 2.54))),
            [
                "Of the gestures 100 % are recognised, before 88 %.",
                "A minute of movement that means nothing raises 2.5 labels, before 12.0.",
            ]
        );
        assert_eq!(halves(None, None), [""; 0]);
    }
}
