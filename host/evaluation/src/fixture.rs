//! Labels for tests.

use shared::intent::Intent;

/// Label of a sample, if it has one.
type Label = Option<Intent>;

pub(crate) const R: Label = Some(Intent::Relax);
pub(crate) const O: Label = Some(Intent::Open);
pub(crate) const C: Label = Some(Intent::Close);

/// Labels of runs, each of so many samples.
pub(crate) fn labels(runs: &[(Label, usize)]) -> Vec<Label> {
    let runs = runs.iter();
    runs.flat_map(|&(label, samples)| vec![label; samples])
        .collect()
}
