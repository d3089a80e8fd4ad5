//! Text for viewers: the result of a session, and commands.

use std::path::{Path, PathBuf};

use super::{Keeper, free_path};
use crate::record;
use web::outcome::SessionResult;

impl Keeper {
    /// Describes what was kept, with the next commands.
    pub(super) fn summary(&self, conversion: &record::Conversion) -> SessionResult {
        let name = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        };
        let data = quoted(&self.folder);
        let out = free_path(&self.folder, &self.options.person);
        let commands = [
            format!("myointent data inspect {data}"),
            format!(
                "myointent personalize --model {} --data {data} --out {}",
                quoted(&self.options.model),
                quoted(&out)
            ),
            self.install_command(&out),
        ];
        SessionResult::of(
            &conversion.quality,
            conversion.rejected,
            self.folder.display().to_string(),
            conversion.files.iter().map(name).collect(),
            commands,
        )
    }

    /// Command that installs a model on a board.
    pub(super) fn install_command(&self, file: &Path) -> String {
        let port = self.port.as_deref().unwrap_or(Path::new("/dev/ttyACM0"));
        format!(
            "myointent board --port {} install {}",
            quoted(port),
            quoted(file)
        )
    }
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
