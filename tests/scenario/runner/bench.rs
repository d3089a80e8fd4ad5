//! Boards that a scenario runs on.

use std::path::Path;

use anyhow::{Context as _, ensure};
use myointent_tests::simulation::{self, Inputs};
use myointent_tests::{found, model_file};
use shared::model::noise::Noise;
use shared::myo::binding;
use shared::units::Sample;
use virtual_armband::ADDRESS;

use super::expectation::Models;
use super::file::{File, Page, Scenario, ScenarioModel, Signal};

/// Runs a scenario on the simulated board, in virtual time.
pub fn simulate(file: &File, program: &Path) -> anyhow::Result<()> {
    let samples = found!(samples(&file.scenario)?);
    let model = model(&file.scenario.model);
    let other = file.scenario.install.as_deref().map(model_file);
    let ran = simulation::run(
        program,
        &Inputs {
            scenario: &file.text,
            model: &model,
            samples: &samples,
            page: &page(file.scenario.page),
            calibration: &[],
            install: other.as_deref(),
        },
    )?;
    let models = Models {
        first: &model,
        other: other.as_deref().unwrap_or_default(),
    };
    let checked = file.scenario.expect.check(models, &samples, &ran);
    checked.with_context(|| ran.tails())?;
    if file.scenario.expect.installed {
        ensure!(
            ran.region.starts_with(models.other),
            "the region does not hold the file"
        );
    }
    Ok(())
}

/// Reads or generates the armband's samples; returns `None` where the recordings are missing.
pub fn samples(scenario: &Scenario) -> anyhow::Result<Option<Vec<Sample>>> {
    let count = (scenario.seconds * 200.0).round() as usize;
    let Some(recording) = &scenario.recording else {
        return Ok(Some(synthetic(scenario.signal, count)));
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

fn synthetic(signal: Signal, count: usize) -> Vec<Sample> {
    let mut noise = Noise(5);
    match signal {
        Signal::Effort => noise.efforts().take(count).collect(),
        Signal::Rest => (0..count).map(|_| noise.sample(3.0)).collect(),
        Signal::Saturated => {
            let mut limit = || {
                if noise.signed() < 0.0 {
                    i8::MIN
                } else {
                    i8::MAX
                }
            };
            (0..count).map(|_| [(); 8].map(|()| limit())).collect()
        }
        Signal::Constant => vec![[7; 8]; count],
    }
}

/// Returns the content of the model's region.
pub fn model(model: &ScenarioModel) -> Vec<u8> {
    let mut bytes = model_file("three-class");
    let middle = bytes.len() / 2;
    match model {
        ScenarioModel::Shipped => {}
        ScenarioModel::Erased => bytes.fill(0xff),
        ScenarioModel::Half => bytes.truncate(middle),
        ScenarioModel::FlippedBit => bytes[middle] ^= 1,
        ScenarioModel::AnotherVersion => bytes[8] += 1,
    }
    bytes
}

/// Returns the content of the page of the bound armband.
pub fn page(page: Page) -> Vec<u8> {
    let mut record = binding::to_record(ADDRESS).to_vec();
    match page {
        Page::Bound => {}
        Page::Erased => record.fill(0xff),
        Page::HalfWritten => record[12..].fill(0xff),
        Page::FlippedBit => record[6] ^= 1,
    }
    record
}
