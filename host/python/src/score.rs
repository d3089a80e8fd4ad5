//! Scores of any predicted labels.

use evaluation::label_score::{Emission, LabelScore};
use evaluation::metric::transition::Rule;
use pyo3::prelude::*;
use recordings::labels::motion::Motion;
use shared::intent::Intent;

use crate::arrays::motions;
use crate::failure::told;
use crate::report::Report;

/// Scores one recording's predicted labels, of any program, against the true ones, as `myointent score` does.
///
/// Labels are class numbers (0 relax, 1 open, 2 close, 3 wave-in, 4 wave-out, 5 pinch; -1 none; -2 other movement) or
/// names, one a sample at 200 Hz.
///
/// Args:
///     truth: True labels, shape (n,).
///     prediction: Predicted labels, shape (n,), each at the time that it is for. Samples after the last prediction are
///         not scored.
///     emitted: Predicted labels, shape (n,), each at the time when it is emitted: for latencies and false activations.
///     delay: Samples (5 ms) from the place of a predicted label to its emission, where `emitted` is not given.
///     buffer: Width of the buffer around a transition, both sides together, in samples.
///     strict: After the new label, allow no other.
///     allow_relax: Allow relax in the buffer and while the new label is held.
#[pyfunction]
#[pyo3(signature = (truth, prediction, *, emitted = None, delay = 0, buffer = Rule::default().buffer, strict = false, allow_relax = false))]
#[expect(clippy::too_many_arguments, reason = "keywords in Python")]
pub fn score(
    py: Python<'_>,
    truth: &Bound<'_, PyAny>,
    prediction: &Bound<'_, PyAny>,
    emitted: Option<&Bound<'_, PyAny>>,
    delay: usize,
    buffer: usize,
    strict: bool,
    allow_relax: bool,
) -> PyResult<Report> {
    let labels = |labels| -> PyResult<Vec<Option<Intent>>> {
        Ok(motions(labels)?.into_iter().map(Motion::label).collect())
    };
    let truth = motions(truth)?.into_iter().collect();
    let emission = match emitted {
        Some(emitted) => Emission::Labels(labels(emitted)?),
        None => Emission::After(delay),
    };
    let rule = Rule {
        buffer,
        strict,
        allow_relax,
    };
    let score = LabelScore::new(&truth, &labels(prediction)?, emission, rule).map_err(told)?;
    Report::of(py, &score.json(), score.tables())
}
