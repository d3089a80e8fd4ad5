//! Columns of samples, time and label, by their values where no name tells.

use std::collections::BTreeSet;

use shared::units::{CHANNELS, SAMPLE_RATE_HZ};

use super::layout::{Beginning, LABELS};
use crate::examiner::clock::{self, Clock, HELD, Timebase, rises, seconds_of};
use crate::examiner::finding::{Finding, Scale};
use crate::examiner::scale::ScaleDetector;
use crate::readers::table::auxiliary::unnamed;
use crate::readers::table::one_hot;
use crate::statistics::median;

/// Largest deviation of a rate from the armband's, as a share, that counts as its own.
const OFF: f64 = 0.1;

/// Roles of the columns of files of one layout.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Roles {
    /// Names of the columns, if all files have the same.
    pub names: Vec<String>,
    /// Columns of the channels; none where they are known by their names, which differ from file to file.
    pub channels: Option<[usize; CHANNELS]>,
    /// Number of columns that look like channels, if there are more than eight.
    pub more: Option<usize>,
    pub time: Option<usize>,
    pub label: Option<usize>,
    /// Columns with a label each, of which one is 1 in a row.
    pub one_hot: Vec<usize>,
    /// Rows a second by the column of times, over all files.
    pub rate: Option<f64>,
    /// Counts for a value of 1, or what the examiner says of values that no scale makes counts.
    pub scale: Result<f64, Finding>,
    /// Least and largest value.
    pub range: (f64, f64),
}

/// Behaviour of a column's values.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Behaviour {
    /// Rises from row to row: times, row numbers, a counter.
    Rises,
    /// Few values, each held for long: labels.
    Holds,
    /// Whole numbers and decimals that change from row to row.
    Changes,
    /// Text, or always the same.
    Other,
}

fn behaviour(column: &[String]) -> Behaviour {
    let times: Option<Vec<f64>> = column.iter().map(|text| seconds_of(text)).collect();
    let changes = column.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let is_number = |text: &String| text.parse::<f64>().is_ok();
    let is_numeric = column.iter().all(is_number) && column.len() > 1;
    let distinct: BTreeSet<&String> = column.iter().collect();
    if times.is_some_and(|times| rises(&times)) {
        Behaviour::Rises
    } else if distinct.len() <= LABELS && changes * HELD <= column.len() {
        Behaviour::Holds
    } else if is_numeric {
        Behaviour::Changes
    } else {
        Behaviour::Other
    }
}

impl Roles {
    /// Roles of the columns of files of one layout; none if there are no eight channels.
    pub fn of(files: &[Beginning]) -> Option<Self> {
        let first = files.first()?;
        if files.iter().all(|file| file.names == first.names) {
            return Self::of_alike(files);
        }
        // Columns that are known by their names, which differ from file to file.
        let own = files
            .iter()
            .map(|file| Self::of_alike(std::slice::from_ref(file)));
        let own: Vec<Self> = own.collect::<Option<_>>()?;
        let differs = own.iter().find(|other| other.scale != own[0].scale);
        let scale = differs.map_or(&own[0].scale, |other| &other.scale).clone();
        let least = own
            .iter()
            .map(|own| own.range.0)
            .fold(f64::INFINITY, f64::min);
        let most = own
            .iter()
            .map(|own| own.range.1)
            .fold(f64::NEG_INFINITY, f64::max);
        Some(Self {
            names: Vec::new(),
            channels: None,
            more: None,
            time: own[0].time,
            // Where columns move, a person names the one of the labels.
            label: None,
            one_hot: Vec::new(),
            rate: median(&own.iter().filter_map(|own| own.rate).collect::<Vec<_>>()),
            scale,
            range: (least, most),
        })
    }

    fn of_alike(files: &[Beginning]) -> Option<Self> {
        let first = files.first()?;
        let width = files.iter().map(|file| file.columns.len()).min()?;
        let all = |wanted: Behaviour, at: usize| {
            files
                .iter()
                .all(|file| behaviour(&file.columns[at]) == wanted)
        };
        let named = first.by_name.as_ref();
        let changing: Vec<usize> = match named {
            Some(columns) => columns.channels.to_vec(),
            None => (0..width)
                .filter(|&at| all(Behaviour::Changes, at))
                .collect(),
        };
        let channels: [usize; CHANNELS] = changing.get(..CHANNELS)?.try_into().ok()?;
        if files
            .iter()
            .all(|file| file.columns[channels[0]].is_empty())
        {
            return None;
        }
        let others = (0..width).filter(|at| !changing.contains(at));
        let others: Vec<usize> = others.collect();
        let names: Vec<&str> = others
            .iter()
            .map(|&at| first.names.get(at).map_or("", |name| name.trim()))
            .collect();
        let time = clock::column(&names).map(|found| others[found]);
        let time = time.or_else(|| others.iter().copied().find(|&at| all(Behaviour::Rises, at)));
        let differs = |at: &usize| {
            let values = files.iter().flat_map(|file| &file.columns[*at]);
            values.collect::<BTreeSet<_>>().len() > 1
        };
        let held = |at: &usize| all(Behaviour::Holds, *at) && Some(*at) != time && differs(at);
        let binary: Vec<usize> = others.iter().copied().filter(held).collect();
        let one_hot = one_hot(files, binary);
        let held = |at: &usize| held(at) && !one_hot.contains(at);
        let label = named.and_then(|columns| columns.label);
        let label = label.or_else(|| others.iter().copied().find(held));
        let (scale, range) = scale(files, &channels);
        Some(Self {
            names: first.names.clone(),
            channels: Some(channels),
            more: (changing.len() > CHANNELS).then_some(changing.len()),
            time,
            label,
            one_hot,
            rate: time.and_then(|time| rate(files, time)),
            scale,
            range,
        })
    }
}

/// Columns of which one is 1 in a row and the others are 0; none if there are fewer than two.
fn one_hot(files: &[Beginning], mut columns: Vec<usize>) -> Vec<usize> {
    let is_binary = |text: &String| one_hot::value(text).is_some();
    columns.retain(|&at| {
        files
            .iter()
            .all(|file| file.columns[at].iter().all(is_binary))
    });
    let is_exclusive = |file: &Beginning| {
        let rows = file.columns.first().map_or(0, Vec::len);
        let is_one = |at: usize, row: usize| one_hot::value(&file.columns[at][row]) == Some(true);
        (0..rows).all(|row| columns.iter().filter(|&&at| is_one(at, row)).count() <= 1)
    };
    if columns.len() > 1 && files.iter().all(is_exclusive) {
        columns
    } else {
        Vec::new()
    }
}

/// Rows a second by a column of times: the armband's rate where it is near to it, else as it is.
fn rate(files: &[Beginning], time: usize) -> Option<f64> {
    let rates = files.iter().filter_map(|file| {
        let name = file.names.get(time).cloned();
        let mut clock = Clock::of(name.unwrap_or_else(|| unnamed(time)));
        file.columns[time].iter().for_each(|text| clock.push(text));
        match clock.timebase() {
            Timebase::Rate { hz, .. } => Some(hz),
            Timebase::Unclear => None,
        }
    });
    median(&rates.collect::<Vec<_>>())
}

/// Whether a rate counts as the armband's.
pub(super) fn is_armbands(rate: f64) -> bool {
    (rate / f64::from(SAMPLE_RATE_HZ) - 1.0).abs() < OFF
}

/// Counts for a value of 1, and the range of the values.
fn scale(files: &[Beginning], channels: &[usize; CHANNELS]) -> (Result<f64, Finding>, (f64, f64)) {
    let mut detector = ScaleDetector::default();
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for file in files {
        let rows = file.columns[channels[0]].len();
        for row in 0..rows {
            let value = |at: &usize| file.columns[*at][row].parse::<f64>().unwrap_or(0.0);
            let values: Vec<f64> = channels.iter().map(value).collect();
            range = values.iter().fold(range, |(least, most), &value| {
                (least.min(value), most.max(value))
            });
            detector.push(&values);
        }
    }
    let scale = match detector.finish() {
        Ok(()) => Ok(1.0),
        Err(Finding::Scale {
            scale: Scale::Step { step, .. },
            ..
        }) => Ok(if step < 1.0 {
            (1.0 / step).round()
        } else {
            1.0 / step
        }),
        Err(finding) => Err(finding),
    };
    (scale, range)
}
