//! `myo-rps`: one whole gesture a file, from rest to rest in two seconds; no labels inside.
//!
//! csv with a header, `index,timestamp,0,1,2,3,4,5,6,7`; the gesture is in the name.

use std::path::Path;

use shared::intent::Intent;

use crate::labels::activity::labelled;
use crate::labels::motion::Motion;
use crate::readers::error::{Damage, Fault};
use crate::readers::path::stem;
use crate::readers::table;
use crate::recording::movement::MovementKind;
use crate::recording::{DataSet, Recording};

const HEADER: &str = "index,timestamp,0,1,2,3,4,5,6,7";

/// Whether a file has a name and the header of the set.
pub(crate) fn is_recording(path: &Path, text: &str) -> bool {
    let header = text.lines().next().unwrap_or_default();
    header.trim() == HEADER && stem(path).and_then(Name::of).is_some()
}

pub(crate) fn read(path: &Path, text: &str) -> Result<Recording, Damage> {
    let misplaced = || {
        Damage::of_file(Fault::Path {
            set: DataSet::MyoRps.name(),
            example: "s1_r_1-rock-0-emg.csv",
        })
    };
    let name = stem(path).and_then(Name::of).ok_or_else(misplaced)?;
    let mut samples = Vec::new();
    for (line, row) in table::rows(text).skip(1) {
        let values = table::numbers::<10>(line, row)?;
        let sample = table::sample(&values[2..], 3);
        samples.push(sample.map_err(|fault| Damage::at_line(line, fault))?);
    }
    let mut recording = labelled(DataSet::MyoRps, name.person, samples, name.motion);
    recording.name = name.rest;
    recording.path = path.to_owned();
    if name.person == "s5" {
        let note = "the band sits otherwise than in the other recordings: no rotation fits well";
        recording.notes.push(note.to_owned());
    }
    Ok(recording)
}

/// Person, motion and rest of a file's name.
struct Name<'n> {
    person: &'n str,
    motion: Motion,
    /// Arm, round, gesture and number: `r_1-rock-0`.
    rest: String,
}

impl<'n> Name<'n> {
    /// Parses `sN_A_R-gesture-K-emg`: person, arm (`l` or `r`), round, gesture and number.
    fn of(stem: &'n str) -> Option<Self> {
        let (person, rest) = stem.strip_suffix("-emg")?.split_once('_')?;
        let number = person.strip_prefix('s')?;
        number.parse::<usize>().ok()?;
        let motion = match rest.split('-').nth(1)? {
            "rock" => Motion::Intent(Intent::Close),
            "paper" => Motion::Intent(Intent::Open),
            "scissors" => Motion::Other(MovementKind::TwoFingers),
            _ => return None,
        };
        Some(Self {
            person,
            motion,
            rest: rest.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(hold: std::ops::Range<usize>) -> String {
        let row = |at: usize| {
            let count = if hold.contains(&at) { 40 } else { 2 } * (1 - 2 * (at as i32 % 2));
            format!(
                "{at},{},{}\r\n",
                5000 * at,
                vec![count.to_string(); 8].join(",")
            )
        };
        format!("{HEADER}\r\n{}", (0..400).map(row).collect::<String>())
    }

    fn read_as(name: &str, text: &str) -> Result<Recording, Damage> {
        read(Path::new("/d/dataset/s2_l_1").join(name).as_path(), text)
    }

    #[test]
    fn the_gesture_of_the_name_is_where_the_muscle_is_active() {
        let text = text(100..300);
        assert!(is_recording(
            Path::new("/d/s1_r_1/s1_r_1-rock-0-emg.csv"),
            &text
        ));
        assert!(!is_recording(Path::new("/d/own.csv"), &text));
        let rock = read_as("s2_l_1-rock-7-emg.csv", &text).unwrap();
        assert_eq!(rock.full_name(), "myo-rps/s2/l_1-rock-7");
        assert_eq!(rock.labels[200], Some(Intent::Close));
        assert_eq!(rock.labels[20], Some(Intent::Relax));
        assert_eq!(rock.samples[201], [-40; 8]);
        let scissors = read_as("s2_l_1-scissors-7-emg.csv", &text).unwrap();
        assert_eq!(scissors.labels[200], None);
        assert!(scissors.other_movement[0].samples.contains(&200));
    }

    #[test]
    fn a_file_without_a_gesture_to_see_is_unlabelled() {
        let weak = read_as("s2_l_1-rock-7-emg.csv", &text(0..0)).unwrap();
        assert!(!weak.has_labels());
        assert_eq!(weak.notes.len(), 1);
    }

    #[test]
    fn another_name_is_refused() {
        for name in [
            "rock-7-emg.csv",
            "s2_l_1-lizard-7-emg.csv",
            "s2_l_1-rock-7.csv",
        ] {
            assert!(read_as(name, &text(100..300)).is_err(), "{name}");
        }
    }
}
