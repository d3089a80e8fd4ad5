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
use web::said::{Said, chain};

/// Measures that are shown where the recordings have them, with their names; the decision uses all of them.
const SHOWN: [(Measure, &str); 6] = [
    (Measure::BalancedAccuracy, "balanced-accuracy"),
    (Measure::TransitionAccuracy, "transition-accuracy"),
    (Measure::Recognition, "recognised"),
    (Measure::FalseActivations, "at-rest"),
    (Measure::Raised, "raised"),
    (Measure::OtherActivations, "in-others"),
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
        let tell = move |state| drop(inputs.send(Input::Event(Event::Tuning(Box::new(state)))));
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
                Err(error) => report(TuningState::failed(error)),
            }
        };
        tell(running(0, TuningSettings::default().steps));
        let thread = std::thread::Builder::new().name("tuning".to_owned());
        match thread.spawn(work) {
            Ok(thread) => self.tuning = Some(thread),
            Err(error) => tell(TuningState::failed(Said::of_os(&error))),
        }
    }
}

/// State after this many steps.
fn running(steps: usize, of: usize) -> TuningState {
    TuningState {
        state: "running",
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
) -> Result<Personalized, Said> {
    let library = load(folder, &LoadOptions::default()).map_err(Said::plain)?;
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
    .map_err(|error| Said::of("tuning", &error))
}

fn outcome(done: Personalized, out: &Path, next: Vec<String>) -> Outcome {
    let [old, new, _] = &done.scores;
    let mean = |measure: Measure, score| measure.mean(score).map(|own| own.mean);
    let rows = SHOWN.map(|(measure, name)| MeasureRow {
        measure: name,
        before: mean(measure, old),
        after: mean(measure, new),
    });
    let is_known = |row: &MeasureRow| row.before.is_some() || row.after.is_some();
    let doubts = done.doubts.iter();
    let judged = TuningState {
        rows: rows.into_iter().filter(is_known).collect(),
        tuned_seconds: Some(done.tuned_seconds),
        judged_seconds: Some(done.judged_seconds),
        doubts: doubts.map(|doubt| Said::of("doubt", doubt)).collect(),
        ..TuningState::default()
    };
    if let Some(why) = done.worse() {
        let worse = TuningState {
            state: "worse",
            why: Some(Said::of("worse", &why)),
            ..judged
        };
        return (worse, None);
    }
    match write_whole(out, &done.bytes) {
        Ok(()) => {
            let better = TuningState {
                state: "better",
                file: Some(out.display().to_string()),
                commands: next,
                ..judged
            };
            (better, Some(done.bytes))
        }
        Err(error) => (TuningState::failed(Said::plain(chain(&error))), None),
    }
}
