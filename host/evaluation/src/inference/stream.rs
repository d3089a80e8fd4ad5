//! A stream through the device's own pipeline, and the lines that a board writes.

use std::ops::ControlFlow;

use shared::model::Encode;
use shared::model::file::Model;
use shared::pipeline::Pipeline;
use shared::stream::alignment::Arm;
use shared::stream::lock::LockTimes;
use shared::stream::smoother::SettingsError;
use shared::uart_line::Report;
use shared::uart_line::line::Line;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample};

use super::pipeline;

/// Samples of a notification of the armband.
const TOGETHER: u64 = 2;

/// Stream of an armband, two samples every 10 ms, to a board that starts with the first sample.
pub struct Stream<'s, E: Encode> {
    pipeline: Pipeline<'s, E>,
    /// Line of the start, until it is written.
    start: Option<Report>,
    /// Samples so far.
    count: u64,
}

impl<'s, E: Encode> Stream<'s, E> {
    /// A stream before its first sample; `encoder` is that of the model. With `align`, an alignment begins with the
    /// first sample.
    ///
    /// # Errors
    /// When the smoother refuses the settings of the model.
    pub fn new(
        model: &Model<'_>,
        encoder: E,
        state: &'s mut E::State,
        align: Option<Arm>,
    ) -> Result<Self, SettingsError> {
        let mut pipeline = pipeline(model, encoder, state)?;
        let start = Some(pipeline.state_report());
        if let Some(arm) = align {
            pipeline.begin_alignment(arm);
        }
        Ok(Self {
            pipeline,
            start,
            count: 0,
        })
    }

    /// Locks the labels until the wearer's sign, with the usual times.
    pub fn lock(&mut self) {
        self.pipeline.set_lock(Some(LockTimes::USUAL));
    }

    /// Takes the next samples, any number of them. `wait` is called with the time of each notification before it is taken.
    /// `output` is called with each line that a board writes, a report or a change of the alignment, until it breaks off.
    pub fn push<B>(
        &mut self,
        samples: &[Sample],
        mut wait: impl FnMut(Millis),
        mut output: impl FnMut(Line<'static>) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        if let Some(report) = self.start.take() {
            output(Line::Report(report))?;
            self.alignment(&mut output)?;
        }
        for &sample in samples {
            let notification = self.count / TOGETHER * TOGETHER;
            #[expect(
                clippy::cast_possible_truncation,
                reason = "a device's clock wraps too"
            )]
            let now = Millis((notification * u64::from(SAMPLE_PERIOD_MS)) as u32);
            if self.count == notification {
                wait(now);
            }
            self.count += 1;
            for report in self.pipeline.sample(now, sample) {
                output(Line::Report(report))?;
            }
            self.alignment(&mut output)?;
        }
        ControlFlow::Continue(())
    }

    fn alignment<B>(
        &mut self,
        output: &mut impl FnMut(Line<'static>) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        match self.pipeline.take_alignment_report() {
            Some(report) => output(Line::Alignment(report)),
            None => ControlFlow::Continue(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::intent::Vocabulary;
    use shared::model::dimensions::Dimensions;
    use shared::model::encoder::HostEncoder;
    use shared::model::file::random::random_model;

    #[test]
    fn pieces_of_any_size_give_the_same_lines_and_times() {
        let dimensions = Dimensions {
            width: 16,
            layers: 1,
            span: 5,
            vocabulary: Vocabulary::Three,
            other: false,
        };
        let bytes = random_model(dimensions, 1).to_bytes().unwrap();
        let model = Model::parse(&bytes).unwrap();
        let sample = |at: i32| [0, 1, 2, 3, 4, 5, 6, 7].map(|k| (at * (k + 3) % 251 - 125) as i8);
        let samples: Vec<Sample> = (0..3001).map(sample).collect();
        let pushed = |piece: usize| {
            let encoder = HostEncoder::new(&model).unwrap();
            let mut state = encoder.fresh();
            let arm = Some(Arm::Unknown);
            let mut stream = Stream::new(&model, encoder, &mut state, arm).unwrap();
            let (mut times, mut lines) = (Vec::new(), String::new());
            for samples in samples.chunks(piece) {
                let ended: ControlFlow<()> = stream.push(
                    samples,
                    |now| times.push(now),
                    |line| {
                        lines += &line.to_string();
                        ControlFlow::Continue(())
                    },
                );
                assert!(ended.is_continue());
            }
            (times, lines)
        };
        let whole = pushed(samples.len());
        assert_eq!(whole.0.len(), 1501);
        assert_eq!(whole.0[1500], Millis(15_000));
        assert!(whole.1.lines().count() > 100, "{}", whole.1);
        for piece in [1, 2, 7, 64] {
            assert_eq!(pushed(piece), whole, "{piece}");
        }
    }
}
