//! Contenders of a cross-validation, from its arguments.

use anyhow::bail;
use presets::Preset;

use super::Arguments;
use crate::baselines::Baseline;
use crate::cross_validation::{Contender, ContenderKind};

/// Loads the presets, whose names are folders.
pub(super) fn presets(arguments: &Arguments) -> anyhow::Result<Vec<Preset>> {
    let mut presets: Vec<Preset> = Vec::new();
    for name in &arguments.preset {
        let preset = Preset::find(name)?;
        if presets.iter().any(|other| other.name == preset.name) {
            bail!(
                "two presets have the name {:?}: change `name` in one of them",
                preset.name
            );
        }
        presets.push(preset);
    }
    let classes = presets[0].classes;
    if let Some(other) = presets.iter().find(|preset| preset.classes != classes) {
        bail!(
            "{} has {classes} classes and {} has {}: compare presets of one vocabulary",
            presets[0].name,
            other.name,
            other.classes
        );
    }
    Ok(presets)
}

/// Contenders: the students of the presets, the baselines, then the floors.
pub(super) fn contenders(
    presets: &[Preset],
    baselines: &[Baseline],
    only: Option<&str>,
) -> anyhow::Result<Vec<Contender>> {
    let first = &presets[0];
    let of = |preset: &Preset, kind| Contender {
        preset: preset.clone(),
        kind,
    };
    let students = presets
        .iter()
        .map(|preset| of(preset, ContenderKind::Student));
    let wanted = Baseline::ALL
        .into_iter()
        .filter(|baseline| baselines.contains(baseline));
    let others = wanted
        .map(ContenderKind::Baseline)
        .chain([ContenderKind::Constant, ContenderKind::EnergyDetector]);
    // Baselines and floors get the signal as the armband sends it.
    let mut plain = first.clone();
    plain.data.normalize = false;
    let contenders: Vec<Contender> = students
        .chain(others.map(|kind| of(&plain, kind)))
        .collect();
    for (at, contender) in contenders.iter().enumerate() {
        let folder = contender.folder();
        if contenders[..at]
            .iter()
            .any(|other| other.folder() == folder)
        {
            bail!(
                "a preset has the name {folder:?}, which is that of another folder of the comparison: change it"
            );
        }
    }
    let known: Vec<String> = contenders.iter().map(Contender::argument).collect();
    match only {
        Some(only) if !known.iter().any(|name| name == only) => {
            bail!("--only {only}: expected one of {}", known.join(", "))
        }
        _ => Ok(contenders),
    }
}
