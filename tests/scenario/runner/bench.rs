//! Boards that a scenario runs on.

use anyhow::{Context as _, ensure};
use myointent_tests::simulation::{self, Inputs};
use myointent_tests::{found, model_file};
use shared::model::noise::Noise;
use shared::myo::binding;
use shared::units::Sample;
use virtual_armband::ADDRESS;

use super::file::{Content, File, Scenario};

/// Runs a scenario on the simulated board, in virtual time.
pub fn simulate(file: &File) -> anyhow::Result<()> {
    let samples = found!(samples(&file.scenario)?);
    let model = model(file.scenario.model);
    let other = file.scenario.install.as_deref().map(model_file);
    let ran = simulation::run(&Inputs {
        scenario: &file.text,
        model: &model,
        samples: &samples,
        page: &page(file.scenario.page),
        calibration: &[],
        install: other.as_deref(),
    })?;
    let checked = file.scenario.expect.check(&model, &samples, &ran);
    checked.with_context(|| ran.tails())?;
    if file.scenario.expect.installed {
        ensure!(
            ran.region.starts_with(&other.unwrap_or_default()),
            "the region does not hold the file"
        );
    }
    Ok(())
}

/// Reads or generates the armband's samples; returns `None` where the recordings are missing.
pub fn samples(scenario: &Scenario) -> anyhow::Result<Option<Vec<Sample>>> {
    let count = (scenario.seconds * 200.0).round() as usize;
    let Some(recording) = &scenario.recording else {
        return Ok(Some(Noise(5).efforts().take(count).collect()));
    };
    let path = found!(myointent_tests::recorded(recording), None);
    let mut samples = myointent::cli::replay::recording_of(&path, None, false)?.samples;
    ensure!(
        samples.len() >= count,
        "{} has {} samples, not {count}",
        path.display(),
        samples.len()
    );
    samples.truncate(count);
    Ok(Some(samples))
}

/// Returns the content of the model's region.
pub fn model(content: Content) -> Vec<u8> {
    written(model_file("three-class"), content)
}

/// Returns the content of the page of the bound armband.
pub fn page(content: Content) -> Vec<u8> {
    written(binding::to_record(ADDRESS).to_vec(), content)
}

fn written(mut bytes: Vec<u8>, content: Content) -> Vec<u8> {
    if content == Content::Erased {
        bytes.fill(0xff);
    }
    bytes
}
