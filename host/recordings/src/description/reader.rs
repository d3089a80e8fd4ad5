//! Recordings of one file, as a description says.

use std::path::Path;

use shared::intent::Intent;

use super::pattern::{Field, Fields, Pattern};
use super::rows::{Rows, labels};
use super::values::LabelTiming;
use super::words::Words;
use super::{Described, Description};
use crate::catalogue::DataSet;
use crate::labels::activity::{WEAK, label};
use crate::labels::compensation::Compensation;
use crate::labels::motion::Motion;
use crate::readers::error::excerpt::excerpt;
use crate::readers::error::{Damage, LoadError};
use crate::readers::label_file::Purpose;
use crate::readers::open::{Found, OpenRequest, SkipReason, open};
use crate::readers::path::{existing, left_arm};
use crate::readers::read;
use crate::readers::table::auxiliary::Auxiliary;
use crate::recording::{Recording, Timing};

/// Note of a recording that is named after the left arm.
const LEFT: &str = "named after the left arm, read as it is: if the armband was on the left arm, write arm = \"left\"";

impl Described {
    /// Reads a file of the folder if its path is one of the description's.
    pub fn open(&self, path: &Path, request: &OpenRequest<'_>) -> Result<Found, LoadError> {
        let description = &self.description;
        let below = path.strip_prefix(&self.folder).unwrap_or(path);
        let of_labels = |labels: &Pattern| labels.fields_of(below, |_| true).is_some();
        if description.label_files.as_ref().is_some_and(of_labels) {
            return Ok(Found::Part);
        }
        let Some(fields) = self.fields_of(path) else {
            return if request.alone {
                open(path, request)
            } else {
                Ok(Found::Nothing(SkipReason::Pattern))
            };
        };
        if !request.wants(DataSet::OWN) {
            return Ok(Found::Nothing(SkipReason::NotWanted));
        }
        let rows = self.rows(path, &fields)?;
        let pieces = rows.recordings(description, path, fields.get(Field::Gesture))?;
        let named = |recording| self.named(recording, below, &fields);
        Ok(Found::Recordings(pieces.into_iter().map(named).collect()))
    }

    /// Rows of a file, and of the file of its labels.
    pub(super) fn rows(&self, path: &Path, fields: &Fields) -> Result<Rows, LoadError> {
        let rows = self.description.rows(&read(path)?);
        let rows = rows.map_err(|damage| damage.in_file(path))?;
        self.description
            .with_labels(rows, &self.folder, path, fields)
    }

    fn named(&self, recording: Recording, below: &Path, fields: &Fields) -> Recording {
        let (piece, mut notes) = (recording.name, recording.notes);
        if self.description.arm.is_none() && left_arm(&recording.path) {
            notes.insert(0, LEFT.to_owned());
        }
        let person = fields.get(Field::Person);
        let whole = below.with_extension("");
        // The person's own folder is no part of the name.
        let own = person.and_then(|person| whole.strip_prefix(person).ok());
        let own = own
            .filter(|own| own.iter().next().is_some())
            .unwrap_or(&whole);
        let names: Vec<_> = own.iter().map(|name| name.to_string_lossy()).collect();
        let subject = person.map_or(recording.subject, |person| {
            format!("{}/{}{person}", DataSet::OWN.name(), self.above)
        });
        Recording {
            subject,
            name: names.join("/") + &piece,
            notes,
            ..recording
        }
    }
}

impl Description {
    /// Rows with the labels of another file, below a folder, or that of the file's name.
    pub(super) fn with_labels(
        &self,
        mut rows: Rows,
        folder: &Path,
        path: &Path,
        fields: &Fields,
    ) -> Result<Rows, LoadError> {
        if let Some(pattern) = &self.label_files {
            let file = folder.join(pattern.path_of(fields));
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let name = excerpt(&name);
            let missing = format!("expected {name} beside it, found no such file");
            let file = existing(file).ok_or_else(|| Damage::of_file(missing).in_file(path))?;
            let labels = labels(&read(&file)?, Purpose::Truth);
            let labels = labels.and_then(|labels| labels.of_each(rows.samples.len()));
            rows.labels = labels.map_err(|damage| damage.in_file(&file))?;
            rows.labels_file = Some(file);
        } else if let (None, Some(word)) = (&self.label, fields.get(Field::Gesture)) {
            rows.labels.words = Some(Words::of_file(word, rows.samples.len()));
        }
        Ok(rows)
    }
}

impl Rows {
    /// Recordings of the rows: one, or its pieces where the clock leaps.
    pub(super) fn recordings(
        self,
        description: &Description,
        path: &Path,
        gesture: Option<&str>,
    ) -> Result<Vec<Recording>, LoadError> {
        let motions = self.motions(&description.labels, path)?;
        let (recording, auxiliary) = self.recording(description, path, motions);
        let rows = auxiliary.rows(&recording.samples);
        let rows = rows.map_err(|finding| Damage::from(finding).in_file(path))?;
        let motion = gesture.and_then(|word| description.labels.motion(word));
        let pieces = rows.apply(recording).into_iter();
        Ok(pieces.map(|own| timed(description, motion, own)).collect())
    }

    /// Recording of the rows with the motion of each, of a person who is not known yet; and what stands beside the rows.
    pub(super) fn recording(
        self,
        description: &Description,
        path: &Path,
        motions: Vec<Motion>,
    ) -> (Recording, Auxiliary) {
        let placement = description.placement();
        let samples = self.samples.into_iter();
        let samples = samples.map(|sample| placement.apply(sample));
        let subject = format!("{}/unknown", DataSet::OWN.name());
        let recording = Recording {
            path: path.to_owned(),
            ..Recording::new(DataSet::OWN, subject, samples.collect(), Vec::new())
        };
        let recording = recording.with_truth(motions.into_iter().collect());
        (recording, self.auxiliary)
    }
}

/// A recording with labels at the times that the description says.
pub(super) fn timed(
    description: &Description,
    motion: Option<Motion>,
    recording: Recording,
) -> Recording {
    let muscle = |recording| Recording {
        timing: Timing::Muscle,
        ..recording
    };
    match (description.timing, motion) {
        (LabelTiming::Muscle, _) => muscle(recording),
        // Rest has no activity to find.
        (LabelTiming::FromActivity, Some(motion)) if motion != Motion::Intent(Intent::Relax) => {
            let mut recording = muscle(recording);
            let truth = label(&recording.samples, motion);
            let weak = truth.is_none().then(|| WEAK.to_owned());
            recording.notes.extend(weak);
            let unknown = vec![Motion::Unknown; recording.samples.len()];
            recording.with_truth(truth.unwrap_or_else(|| unknown.into_iter().collect()))
        }
        (LabelTiming::FromActivity, _) => recording,
        (LabelTiming::Cues, _) => match description.lag_samples() {
            Some(lag) => muscle(recording.compensated(Compensation::Constant(lag))),
            None => recording,
        },
    }
}
