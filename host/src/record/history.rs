//! Record of a person's sessions, for a therapist: when, how long, and how a model labels them. From the recorded files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use evaluation::metric::event::latency::Latency;
use evaluation::model_evaluation::{NamedModel, Selection, evaluate_models};
use recordings::{DataSet, Library, LoadOptions, load};
use serde::Serialize;
use shared::model::file::Model;
use shared::units::SAMPLE_RATE_HZ;
use web::record::remark::{NOTES, Remark};

/// A person's sessions, the earliest first.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct History {
    person: String,
    /// Checksum of the model that labels them, in hexadecimal; and version of the program.
    model: String,
    version: &'static str,
    sessions: Vec<SessionRecord>,
}

/// One session. Numbers are those of the files together; none where the session has nothing to count.
#[derive(Debug, Default, PartialEq, Serialize)]
struct SessionRecord {
    /// Date and time, `2026-11-22T11:03:23Z`.
    began: String,
    protocol: String,
    is_synthetic: bool,
    seconds: f64,
    gestures: usize,
    /// Share of the gestures that are recognised, 0 to 1.
    recognised: Option<f64>,
    /// Median latency from the onset of the muscle to the label, in ms; none also where it falls on a missed gesture.
    reaction: Option<f64>,
    /// Label changes a minute beyond the true ones.
    flicker: Option<f64>,
    /// False activations a minute of rest.
    false_activations: Option<f64>,
    /// Share of the movements that mean nothing which raise a label, 0 to 1.
    raised: Option<f64>,
    /// Notes and scores, in order.
    remarks: Vec<Remark>,
}

/// Folder of the recordings, person, and the model that labels them.
#[derive(Clone, Debug)]
pub(crate) struct HistoryOf {
    pub(crate) folder: PathBuf,
    pub(crate) person: String,
    pub(crate) model: Vec<u8>,
}

impl HistoryOf {
    /// Reads and labels all recordings of the person; takes a second for about ten minutes of them.
    ///
    /// # Errors
    /// When recordings or model cannot be read.
    pub(crate) fn read(&self) -> anyhow::Result<History> {
        let folder = self.folder.join(&self.person);
        let entries = folder.read_dir().into_iter().flatten().flatten();
        let paths: Vec<_> = entries.map(|entry| entry.path()).collect();
        let has = |path: &&PathBuf, own| path.extension().is_some_and(|ending| ending == own);
        let mut sessions = BTreeMap::new();
        if paths.iter().any(|path| has(&path, "csv")) {
            let mut library = load(&folder, &LoadOptions::default())?;
            sessions = by_session(&mut library);
            if !sessions.is_empty() {
                self.score(&library, &mut sessions)?;
            }
        }
        for path in paths.iter().filter(|path| has(path, NOTES)) {
            let remarks = Remark::read(&String::from_utf8_lossy(&std::fs::read(path)?));
            if let Some((id, began, protocol)) = stem(path).and_then(named) {
                let session = sessions.entry(subject(&id)).or_default();
                (session.began, session.protocol) = (began, protocol);
                session.remarks = remarks;
            }
        }
        Ok(History {
            person: self.person.clone(),
            model: Model::parse(&self.model)
                .map(|model| format!("{:08x}", model.checksum))
                .unwrap_or_default(),
            version: env!("CARGO_PKG_VERSION"),
            sessions: sessions.into_values().collect(),
        })
    }

    /// Adds what the metrics of `evaluate` say, which take each session for a person of its own.
    fn score(
        &self,
        library: &Library,
        sessions: &mut BTreeMap<String, SessionRecord>,
    ) -> anyhow::Result<()> {
        let model = NamedModel {
            name: String::new(),
            bytes: self.model.clone(),
        };
        let everybody = Selection {
            seen: true,
            ..Selection::default()
        };
        let results = evaluate_models(&[model], library, &everybody)?.results;
        let own = results
            .scores
            .iter()
            .filter(|score| !score.model.is_floor());
        for events in own.flat_map(|score| &score.events.subjects) {
            if let Some(session) = sessions.get_mut(&events.subject) {
                session.gestures = events.gestures;
                session.recognised = events.recognition;
                session.reaction = match events.latency.map(|latency| latency.median) {
                    Some(Latency::Ms(median)) => Some(median),
                    Some(Latency::Missed) | None => None,
                };
                session.flicker = events.flicker.per_minute();
                session.false_activations = events.rest.per_minute();
                session.raised = events.raised_share();
            }
        }
        Ok(())
    }
}

/// Gives the recordings of each session a subject of their own, and keeps no other recordings.
fn by_session(library: &mut Library) -> BTreeMap<String, SessionRecord> {
    let mut sessions: BTreeMap<String, SessionRecord> = BTreeMap::new();
    library.recordings.retain_mut(|recording| {
        let session = stem(&recording.path).and_then(|stem| stem.rsplit_once('_'));
        let Some((id, began, protocol)) = session.and_then(|(session, _)| named(session)) else {
            return false;
        };
        recording.subject = subject(&id);
        let session = sessions.entry(recording.subject.clone()).or_default();
        session.began = began;
        session.protocol = protocol;
        session.is_synthetic |= recording.data_set == DataSet::SYNTHETIC;
        session.seconds += recording.samples.len() as f64 / f64::from(SAMPLE_RATE_HZ);
        true
    });
    sessions
}

/// Subject of a session: never a person's of a published set.
fn subject(id: &str) -> String {
    format!("session/{id}")
}

/// Name of a file without its extension.
fn stem(path: &Path) -> Option<&str> {
    path.file_stem()?.to_str()
}

/// Session of a name, `anna_20261122T110323Z_quick`: `20261122T110323Z_quick`, time and protocol.
fn named(session: &str) -> Option<(String, String, String)> {
    let (_, id) = session.split_once('_')?;
    let (stamp, protocol) = id.split_once('_')?;
    let digits = stamp.strip_suffix('Z')?.replace('T', "");
    if digits.len() != 14 || !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    let [year, month, day, hour, minute, second] =
        [0..4, 4..6, 6..8, 8..10, 10..12, 12..14].map(|part| &digits[part]);
    let began = format!("{year}-{month}-{day}T{hour}:{minute}:{second}Z");
    Some((id.to_owned(), began, protocol.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_says_when_its_session_began_and_by_which_protocol() {
        let (id, began, protocol) = named("anna_20261122T110323Z_quick-five").unwrap();
        assert_eq!(id, "20261122T110323Z_quick-five");
        assert_eq!(
            (&*began, &*protocol),
            ("2026-11-22T11:03:23Z", "quick-five")
        );
        for other in ["anna", "anna_1", "anna_2026_quick"] {
            assert_eq!(named(other), None, "{other}");
        }
    }

    #[test]
    fn without_recordings_there_is_no_session() {
        let folder = tempfile::tempdir().unwrap();
        let of = HistoryOf {
            folder: folder.path().to_owned(),
            person: "anna".to_owned(),
            model: Vec::new(),
        };
        assert_eq!(of.read().unwrap().sessions, []);
    }
}
