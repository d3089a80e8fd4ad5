//! The header as a postcard message.

use core::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::error::ModelError;
use super::header::{Header, List, Provenance, SmootherDefaults};
use super::names::Excerpt;
use super::wire_aggregation::WireAggregation;
use crate::intent::{MAX_CLASSES, Vocabulary};
use crate::model::dimensions::{
    Companding, Dimensions, HEADS, MAX_LAYERS, MAX_SPAN, MAX_WIDTH, MIN_WIDTH, patches_needed,
};
use crate::stream::alignment::Template;
use crate::stream::preprocess::{DIVISOR, Median, Preprocessing};
use crate::stream::smoother::{Early, Margins};
use crate::units::{
    LOOK_AHEAD, LOOK_BACK, MAX_ENTRY_MARGIN, MAX_HOLD, PATCH, SAMPLE_RATE_HZ, WINDOW_PATCHES,
};

/// The fields in the order of docs/model-file.md. Numbers are unchecked: each has its own error.
#[derive(Serialize, Deserialize)]
pub(super) struct WireHeader<'m> {
    pub width: u16,
    pub heads: u8,
    pub layers: u8,
    pub span: u8,
    pub patch: u8,
    pub look_back: u8,
    pub classes: u8,
    pub companding: u8,
    #[serde(borrow)]
    pub class_names: &'m [u8],
    pub sample_rate_hz: u32,
    pub median_width: u8,
    pub divisor: u8,
    pub normalized: bool,
    pub aggregation: WireAggregation,
    pub look_ahead: u16,
    pub hold: u16,
    pub entry_margins: [f32; MAX_CLASSES],
    pub other_margin: Option<f32>,
    pub template: &'m [u8],
    pub data_sets: &'m [u8],
    pub subjects_seen: &'m [u8],
    pub subjects_left_out: &'m [u8],
    pub git_revision: &'m str,
    pub seed: u64,
    pub metrics: &'m [u8],
}

impl<'m> WireHeader<'m> {
    /// Checks every field and returns the header.
    pub fn interpret(self) -> Result<Header<'m>, ModelError> {
        let dimensions = self.dimensions()?;
        within("companding", self.companding.into(), 0..=1)?;
        let companding = match self.companding {
            0 => Companding::Linear,
            _ => Companding::SquareRoot,
        };
        self.check_class_names(dimensions.vocabulary)?;
        exactly(
            "sample rate",
            self.sample_rate_hz as usize,
            SAMPLE_RATE_HZ as usize,
        )?;
        let median = Median::of_width(self.median_width).ok_or(ModelError::MedianWidth {
            found: self.median_width,
        })?;
        exactly("divisor", self.divisor.into(), DIVISOR.into())?;
        Ok(Header {
            dimensions,
            companding,
            preprocessing: Preprocessing {
                normalized: self.normalized,
                median,
            },
            smoother: self.smoother()?,
            template: self.template()?,
            provenance: Provenance {
                data_sets: List::read(self.data_sets, "data_sets")?,
                subjects_seen: List::read(self.subjects_seen, "subjects_seen")?,
                subjects_left_out: List::read(self.subjects_left_out, "subjects_left_out")?,
                git_revision: self.git_revision,
                seed: self.seed,
                metrics: self.metrics()?,
            },
        })
    }

    fn template(&self) -> Result<Option<Template>, ModelError> {
        if self.template.is_empty() {
            return Ok(None);
        }
        Ok(Some(Template::from_bytes(self.template)?))
    }

    fn metrics(&self) -> Result<List<'m, (&'m str, f32)>, ModelError> {
        let metrics = List::<(&str, f32)>::read(self.metrics, "metrics")?;
        match metrics.iter().find(|(_, value)| !value.is_finite()) {
            None => Ok(metrics),
            Some((_, found)) => Err(ModelError::Metric { found }),
        }
    }

    fn dimensions(&self) -> Result<Dimensions, ModelError> {
        let [width, heads, layers] = [
            usize::from(self.width),
            self.heads.into(),
            self.layers.into(),
        ];
        let [span, patch, look_back] = [self.span, self.patch, self.look_back].map(usize::from);
        if !(MIN_WIDTH..=MAX_WIDTH).contains(&width) || !width.is_multiple_of(8) {
            return Err(ModelError::Width { found: width });
        }
        exactly("attention heads", heads, HEADS)?;
        within("layers", layers, 1..=MAX_LAYERS)?;
        within("attention span", span, 1..=MAX_SPAN)?;
        let seen = patches_needed(layers, span);
        if seen > WINDOW_PATCHES {
            return Err(ModelError::ReceptiveField { found: seen });
        }
        exactly("samples of a patch", patch, PATCH)?;
        exactly("look-back rows", look_back, LOOK_BACK)?;
        let classes = usize::from(self.classes);
        let vocabulary =
            Vocabulary::with_classes(classes).ok_or(ModelError::Classes { found: classes })?;
        Ok(Dimensions {
            width,
            layers,
            span,
            vocabulary,
            other: self.other_margin.is_some(),
        })
    }

    fn check_class_names(&self, vocabulary: Vocabulary) -> Result<(), ModelError> {
        let names = List::<&str>::read(self.class_names, "class_names")?;
        let [expected, found] = [vocabulary.classes(), names.iter().count()];
        if expected != found {
            return Err(ModelError::ClassCount { expected, found });
        }
        for (intent, found) in vocabulary.intents().iter().zip(names.iter()) {
            if found != intent.name() {
                return Err(ModelError::ClassName {
                    class: intent.class(),
                    expected: intent.name(),
                    found: Excerpt::of(found),
                });
            }
        }
        Ok(())
    }

    fn smoother(&self) -> Result<SmootherDefaults, ModelError> {
        let (aggregation, early) = self.aggregation.interpret();
        let [look_ahead, hold] = [self.look_ahead, self.hold].map(usize::from);
        // In whole patches.
        within("look-ahead", look_ahead, 0..=LOOK_AHEAD)?;
        within("hold", hold, PATCH..=MAX_HOLD)?;
        exactly(
            "samples beyond a patch",
            (look_ahead % PATCH).max(hold % PATCH),
            0,
        )?;
        let [_, entry, rest @ ..] = self.entry_margins;
        let valid = |margin: &f32| (0.0..=MAX_ENTRY_MARGIN).contains(margin);
        if let Some(found) = rest
            .into_iter()
            .chain([entry])
            .find(|margin| *margin != entry || !valid(margin))
        {
            return Err(ModelError::EntryMargin { found });
        }
        let wild = |margin: &f32| !(-MAX_ENTRY_MARGIN..=MAX_ENTRY_MARGIN).contains(margin);
        if let Some(found) = self.other_margin.filter(wild) {
            return Err(ModelError::OtherMargin { found });
        }
        let early = match early {
            None => None,
            Some([entry, other, relax, leave, caution]) => {
                let margins = [
                    (entry, valid(&entry)),
                    (other, valid(&other)),
                    (relax, relax == Early::RELAX),
                    (leave, leave == Early::LEAVE),
                    (caution, valid(&caution)),
                ];
                if let Some((found, _)) = margins.into_iter().find(|(_, is_valid)| !is_valid) {
                    return Err(ModelError::EarlyMargin { found });
                }
                Some(Early {
                    entry,
                    other,
                    caution,
                })
            }
        };
        Ok(SmootherDefaults {
            aggregation,
            look_ahead,
            hold,
            margins: Margins {
                entry,
                other: self.other_margin,
                early,
            },
        })
    }
}

/// Refuses a number outside of its range.
fn within(
    what: &'static str,
    found: usize,
    range: RangeInclusive<usize>,
) -> Result<(), ModelError> {
    let (least, most) = range.into_inner();
    if (least..=most).contains(&found) {
        Ok(())
    } else {
        Err(ModelError::OutOfRange {
            what,
            found,
            least,
            most,
        })
    }
}

/// Refuses any number but one.
fn exactly(what: &'static str, found: usize, expected: usize) -> Result<(), ModelError> {
    within(what, found, expected..=expected)
}
