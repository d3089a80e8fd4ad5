//! Measurement of one person: a model as it is, and tuned on gestures alone, on other movement too, and on all kinds but the
//! one that is judged.

use burn::tensor::Device;
use shared::model::file::Model;

use super::halves::{Half, Hold, halves, joined};
use evaluation::Measure;
use execution::interrupt::Interrupt;
use recordings::{Library, Recording};
use training::run::personalize::{Person, PersonalizeError, TuningSettings, judge, tune};

/// Measures that are shown, each label at its emission time.
pub(crate) const SHOWN: [Measure; 6] = [
    Measure::BalancedAccuracyEmitted,
    Measure::TransitionAccuracyEmitted,
    Measure::Recognition,
    Measure::Raised,
    Measure::OtherActivations,
    Measure::FalseActivations,
];

/// Values of [`SHOWN`]; none where the recordings lack what is counted.
pub(crate) type Values = [Option<f64>; SHOWN.len()];

/// Material that a model was tuned on.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Variant {
    /// Nothing: the model as it is.
    AsItIs,
    /// Gestures, and this many seconds of other movement, of all kinds; judged with this margin over other movement, or the
    /// tuned file's own.
    Tuned(f64, Option<f32>),
    /// Gestures and all other movement but one kind; judged on that kind, in turn, and averaged.
    Unshown(Option<f32>),
}

/// Settings of the measurement.
pub(crate) struct Measurement<'a> {
    pub(crate) library: &'a Library,
    pub(crate) model: &'a [u8],
    /// Seconds of other movement to tune on.
    pub(crate) amounts: &'a [f64],
    /// Margins over other movement to judge with; none for the tuned file's own.
    pub(crate) margins: &'a [Option<f32>],
    pub(crate) settings: &'a TuningSettings,
    pub(crate) device: Device,
    pub(crate) interrupt: &'a Interrupt,
}

impl Measurement<'_> {
    /// Measures a person (`data-set/person`).
    ///
    /// # Errors
    /// When the model is refused, the person's recordings do not allow it, or the user interrupts.
    pub(crate) fn person(&self, subject: &str) -> Result<Vec<(Variant, Values)>, PersonalizeError> {
        let own = self.library.recordings.iter();
        let own: Vec<&Recording> = own.filter(|own| own.subject == subject).collect();
        let vocabulary = Model::parse(self.model)?.header.dimensions.vocabulary;
        let [first, second] = halves(&own, vocabulary);
        let judged = self.whole(&own, &second.holds(f64::INFINITY, |_| true))?;
        let mut variants = vec![(Variant::AsItIs, values(self.model, &judged)?)];
        for &seconds in [0.0].iter().chain(self.amounts) {
            let file = self.tune(&own, &first.holds(seconds, |_| true))?;
            for &margin in self.margins {
                let values = values(&with_margin(&file, margin)?, &judged)?;
                variants.push((Variant::Tuned(seconds, margin), values));
            }
        }
        if first.others.len() > 1 {
            variants.extend(self.unshown(&own, &first, &second)?);
        }
        Ok(variants)
    }

    /// Mean over the kinds of other movement, each judged by a model that was tuned on the others.
    fn unshown(
        &self,
        own: &[&Recording],
        first: &Half,
        second: &Half,
    ) -> Result<Vec<(Variant, Values)>, PersonalizeError> {
        let mut all = vec![Vec::new(); self.margins.len()];
        for kind in first.others.keys() {
            let file = self.tune(own, &first.holds(f64::INFINITY, |other| other != *kind))?;
            let judged = self.whole(own, &second.holds(f64::INFINITY, |other| other == *kind))?;
            for (all, &margin) in all.iter_mut().zip(self.margins) {
                all.push(values(&with_margin(&file, margin)?, &judged)?);
            }
        }
        let mean = |all: &[Values]| {
            std::array::from_fn(|measure| {
                let values: Option<Vec<f64>> = all.iter().map(|values| values[measure]).collect();
                values.map(|values| values.iter().sum::<f64>() / values.len() as f64)
            })
        };
        let pairs = self.margins.iter().zip(&all);
        Ok(pairs
            .map(|(&margin, all)| (Variant::Unshown(margin), mean(all)))
            .collect())
    }

    fn tune(&self, own: &[&Recording], holds: &[Hold]) -> Result<Vec<u8>, PersonalizeError> {
        let person = self.whole(own, holds)?;
        let (settings, interrupt) = (self.settings, self.interrupt);
        tune(
            self.model,
            &person.whole(),
            settings,
            &self.device,
            interrupt,
            |_, _| (),
        )
    }

    fn whole(&self, own: &[&Recording], holds: &[Hold]) -> Result<Person, PersonalizeError> {
        let model = Model::parse(self.model)?;
        Person::new(&joined(own, holds), None, &model.header)
    }
}

/// Copy of a model file with another margin over other movement.
fn with_margin(file: &[u8], margin: Option<f32>) -> Result<Vec<u8>, PersonalizeError> {
    match margin {
        Some(_) => Ok(Model::with_gate(file, None, margin, None)?),
        None => Ok(file.to_vec()),
    }
}

/// Values of a model file on all recordings of a person.
fn values(file: &[u8], judged: &Person) -> Result<Values, PersonalizeError> {
    let score = judge("", file, &judged.whole())?;
    Ok(SHOWN.map(|measure| measure.mean(&score).map(|own| own.mean)))
}
