//! `uci-gestures`: tab-separated text with times in ms, values of count x 1e-5, and a class.
//!
//! About half of the samples were lost before publication, and the rest was held at 1000 rows a second: rows that
//! repeat the one before are no samples. Those left are filtered by a median of three and then stretched to
//! 200 Hz. Good for which muscles are active, not for what a sample looks like.

use std::path::Path;

use shared::intent::Intent;
use shared::units::{CHANNELS, SAMPLE_PERIOD_MS, Sample};

use crate::catalogue::DataSet;
use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::{Damage, Fault};
use crate::readers::path::{folder, is_number, stem};
use crate::readers::table;
use crate::recording::Recording;
use crate::recording::movement::MovementKind;

/// Largest gap between two rows, in ms: 175 in the published files.
const GAP: f64 = 1000.0;
/// Longest recording, in ms; the published ones last a minute or two. A row may stand for many samples, so the file's
/// length is no bound.
const LONGEST: f64 = 3_600_000.0;
/// Largest time between rows of one burst, in ms.
const BURST: f64 = 2.0;

/// One sample that was not lost.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Row {
    /// Time in ms.
    time: f64,
    sample: Sample,
    class: u8,
}

/// Whether a file has a path and the header of the set.
pub(crate) fn is_recording(path: &Path, text: &str) -> bool {
    let header = text.lines().next().unwrap_or_default();
    let has_header = header.split_whitespace().eq([
        "time", "channel1", "channel2", "channel3", "channel4", "channel5", "channel6", "channel7",
        "channel8", "class",
    ]);
    has_header && series_and_person(path).is_some()
}

/// Series and person of a path like `01/1_raw_data_13-12_22.03.16.txt`.
fn series_and_person(path: &Path) -> Option<(&str, &str)> {
    let (series, _) = stem(path)?.split_once("_raw_data")?;
    let person = folder(path, 1).filter(|name| is_number(name))?;
    Some((series, person))
}

pub(crate) fn read(path: &Path, text: &str) -> Result<Recording, Damage> {
    let misplaced = || {
        Damage::of_file(Fault::Path {
            set: DataSet::named("uci-gestures").name(),
            example: "01/1_raw_data_13-12_22.03.16.txt",
        })
    };
    let (series, person) = series_and_person(path).ok_or_else(misplaced)?;
    let rows = rows(text)?;
    let filtered = median_of_three(&rows);
    let (samples, motions): (Vec<Sample>, Vec<Motion>) = stretched(&filtered)
        .into_iter()
        .map(|row| (row.sample, motion(row.class)))
        .unzip();
    let GroundTruth {
        labels,
        other_movement,
    } = motions.into_iter().collect();
    let subject = format!("uci-gestures/{person}");
    Ok(Recording {
        name: series.to_owned(),
        path: path.to_owned(),
        other_movement,
        notes: vec![
            "half of the samples were lost before publication: stretched to 200 Hz".to_owned(),
        ],
        ..Recording::new(DataSet::named("uci-gestures"), subject, samples, labels)
    })
}

/// Rows that differ from the one before in a channel.
fn rows(text: &str) -> Result<Vec<Row>, Damage> {
    let mut rows: Vec<Row> = Vec::new();
    let mut before: Option<f64> = None;
    for (line, text) in table::rows(text).skip(1) {
        let values = table::fields::<10>(line, text.split('\t'))?;
        let counts: [f64; CHANNELS] = std::array::from_fn(|channel| values[1 + channel] * 1e5);
        let sample = table::sample(&counts, 2).map_err(|fault| Damage::at_line(line, fault))?;
        let (time, class) = (values[0], values[9]);
        let from = before.unwrap_or(time);
        if !(0.0..=GAP).contains(&(time - from)) {
            let fault = Fault::Times {
                most: GAP,
                from,
                to: time,
            };
            return Err(Damage::at_line(line, fault));
        }
        before = Some(time);
        let seconds = (time - rows.first().map_or(time, |first| first.time)) / 1000.0;
        if seconds > LONGEST / 1000.0 {
            let most = LONGEST / 1000.0;
            return Err(Damage::at_line(line, Fault::Duration { most, seconds }));
        }
        if !(class.fract() == 0.0 && (0.0..=7.0).contains(&class)) {
            let fault = Fault::Label {
                expected: "0 to 7",
                found: class.to_string(),
            };
            return Err(Damage::at_line(line, fault));
        }
        let row = Row {
            time,
            sample,
            class: class as u8,
        };
        match rows.last_mut() {
            // A change of the class alone is no sample; it counts from the next one on.
            Some(last) if last.sample == sample => {}
            _ => rows.push(row),
        }
    }
    if rows.is_empty() {
        return Err(Damage::of_file(Fault::Empty));
    }
    Ok(rows)
}

/// Each channel's median of a row and its neighbours; the first and last row stay.
fn median_of_three(rows: &[Row]) -> Vec<Row> {
    let mut filtered = rows.to_vec();
    for (at, three) in rows.windows(3).enumerate() {
        for channel in 0..CHANNELS {
            let mut values = [0, 1, 2].map(|index| three[index].sample[channel]);
            values.sort_unstable();
            filtered[at + 1].sample[channel] = values[1];
        }
    }
    filtered
}

/// Rows at 200 Hz: the slots of 5 ms since the last burst are shared among the rows of a burst.
fn stretched(rows: &[Row]) -> Vec<Row> {
    let period = f64::from(SAMPLE_PERIOD_MS);
    let Some(start) = rows.first().map(|row| row.time) else {
        return Vec::new();
    };
    let mut slots: Vec<Row> = Vec::new();
    for burst in rows.chunk_by(|a, b| b.time - a.time <= BURST) {
        let last = burst[burst.len() - 1].time;
        // Bounded by GAP: no more than 200 slots a burst.
        let end = ((last - start) / period).floor() as usize + 1;
        let count = end - slots.len().min(end);
        slots.extend((0..count).map(|slot| burst[slot * burst.len() / count]));
    }
    slots
}

const fn motion(class: u8) -> Motion {
    match class {
        1 => Motion::RELAX,
        2 => Motion::Intent(Intent::Close),
        3 => Motion::Intent(Intent::WaveIn),
        4 => Motion::Intent(Intent::WaveOut),
        5 => Motion::Other(MovementKind::RadialDeviation),
        6 => Motion::Other(MovementKind::UlnarDeviation),
        7 => Motion::Intent(Intent::Open),
        // Unmarked: rest, and both ends of each hold.
        _ => Motion::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "time\tchannel1\tchannel2\tchannel3\tchannel4\tchannel5\tchannel6\tchannel7\tchannel8\tclass\n";

    fn row(time: f64, count: i8) -> Row {
        Row {
            time,
            sample: [count; 8],
            class: 0,
        }
    }

    fn line(time: usize, count: i32, class: u8) -> String {
        let value = format!("\t{}e-05", count).repeat(8);
        format!("{time}{value}\t{class}\n")
    }

    #[test]
    fn values_are_counts_and_repeats_are_no_samples() {
        let text: String = [
            line(1, -128, 0),
            line(2, -128, 0),
            line(3, 127, 2),
            line(4, 127, 2),
            line(9, 5, 5),
        ]
        .concat();
        let text = format!("{HEADER}{text}");
        assert!(is_recording(Path::new("/d/01/1_raw_data_x.txt"), &text));
        assert!(!is_recording(Path::new("/d/own.txt"), &text));
        let found: Vec<_> = rows(&text)
            .unwrap()
            .iter()
            .map(|row| (row.time, row.sample[7], row.class))
            .collect();
        assert_eq!(found, [(1.0, -128, 0), (3.0, 127, 2), (9.0, 5, 5)]);
        let recording = read(Path::new("/d/07/2_raw_data_13.txt"), &text).unwrap();
        assert_eq!(recording.full_name(), "uci-gestures/07/2");
        assert!(!DataSet::named("uci-gestures").trained_by_default());
    }

    #[test]
    fn slots_are_shared_among_the_rows_of_a_burst() {
        let rows = [row(0.0, 1), row(20.0, 2), row(21.0, 3), row(40.0, 4)];
        let counts: Vec<i8> = stretched(&rows).iter().map(|row| row.sample[0]).collect();
        assert_eq!(counts, [1, 2, 2, 3, 3, 4, 4, 4, 4]);
        let faster: Vec<Row> = (0..100)
            .map(|at| row(2.5 * f64::from(at), at as i8))
            .collect();
        assert_eq!(stretched(&faster).len(), 50);
    }

    #[test]
    fn the_median_removes_a_single_peak() {
        let rows = [row(0.0, 1), row(5.0, 90), row(10.0, 3), row(15.0, 2)];
        let counts: Vec<i8> = median_of_three(&rows).iter().map(|r| r.sample[0]).collect();
        assert_eq!(counts, [1, 3, 3, 2]);
    }

    #[test]
    fn times_that_go_back_or_leap_are_refused() {
        for times in [[5, 4], [5, 2000]] {
            let text = format!("{HEADER}{}{}", line(times[0], 1, 0), line(times[1], 2, 0));
            let damage = rows(&text).unwrap_err();
            assert!(matches!(damage.fault, Fault::Times { .. }), "{damage:?}");
        }
    }

    #[test]
    fn times_that_last_longer_than_an_hour_are_refused_and_not_filled() {
        let lines = (0..3602).map(|second| line(1000 * second, (second % 2) as i32, 0));
        let text = HEADER.to_owned() + &lines.collect::<String>();
        let damage = read(Path::new("/d/07/2_raw_data_13.txt"), &text).err();
        let fault = damage.map(|damage| damage.fault.to_string());
        assert!(fault.is_some_and(|fault| fault.contains("3600 s")));
    }
}
