//! Events of a stream: the lines that a board writes.

use pyo3::prelude::*;
use shared::uart_line::line::Line;
use shared::uart_line::{Report, ReportKind};

/// A line that a board would write (docs/uart.md): a label, a change of state or progress of an alignment.
#[pyclass(frozen, module = "myointent")]
pub struct Event(pub Line<'static>);

impl Event {
    const fn report(&self) -> Option<&Report> {
        match &self.0 {
            Line::Report(report) => Some(report),
            _ => None,
        }
    }
}

#[pymethods]
impl Event {
    /// The line, byte for byte, CR LF included; without the strength, which a board writes on request.
    #[getter]
    fn line(&self) -> String {
        match self.0 {
            Line::Report(report) => report.without_strength().to_string(),
            line => line.to_string(),
        }
    }

    /// `"label"`, `"state"` or `"alignment"`.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.report().map(|report| report.kind) {
            Some(ReportKind::Label) => "label",
            Some(ReportKind::State) => "state",
            None => "alignment",
        }
    }

    /// Label at the pins, relax while the output is not valid; None for an alignment.
    #[getter]
    fn label(&self) -> Option<&'static str> {
        Some(self.report()?.status.label().name())
    }

    /// Whether the label is valid; None for an alignment.
    #[getter]
    fn valid(&self) -> Option<bool> {
        Some(self.report()?.status.valid())
    }

    /// Strength of the contraction in percent of the wearer's own range, 0 with relax; None for an alignment.
    #[getter]
    fn strength(&self) -> Option<u8> {
        Some(self.report()?.strength?.get())
    }

    /// Cause of the safe state; None while the label is valid, and for an alignment.
    #[getter]
    fn cause(&self) -> Option<&'static str> {
        Some(self.report()?.status.cause()?.name())
    }

    /// State of the alignment, such as `"aligned"`; None for a label or a change of state.
    #[getter]
    fn alignment(&self) -> Option<&'static str> {
        match &self.0 {
            Line::Alignment(report) => Some(report.state.name()),
            _ => None,
        }
    }

    /// Index of the sample that the label is for; None for an alignment.
    #[getter]
    fn instant(&self) -> Option<u32> {
        Some(self.report()?.instant.0)
    }

    /// Index of the newest sample when the line was written; samples are 5 ms apart.
    #[getter]
    fn emitted(&self) -> Option<u32> {
        match &self.0 {
            Line::Report(report) => Some(report.emitted.0),
            Line::Alignment(report) => Some(report.emitted.0),
            _ => None,
        }
    }

    fn __repr__(&self) -> String {
        format!("<Event {}>", self.line().trim_end())
    }
}
