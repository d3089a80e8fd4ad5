//! Start of a training from the weights of another run or of a checkpoint.

use std::path::Path;

use execution::run_folder::RunFolder;
use presets::config::ResolvedConfig;

use super::error::StepError;
use crate::teacher::checkpoint;

/// Starts a run from the weights of another run, or from a checkpoint ([`ResolvedConfig::start_from`]). A checkpoint of the
/// reference does not name the people that it was trained on.
pub fn start_from(config: &mut ResolvedConfig, start: &Path) -> Result<(), StepError> {
    let seen = if start.is_dir() {
        ResolvedConfig::load(&RunFolder::existing(start)?)?.subjects_seen()
    } else {
        checkpoint::subjects_seen(start)?.unwrap_or_default()
    };
    Ok(config.start_from(start, seen)?)
}

#[cfg(test)]
mod tests {
    use presets::resolve::fixture::resolve;

    use super::*;
    use crate::teacher::model::Teacher;
    use crate::weights::save_model;

    /// Run folder with this configuration and a teacher.
    fn run_folder(config: &ResolvedConfig) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let run = RunFolder::open(folder.path()).unwrap();
        config.save(&run).unwrap();
        let device = burn::tensor::Device::default();
        let teacher = Teacher::new(1, &config.preset.teacher, config.preset.classes, &device);
        let lineage = config.teacher_lineage();
        save_model(&run, presets::teacher::NAME, lineage, &teacher).unwrap();
        folder
    }

    #[test]
    fn everybody_that_an_ancestor_saw_is_remembered() {
        let first = resolve(&["own/p1", "own/p2"], &["own/p3"]).unwrap();
        let a = run_folder(&first);
        // The first run trained on p4; the second one neither trains on nor validates with it.
        let mut second = resolve(&["own/p1", "own/p2"], &["own/p3"]).unwrap();
        second.split.training.retain(|name| name != "own/p4");
        start_from(&mut second, a.path()).unwrap();
        let b = run_folder(&second);
        let mut third = resolve(&["own/p1", "own/p4"], &["own/p3"]).unwrap();
        let error = start_from(&mut third, b.path()).unwrap_err().to_string();
        assert!(error.contains("own/p4"), "{error}");
        assert!(!error.contains("own/p1"), "{error}");
    }

    #[test]
    fn an_exported_teacher_remembers_whom_it_saw() {
        let config = resolve(&["own/p1"], &["own/p3"]).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("teacher.safetensors");
        let teacher = Teacher::new(
            1,
            &config.preset.teacher,
            3,
            &burn::tensor::Device::default(),
        );
        checkpoint::save(&file, &teacher, &config.subjects_seen()).unwrap();
        let mut other = resolve(&["own/p2"], &["own/p3"]).unwrap();
        let error = start_from(&mut other, &file).unwrap_err().to_string();
        assert!(error.contains("own/p2"), "{error}");
        let mut same = resolve(&["own/p1"], &["own/p3"]).unwrap();
        start_from(&mut same, &file).unwrap();
        assert!(same.seen_before.contains(&"own/p2".to_owned()));
    }
}
