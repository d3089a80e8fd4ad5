//! `wang-myo`: one gesture 20 times a file, without labels or times; which gesture is in the name.
//!
//! Published as MATLAB files of value = count / 128 (`EMG_S1/.../握拳_1_x.mat`), repacked as npy of counts
//! (`EMG_S1/1_fist.npy`). Either name holds the gesture's number.

use std::path::Path;

use shared::intent::Intent;
use shared::units::Sample;

use crate::labels::activity::labelled;
use crate::labels::motion::Motion;
use crate::readers::error::{Damage, Fault};
use crate::readers::mat::Matrix;
use crate::readers::npy::Array;
use crate::readers::path::{numbered, stem};
use crate::readers::table;
use crate::recording::movement::MovementKind;
use crate::recording::{DataSet, Recording};

/// Gestures by number, from 1 on. Grasps are too near to a fist, and a tripod to a pinch, to be labelled.
const GESTURES: [(&str, Motion); 10] = [
    ("1_fist", Motion::Intent(Intent::Close)),
    ("2_pinch", Motion::Intent(Intent::Pinch)),
    ("3_two", Motion::Other(MovementKind::TwoFingers)),
    ("4_three", Motion::Other(MovementKind::ThreeFingers)),
    ("5_thumb_up", Motion::Other(MovementKind::ThumbUp)),
    ("6_tripod", Motion::Unknown),
    ("7_ball", Motion::Unknown),
    ("8_open", Motion::Intent(Intent::Open)),
    ("9_point", Motion::Other(MovementKind::Point)),
    ("10_cylinder", Motion::Unknown),
];

/// Person and gesture of a file.
pub(crate) struct Name<'p> {
    person: &'p str,
    gesture: (&'static str, Motion),
}

impl<'p> Name<'p> {
    /// Name of a file in the repacked layout.
    pub(crate) fn of_npy(path: &'p Path) -> Option<Self> {
        let name = stem(path)?;
        let gesture = GESTURES.into_iter().find(|(known, _)| *known == name)?;
        Some(Self {
            person: person(path, 1)?,
            gesture,
        })
    }

    /// Name of a file in the published layout; none without `_x`: such files are the same recordings, untrimmed.
    pub(crate) fn of_mat(path: &'p Path) -> Option<Self> {
        let (_, number) = stem(path)?.strip_suffix("_x")?.rsplit_once('_')?;
        let number: usize = number.parse().ok()?;
        let gesture = *GESTURES.get(number.checked_sub(1)?)?;
        Some(Self {
            person: (1..=4).find_map(|levels| person(path, levels))?,
            gesture,
        })
    }
}

/// Person `S1` of a folder `EMG_S1`.
fn person(path: &Path, levels: usize) -> Option<&str> {
    numbered(path, levels, "EMG_S").map(|folder| &folder["EMG_".len()..])
}

pub(crate) fn read_npy(path: &Path, name: &Name<'_>, array: &Array) -> Result<Recording, Damage> {
    Ok(recording(path, name, table::samples(array)?))
}

pub(crate) fn read_mat(
    path: &Path,
    name: &Name<'_>,
    matrices: &[Matrix],
) -> Result<Recording, Damage> {
    let data = matrices
        .iter()
        .find(|m| m.name == "data" || m.name == "data1");
    let data = data.ok_or_else(|| Damage::of_file(Fault::Mat("it has no data or data1".into())))?;
    Ok(recording(path, name, table::matrix(data, 128.0)?))
}

fn recording(path: &Path, name: &Name<'_>, samples: Vec<Sample>) -> Recording {
    let (gesture, motion) = name.gesture;
    let mut recording = labelled(DataSet::WangMyo, name.person, samples, motion);
    recording.name = gesture.to_owned();
    recording.path = path.to_owned();
    recording
}

#[cfg(test)]
mod tests {
    use shared::units::CHANNELS;

    use super::*;
    use crate::readers::mat::{fixture, parse};

    #[test]
    fn both_layouts_name_person_and_gesture() {
        let npy = Name::of_npy(Path::new("/d/EMG_S12/5_thumb_up.npy")).unwrap();
        assert_eq!(
            (npy.person, npy.gesture.1),
            ("S12", Motion::Other(MovementKind::ThumbUp))
        );
        for path in ["/d/EMG_S3/x/握拳_1_x.mat", "/d/EMG_S3/握拳_1_x.mat"] {
            let mat = Name::of_mat(Path::new(path)).unwrap();
            assert_eq!((mat.person, mat.gesture.0), ("S3", "1_fist"));
        }
        let good = Name::of_mat(Path::new("/d/EMG_S3/Good_5_x.mat")).unwrap();
        assert_eq!(good.gesture.0, "5_thumb_up");
        for raw in [
            "/d/EMG_S3/握拳_1.mat",
            "/d/EMG_S3/握拳_11_x.mat",
            "/d/S/握拳_1_x.mat",
        ] {
            assert!(Name::of_mat(Path::new(raw)).is_none(), "{raw}");
        }
    }

    #[test]
    fn a_published_file_holds_counts_over_128() {
        let mut values = vec![0.0; 800 * CHANNELS];
        for (at, value) in values.iter_mut().enumerate() {
            let hold = (200..600).contains(&(at % 800));
            let count = if hold { 40.0 } else { 2.0 } * if at % 2 == 0 { 1.0 } else { -1.0 };
            *value = count / 128.0;
        }
        let bytes = fixture::file(&[fixture::compressed(&fixture::doubles(
            "data1",
            [800, 8],
            &values,
        ))]);
        let path = Path::new("/d/EMG_S3/展拳_8_x.mat");
        let name = Name::of_mat(path).unwrap();
        let recording = read_mat(path, &name, &parse(&bytes).unwrap()).unwrap();
        assert_eq!(recording.full_name(), "wang-myo/S3/8_open");
        assert_eq!(
            (recording.samples[0], recording.samples[401]),
            ([2; 8], [-40; 8])
        );
        assert_eq!(recording.labels[0], Some(Intent::Relax));
        assert_eq!(recording.labels[400], Some(Intent::Open));
    }
}
