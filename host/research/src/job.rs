//! Job of a cross-validation: one run folder, begun once and continued after an interruption.

use std::path::PathBuf;

use thiserror::Error;

use execution::run_folder::{RunError, RunFolder};
use presets::config::{CONFIG, ResolvedConfig};
use presets::resolve::ConfigError;
use training::run::StepError;
use training::run::personalize::PersonalizeError;

/// Why a job, or the measurement of a person, failed.
#[derive(Debug, Error)]
pub(crate) enum JobError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Step(#[from] StepError),
    #[error(transparent)]
    Personalize(#[from] PersonalizeError),
    #[error(
        "{baseline} has {training} training windows and {validation} validation windows; it needs both: give more labelled recordings"
    )]
    NoWindows {
        baseline: &'static str,
        training: usize,
        validation: usize,
    },
    #[error("{path}: made with another preset, protocol or recordings; give another --out folder")]
    OtherRun { path: PathBuf },
}

impl JobError {
    pub(crate) const fn is_interrupt(&self) -> bool {
        match self {
            Self::Run(error) | Self::Step(StepError::Run(error)) => {
                matches!(error, RunError::Interrupted { .. })
            }
            Self::Personalize(error) => error.is_interrupt(),
            _ => false,
        }
    }
}

/// Loads the configuration in the folder if the job was started before; otherwise saves the new one there.
pub(crate) fn begun(
    folder: &RunFolder,
    config: ResolvedConfig,
) -> Result<ResolvedConfig, JobError> {
    match ResolvedConfig::load(folder) {
        Ok(saved) if saved.fingerprint() != config.fingerprint() => Err(JobError::OtherRun {
            path: folder.file(CONFIG),
        }),
        Ok(saved) => Ok(saved),
        Err(RunError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
            config.save(folder)?;
            Ok(config)
        }
        Err(error) => Err(error.into()),
    }
}
