//! Values of a description, each refused with the reason where it cannot be used.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use shared::stream::alignment::Alignment;
use shared::units::{CHANNELS, SAMPLE_RATE_HZ};

use super::words::Word;
use crate::readers::table::separator::Separator;

/// A value that can be used; else why it cannot.
fn valid<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    from: D,
    is_valid: impl FnOnce(&T) -> bool,
    why: impl FnOnce(T) -> String,
) -> Result<T, D::Error> {
    let value = T::deserialize(from)?;
    if is_valid(&value) {
        return Ok(value);
    }
    Err(D::Error::custom(why(value)))
}

/// Rows a second; always the armband's.
pub(super) fn rate<'de, D: Deserializer<'de>>(from: D) -> Result<(), D::Error> {
    let is_armbands = |rate: &f64| *rate == f64::from(SAMPLE_RATE_HZ);
    let why = |rate| {
        format!(
            "expected {SAMPLE_RATE_HZ} rows a second, found {rate}: samples that are missing cannot be made, and other \
             devices filter otherwise; record at {SAMPLE_RATE_HZ} Hz"
        )
    };
    valid(from, is_armbands, why).map(drop)
}

/// Scales that have a meaning, from samples of 32 bits to volts of a microvolt each.
const SCALES: std::ops::RangeInclusive<f64> = 1e-9..=1e12;

/// Counts of the armband for a value of 1.
pub(super) fn scale<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let why = |scale: f64| {
        format!(
            "expected the counts of one unit, such as 128 where a file has counts divided by 128, found {scale:?}"
        )
    };
    valid(from, |scale| SCALES.contains(scale), why)
}

/// Scale of counts.
pub(super) const fn counts() -> f64 {
    1.0
}

/// Whether values are magnitudes; never.
pub(super) fn rectified<'de, D: Deserializer<'de>>(from: D) -> Result<(), D::Error> {
    const WHY: &str = "expected samples with their sign, found rectified ones: their waves are lost; record in EMG mode 2 \
                       (filtered, not rectified)";
    valid(from, |rectified: &bool| !rectified, |_| WHY.to_owned()).map(drop)
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
pub(super) fn rotation<'de, D: Deserializer<'de>>(from: D) -> Result<u8, D::Error> {
    let is_place = |places: &i64| (0..CHANNELS as i64).contains(places);
    let why = |places| format!("expected a rotation of 0 to 7 places, found {places}");
    valid(from, is_place, why).map(|places| places as u8)
}

/// Place of the little finger's side where a left arm is mirrored: channel c of the right arm is 6 - c of the left.
const MIRROR: u8 = 6;

/// Order of the channels: c of the common frame is column c + rotation, on the left arm 6 + rotation - c.
pub(super) const fn placement(rotation: u8, arm: Option<Arm>) -> Alignment {
    match arm {
        Some(Arm::Left) => Alignment::new(MIRROR + rotation, true),
        _ => Alignment::new(rotation, false),
    }
}

/// Separator of the columns.
pub(super) fn separator<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Separator>, D::Error> {
    let is_known = |text: &String| Separator::from_name(text).is_some();
    let why = |text| format!("expected \",\", \";\", \"\\t\" or \" \", found {text:?}");
    let text = valid(from, is_known, why)?;
    Ok(Separator::from_name(&text))
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
    type Error = String;

    fn try_from(word: Word) -> Result<Self, String> {
        let at = |number: i64| usize::try_from(number).ok()?.checked_sub(1);
        let found = match word {
            Word::Text(name) => return Ok(Self::Named(name.trim().to_owned())),
            Word::Number(number) => number.to_string(),
            Word::Whole(number) => match at(number) {
                Some(at) => return Ok(Self::At(at)),
                None => number.to_string(),
            },
        };
        Err(format!(
            "expected a column's name, or its number from 1 on, found {found}"
        ))
    }
}

/// Columns of the eight channels.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(try_from = "Vec<Column>")]
pub(super) struct Channels(pub [Column; CHANNELS]);

impl TryFrom<Vec<Column>> for Channels {
    type Error = String;

    fn try_from(columns: Vec<Column>) -> Result<Self, String> {
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
        Err(format!(
            "expected eight different columns, in the order of the armband's channels, all by name or all by number, found {found}"
        ))
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
pub(super) fn cue_lag<'de, D: Deserializer<'de>>(from: D) -> Result<Option<u32>, D::Error> {
    let is_lag = |ms: &i64| (0..=2000).contains(ms);
    let why = |ms| format!("expected 0 to 2000 ms, found {ms}");
    valid(from, is_lag, why).map(|ms| Some(ms as u32))
}
