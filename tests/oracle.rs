//! The lines that a device must write: the shared pipeline, run on the PC with what the armband did.

use shared::model::Encode;
use shared::model::encoder::DeviceEncoder;
use shared::model::file::Model;
use shared::pipeline::{Pipeline, Reports};
use shared::stream::alignment::Arm;
use shared::stream::smoother::Gate;
use shared::uart_line::Report;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample};

/// Event that reaches the pipeline.
#[derive(Clone, Copy, Debug)]
pub enum Input<'s> {
    /// Samples, one after the other.
    Samples(&'s [Sample]),
    /// This number of samples is missing.
    Gap(u32),
    /// The connection has ended.
    Disconnected,
    /// Silence of this many milliseconds, in which nothing arrives.
    Silence(Millis),
    /// The button is pressed, or a command begins an alignment that is told this of the arm.
    Align(Arm),
    /// A command changes the confidence gate.
    SetGate(Gate),
    /// A command switches the strength on lines.
    Strength(bool),
}

/// The lines for these inputs, the first one at boot.
pub fn expected_lines(model: &[u8], inputs: &[Input<'_>]) -> anyhow::Result<Vec<String>> {
    let model = Model::parse(model)?;
    let encoder = DeviceEncoder::new(&model)?;
    let mut state = encoder.fresh();
    let mut pipeline = Pipeline::of_model(&model, encoder, &mut state)?;
    let mut lines = Lines::default();
    lines.write(pipeline.state_report());
    let mut now = Millis(0);
    for input in inputs {
        let reports = match *input {
            Input::Samples(samples) => {
                for &sample in samples {
                    now = now.plus(SAMPLE_PERIOD_MS);
                    let reports = pipeline.sample(now, sample);
                    lines.add(&mut pipeline, reports);
                }
                continue;
            }
            Input::Gap(missing) => pipeline.gap(now, missing),
            Input::Disconnected => pipeline.disconnected(now),
            Input::Silence(long) => {
                now = now.plus(long.0);
                pipeline.tick(now)
            }
            Input::SetGate(gate) => {
                anyhow::ensure!(pipeline.set_gate(gate), "a margin that the model has not");
                Reports::default()
            }
            Input::Strength(on) => {
                lines.have_strength = on;
                Reports::default()
            }
            Input::Align(arm) => {
                pipeline.begin_alignment(arm);
                Reports::default()
            }
        };
        lines.add(&mut pipeline, reports);
    }
    Ok(lines.written)
}

#[derive(Default)]
struct Lines {
    written: Vec<String>,
    have_strength: bool,
}

impl Lines {
    fn write(&mut self, report: Report) {
        let plain = report.without_strength();
        let report = if self.have_strength { report } else { plain };
        self.written.push(report.to_string());
    }

    /// Adds the reports of a call, then what is new about the alignment.
    fn add<E: Encode>(&mut self, pipeline: &mut Pipeline<'_, E>, reports: Reports) {
        reports.into_iter().for_each(|report| self.write(report));
        let news = pipeline.take_alignment_report();
        self.written.extend(news.map(|report| report.to_string()));
    }
}
