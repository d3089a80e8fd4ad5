//! `epn`: one user in the way of EMG-EPN-612, one gesture in five seconds, without usable times.
//!
//! Repacked as npy, `user10/training/003_fist.npy`. The published `userData.mat` holds its labels as MATLAB
//! objects, which only MATLAB reads.

use std::path::Path;

use shared::intent::Intent;

use crate::labels::activity::labelled;
use crate::labels::motion::Motion;
use crate::readers::error::Damage;
use crate::readers::npy::Array;
use crate::readers::path::{folder, numbered, stem};
use crate::readers::table;
use crate::recording::{DataSet, Recording};

/// Samples below which a recording of five seconds has lost some.
const WHOLE: usize = 980;

/// Person, part, name and motion from the path of a file.
pub(crate) struct Name<'p> {
    person: &'p str,
    part: &'p str,
    name: &'p str,
    motion: Motion,
}

impl<'p> Name<'p> {
    pub fn of(path: &'p Path) -> Option<Self> {
        let name = stem(path)?;
        let (number, gesture) = name.split_once('_')?;
        number.parse::<usize>().ok()?;
        let part = folder(path, 1).filter(|part| ["training", "testing"].contains(part))?;
        let motion = match gesture {
            "noGesture" => Motion::RELAX,
            "open" => Motion::Intent(Intent::Open),
            "fist" => Motion::Intent(Intent::Close),
            "waveIn" => Motion::Intent(Intent::WaveIn),
            "waveOut" => Motion::Intent(Intent::WaveOut),
            "pinch" => Motion::Intent(Intent::Pinch),
            _ => return None,
        };
        Some(Self {
            person: numbered(path, 2, "user")?,
            part,
            name,
            motion,
        })
    }
}

pub(crate) fn read(path: &Path, name: &Name<'_>, array: &Array) -> Result<Recording, Damage> {
    let samples = table::samples(array)?;
    let count = samples.len();
    let mut recording = if name.motion == Motion::RELAX {
        // Without a gesture it is rest throughout, and has no activity to find.
        let labels = vec![Some(Intent::Relax); count];
        Recording::new(
            DataSet::Epn,
            format!("epn/{}", name.person),
            samples,
            labels,
        )
    } else {
        labelled(DataSet::Epn, name.person, samples, name.motion)
    };
    recording.name = format!("{}/{}", name.part, name.name);
    recording.path = path.to_owned();
    if count < WHOLE {
        let note =
            format!("fewer than {WHOLE} samples in 5 s: some were lost, it is not known where");
        recording.notes.push(note);
    }
    Ok(recording)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readers::npy;

    #[test]
    fn path_and_muscle_give_the_labels() {
        let data: Vec<u8> = (0..1000 * 8)
            .map(|at| {
                let row = at / 8;
                let count = if (500..800).contains(&row) { 40 } else { 2 };
                if row % 2 == 0 { count } else { -count }
            })
            .map(|count: i8| count as u8)
            .collect();
        let array = npy::parse(&npy::encode("|i1", &[1000, 8], &data)).unwrap();
        let labels = |path: &str| {
            let path = Path::new(path);
            let name = Name::of(path).unwrap();
            read(path, &name, &array).unwrap()
        };
        let pinch = labels("/d/user10/training/055_pinch.npy");
        assert_eq!(pinch.full_name(), "epn/user10/training/055_pinch");
        assert_eq!(pinch.labels[650], Some(Intent::Pinch));
        assert_eq!(pinch.labels[100], Some(Intent::Relax));
        let rest = labels("/d/user10/testing/001_noGesture.npy");
        assert_eq!(rest.labels, vec![Some(Intent::Relax); 1000]);
        for other in [
            "/d/user10/training/1_wink.npy",
            "/d/a/training/1_fist.npy",
            "/d/user10/1_fist.npy",
        ] {
            assert!(Name::of(Path::new(other)).is_none(), "{other}");
        }
    }
}
