//! Text for viewers: the result of a session, and commands.

use std::path::{Path, PathBuf};

use super::Recorder;
use crate::record;
use web::outcome::SessionResult;

/// Describes what was kept, with the next commands.
pub(super) fn summary(conversion: &record::Conversion, recorder: &Recorder) -> SessionResult {
    let name = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    };
    let folder = recorder.folder();
    let data = quoted(&folder);
    let out = free_path(&folder, &recorder.options.person);
    let commands = [
        format!("myointent data inspect {data}"),
        format!(
            "myointent personalize --model {} --data {data} --out {}",
            quoted(&recorder.options.model),
            quoted(&out)
        ),
        install_command(recorder, &out),
    ];
    SessionResult::of(
        &conversion.quality,
        conversion.rejected,
        folder.display().to_string(),
        conversion.files.iter().map(name).collect(),
        commands,
    )
}

/// Command that installs a model on a board.
pub(super) fn install_command(recorder: &Recorder, file: &Path) -> String {
    let port = recorder
        .port
        .as_deref()
        .unwrap_or(Path::new("/dev/ttyACM0"));
    format!(
        "myointent board --port {} install {}",
        quoted(port),
        quoted(file)
    )
}

/// Quotes a path for a shell.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "/._-+:\\".contains(letter);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else {
        format!("\"{text}\"")
    }
}

/// Finds a free name for a model file.
pub(super) fn free_path(folder: &Path, person: &str) -> PathBuf {
    let mut number = 1_u32;
    let mut path = folder.join(format!("{person}.intent"));
    while path.exists() {
        number += 1;
        path = folder.join(format!("{person}-{number}.intent"));
    }
    path
}
