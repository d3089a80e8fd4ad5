//! Gain of tuning a model on a person's own recordings, by their duration, for people whom the model has never seen.
//!
//! A person is measured with the shipped model, and with models tuned and calibrated on the first seconds of one half of the
//! recordings, all on the other half.

mod tables;

use burn::tensor::Device;
use serde::{Deserialize, Serialize};
use shared::model::file::Model;

use evaluation::calibration::calibrate_on;
use evaluation::{EvaluationError, Measure, Score};
use execution::fingerprint::Fingerprint;
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::RunFolder;
use recordings::Library;
use training::run::personalize::{
    PersonPart, PersonRecordings, PersonalizeError, TuningSettings, judge, tune,
};

pub(crate) use self::tables::{curves, people};
use crate::job::JobError;

/// Measures that are kept, in this order.
pub(crate) const MEASURES: [Measure; 5] = [
    Measure::BalancedAccuracyEmitted,
    Measure::TransitionAccuracyEmitted,
    Measure::Recognition,
    Measure::FalseActivations,
    Measure::Raised,
];

/// Values of [`MEASURES`]; none where the recordings lack what is counted.
pub(crate) type Values = [Option<f64>; MEASURES.len()];

pub(crate) struct Measurement<'a> {
    /// Folder with a file for each person.
    pub(crate) folder: &'a RunFolder,
    pub(crate) library: &'a Library,
    /// Amounts to learn from, in seconds; infinity for all of the part.
    pub(crate) amounts: &'a [f64],
    pub(crate) device: Device,
    pub(crate) interrupt: &'a Interrupt,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Measured {
    pub(crate) subject: String,
    /// Group of the person, by the classes in the part that all models are judged on, as in tables: `all 3`, `fewer`.
    pub(crate) group: String,
    /// Seconds of the part that all models are judged on.
    pub(crate) judged_seconds: f64,
    /// Values of the original model.
    pub(crate) before: Values,
    /// Result for each amount; none where the recordings are shorter.
    pub(crate) amounts: Vec<Option<Amount>>,
}

/// Results of what is learnt from the first seconds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Amount {
    /// Values of the model tuned on all of this amount.
    pub(crate) tuned: Values,
    /// Values after `calibrate` on all of this amount, with the old head where it keeps it; none with too few holds.
    pub(crate) calibrated: Option<Values>,
}

impl Measurement<'_> {
    /// Measures a person with a model, or loads an earlier measurement; none if the recordings do not allow it.
    pub(crate) fn person(&self, model: &[u8], subject: &str) -> Result<Option<Measured>, JobError> {
        let header = Model::parse(model).map_err(PersonalizeError::from)?.header;
        let found = PersonRecordings::new(self.library, Some(subject), &header);
        let found = found.and_then(|person| {
            person.whole().halves()?;
            Ok(person)
        });
        let person = match found {
            Ok(person) => person,
            Err(error) => {
                progress::log(&format!("{subject}: left out, {error}"));
                return Ok(None);
            }
        };
        let name = format!("{}.json", subject.replace('/', "-"));
        let made_from = self.made_from(model, &person.whole());
        if let Ok(kept) = self.folder.load_stamped::<Measured>(&name, made_from) {
            return Ok(Some(kept));
        }
        let measured = self.measure(model, &person)?;
        self.folder.save_stamped(&name, made_from, &measured)?;
        progress::log(&format!("{subject}: measured"));
        Ok(Some(measured))
    }

    fn measure(
        &self,
        model: &[u8],
        person: &PersonRecordings,
    ) -> Result<Measured, PersonalizeError> {
        let (pool, judged) = person.whole().halves()?;
        let shipped = judge("", model, &judged)?;
        let values = |file: &[u8]| judge("", file, &judged).map(|score| values(&score));
        let settings = TuningSettings::default();
        let before = self::values(&shipped);
        let amount = |seconds: f64| {
            let part = if seconds.is_finite() {
                pool.first(seconds)
            } else {
                pool.clone()
            };
            // A slightly shorter part counts as well.
            if seconds.is_finite() && part.seconds() < 0.95 * seconds {
                return Ok(None);
            }
            let tuned = tune(
                model,
                &part,
                &settings,
                &self.device,
                self.interrupt,
                |_, _| (),
            );
            let file = match tuned {
                Ok(file) => file,
                // A few seconds may have no change to learn from.
                Err(PersonalizeError::NoChange) => return Ok(None),
                Err(error) => return Err(error),
            };
            let recordings = part.evaluated_recordings();
            let calibrated = match calibrate_on(model, person.subject(), &recordings, true, false) {
                Ok(own) => Some(own.file.map_or(Ok(before), |file| values(&file))?),
                Err(EvaluationError::FewRounds(_) | EvaluationError::NotCalibrated { .. }) => None,
                Err(error) => return Err(error.into()),
            };
            Ok(Some(Amount {
                tuned: values(&file)?,
                calibrated,
            }))
        };
        let amounts: Result<_, PersonalizeError> =
            self.amounts.iter().copied().map(amount).collect();
        Ok(Measured {
            subject: person.subject().to_owned(),
            group: shipped.people.name(shipped.classes),
            judged_seconds: judged.seconds(),
            before,
            amounts: amounts?,
        })
    }

    /// Fingerprint of all that a person's values depend on.
    fn made_from(&self, model: &[u8], whole: &PersonPart<'_>) -> Fingerprint {
        let recordings: Vec<_> = whole
            .evaluated_recordings()
            .into_iter()
            .map(|recording| {
                let samples = recording.raw.iter().flatten();
                let samples: Vec<u8> = samples.map(|value| value.cast_unsigned()).collect();
                let labels = recording.lag_compensated.iter();
                let labels: Vec<u8> = labels
                    .map(|label| label.map_or(u8::MAX, |intent| intent as u8))
                    .collect();
                [samples, labels].map(|bytes| Fingerprint::of_bytes(&bytes))
            })
            .collect();
        let model = Fingerprint::of_bytes(model);
        Fingerprint::of(&(
            model,
            recordings,
            self.amounts,
            TuningSettings::default(),
            MEASURES.map(Measure::name),
        ))
    }
}

fn values(score: &Score) -> Values {
    MEASURES.map(|measure| measure.mean(score).map(|own| own.mean))
}
