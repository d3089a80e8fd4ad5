//! Values of a description, each refused with the reason where it cannot be used.

use serde::Deserialize;
use shared::stream::alignment::Alignment;
use shared::units::{CHANNELS, SAMPLE_RATE_HZ};

use super::words::Word;
use crate::readers::table::separator::Separator;

/// Reason why a value cannot be used.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub(super) enum ValueError {
    /// Another rate than the armband's.
    #[error(
        "expected {SAMPLE_RATE_HZ} rows a second, found {0}: samples that are missing cannot be made, and other devices \
         filter otherwise; record at {SAMPLE_RATE_HZ} Hz"
    )]
    Rate(f64),
    /// A scale that makes no counts.
    #[error(
        "expected the counts of one unit, such as 128 where a file has counts divided by 128, found {0:?}"
    )]
    Scale(f64),
    /// Rectified samples.
    #[error(
        "expected samples with their sign, found rectified ones: their waves are lost; record in EMG mode 2 (filtered, \
         not rectified)"
    )]
    Rectified,
    /// A rotation that does not exist.
    #[error("expected a rotation of 0 to 7 places, found {0}")]
    Rotation(i64),
    /// A separator that does not exist.
    #[error("expected \",\", \";\", \"\\t\" or \" \", found {0:?}")]
    Separator(String),
    /// Column 0, or a fraction or negative number.
    #[error("expected a column's name, or its number from 1 on, found {0}")]
    Column(f64),
    /// Another number of channels than eight, or one of them twice.
    #[error(
        "expected eight different columns, in the order of the armband's channels, all by name or all by number, found {0}"
    )]
    Channels(String),
    /// A lag out of range.
    #[error("expected 0 to 2000 ms, found {0}")]
    Lag(i64),
}

/// Rows a second; always the armband's.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Rate;

impl TryFrom<f64> for Rate {
    type Error = ValueError;

    fn try_from(rate: f64) -> Result<Self, ValueError> {
        let armband = f64::from(SAMPLE_RATE_HZ);
        (rate == armband)
            .then_some(Self)
            .ok_or(ValueError::Rate(rate))
    }
}

/// Scales that have a meaning, from samples of 32 bits to volts of a microvolt each.
const SCALES: std::ops::RangeInclusive<f64> = 1e-9..=1e12;

/// Counts of the armband for a value of 1.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Scale(pub f64);

impl Default for Scale {
    fn default() -> Self {
        Self(1.0)
    }
}

impl TryFrom<f64> for Scale {
    type Error = ValueError;

    fn try_from(scale: f64) -> Result<Self, ValueError> {
        SCALES
            .contains(&scale)
            .then_some(Self(scale))
            .ok_or(ValueError::Scale(scale))
    }
}

/// Whether values are magnitudes; never.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(try_from = "bool")]
pub(super) struct Rectified;

impl TryFrom<bool> for Rectified {
    type Error = ValueError;

    fn try_from(is_rectified: bool) -> Result<Self, ValueError> {
        (!is_rectified).then_some(Self).ok_or(ValueError::Rectified)
    }
}

/// Arm that the armband is worn on.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Arm {
    /// Right arm, as in the published sets.
    Right,
    /// Left arm: mirrored.
    Left,
}

/// Places by which the armband is turned.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(try_from = "i64")]
pub(super) struct Rotation(u8);

impl TryFrom<i64> for Rotation {
    type Error = ValueError;

    fn try_from(places: i64) -> Result<Self, ValueError> {
        let own = u8::try_from(places)
            .ok()
            .filter(|own| usize::from(*own) < CHANNELS);
        own.map(Self).ok_or(ValueError::Rotation(places))
    }
}

/// Place of the little finger's side where a left arm is mirrored: channel c of the right arm is 6 - c of the left.
const MIRROR: u8 = 6;

impl Rotation {
    /// Order of the channels: c of the common frame is column c + rotation, on the left arm 6 + rotation - c.
    pub const fn placement(self, arm: Option<Arm>) -> Alignment {
        match arm {
            Some(Arm::Left) => Alignment::new(MIRROR + self.0, true),
            _ => Alignment::new(self.0, false),
        }
    }
}

/// Separator of the columns.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize)]
#[serde(try_from = "String")]
pub(super) struct Mark(pub Separator);

impl TryFrom<String> for Mark {
    type Error = ValueError;

    fn try_from(text: String) -> Result<Self, ValueError> {
        let mut known = Separator::TEXTS.into_iter();
        let found = known.find(|(_, own)| *own == text);
        found.map_or(Err(ValueError::Separator(text)), |(own, _)| Ok(Self(own)))
    }
}

/// Column of a table.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Deserialize)]
#[serde(try_from = "Word")]
pub(super) enum Column {
    /// Position, 0 first. Files count from 1.
    At(usize),
    /// Name in the header.
    Named(String),
}

impl TryFrom<Word> for Column {
    type Error = ValueError;

    fn try_from(word: Word) -> Result<Self, ValueError> {
        match word {
            Word::Text(name) => Ok(Self::Named(name.trim().to_owned())),
            Word::Number(number) => Err(ValueError::Column(number)),
            Word::Whole(number) => {
                let at = usize::try_from(number)
                    .ok()
                    .and_then(|number| number.checked_sub(1));
                at.map(Self::At).ok_or(ValueError::Column(number as f64))
            }
        }
    }
}

/// Columns of the eight channels.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(try_from = "Vec<Column>")]
pub(super) struct Channels(pub [Column; CHANNELS]);

impl TryFrom<Vec<Column>> for Channels {
    type Error = ValueError;

    fn try_from(columns: Vec<Column>) -> Result<Self, ValueError> {
        let count = columns.len();
        let is_name = |column: &Column| matches!(column, Column::Named(_));
        let mut distinct = columns.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let found = match columns.iter().filter(|column| is_name(column)).count() {
            _ if count != CHANNELS => format!("{count} columns"),
            _ if distinct.len() < count => "one of them twice".to_owned(),
            names if names != 0 && names != count => "names and numbers".to_owned(),
            _ => match columns.try_into() {
                Ok(columns) => return Ok(Self(columns)),
                Err(_) => format!("{count} columns"),
            },
        };
        Err(ValueError::Channels(found))
    }
}

/// Time that the labels stand at.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum LabelTiming {
    /// Cues, which the muscle follows. Also holds of whole files.
    #[default]
    Cues,
    /// The muscle's own activity.
    Muscle,
    /// Unknown times, found in the muscle's activity: one gesture a file.
    FromActivity,
}

/// Lag of the muscle after the cues, in ms.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize)]
#[serde(try_from = "i64")]
pub(super) struct CueLag(pub u32);

impl TryFrom<i64> for CueLag {
    type Error = ValueError;

    fn try_from(ms: i64) -> Result<Self, ValueError> {
        let own = u32::try_from(ms).ok().filter(|own| *own <= 2000);
        own.map(Self).ok_or(ValueError::Lag(ms))
    }
}
