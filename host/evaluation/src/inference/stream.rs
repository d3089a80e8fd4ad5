//! A stream through the device's own pipeline, and the lines that a board writes.

use std::ops::ControlFlow;

use shared::calibration::Memory;
use shared::model::Encode;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::model::head::Head;
use shared::pipeline::{ModelInput, Pipeline, Smoother};
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::lock::LockTimes;
use shared::stream::smoother::SettingsError;
use shared::uart_line::Report;
use shared::uart_line::calibration::{CalibrationReport, CalibrationState, Recalls};
use shared::uart_line::line::Line;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample};

use crate::EvaluationError;

/// Samples of a notification of the armband.
const TOGETHER: u64 = 2;
/// Milliseconds in which an nRF52840 erases a page, 85, and writes the record of a calibration, 41 µs a word.
const FLASH_MS: u32 = 103;

/// Stream of an armband, two samples every 10 ms, to a board that starts with the first sample.
pub struct Stream<'s> {
    pipeline: Pipeline<'s, HostEncoder<'s>>,
    /// Line of the start, until it is written.
    start: Option<Report>,
    count: u64,
    calibration: Option<WearerCalibration<'s>>,
}

/// Calibration of the stream's wearer, who follows its cues.
struct WearerCalibration<'s> {
    /// Samples before it begins.
    at: u64,
    others: bool,
    /// The model as it is put in use again; its head is replaced.
    encoder: HostEncoder<'s>,
    smoother: Smoother,
    input: ModelInput,
    recalls: Option<Recalls>,
    /// Place of the head that is used.
    kept: Option<&'s mut Head>,
    /// Memory with a head that was learnt, and since when it is written to flash.
    learnt: Option<(&'s mut Memory, Millis)>,
}

impl<'s> Stream<'s> {
    /// A stream before its first sample; `encoder` is that of the model. With `align`, an alignment begins with the
    /// first sample.
    pub fn new(
        model: &Model<'_>,
        encoder: HostEncoder<'s>,
        state: &'s mut <HostEncoder<'s> as Encode>::State,
        align: Option<Arm>,
    ) -> Result<Self, SettingsError> {
        let mut pipeline = Pipeline::of_model(model, encoder, state)?;
        let start = Some(pipeline.state_report());
        if let Some(arm) = align {
            pipeline.begin_alignment(arm);
        }
        Ok(Self {
            pipeline,
            start,
            count: 0,
            calibration: None,
        })
    }

    /// Locks the labels until the wearer's sign, with the usual times.
    pub fn lock(&mut self) {
        self.pipeline.set_lock(Some(LockTimes::USUAL));
    }

    /// Takes the next samples, any number of them. `wait` is called with the time of each notification before it is taken.
    /// `output` is called with each line that a board writes, a report or a change of alignment or calibration, until it breaks off.
    pub fn push<B>(
        &mut self,
        samples: &[Sample],
        mut wait: impl FnMut(Millis),
        mut output: impl FnMut(Line<'static>) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        if let Some(report) = self.start.take() {
            output(Line::Report(report))?;
            self.news(&mut output)?;
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
                self.calibrate_at(now, &mut output)?;
            }
            self.count += 1;
            for report in self.pipeline.sample(now, sample) {
                output(Line::Report(report))?;
            }
            self.news(&mut output)?;
            self.keep(now);
        }
        ControlFlow::Continue(())
    }

    /// Writes what is new about alignment and calibration.
    fn news<B>(
        &mut self,
        output: &mut impl FnMut(Line<'static>) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        if let Some(report) = self.pipeline.take_alignment_report() {
            output(Line::Alignment(report))?;
        }
        match self.pipeline.take_calibration_report() {
            Some(report) => {
                if let Some(own) = &mut self.calibration {
                    own.recalls = report.recalls;
                }
                output(Line::Calibration(report))
            }
            None => ControlFlow::Continue(()),
        }
    }

    /// Begins the calibration, and puts its result in use once flash holds it, before the notification of this time.
    fn calibrate_at<B>(
        &mut self,
        now: Millis,
        output: &mut impl FnMut(Line<'static>) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let Some(own) = &mut self.calibration else {
            return ControlFlow::Continue(());
        };
        if own.at.next_multiple_of(TOGETHER) == self.count {
            match self
                .pipeline
                .begin_calibration(now, own.others, Arm::Unknown)
            {
                Some(reports) => {
                    for report in reports {
                        output(Line::Report(report))?;
                    }
                }
                None => {
                    let report = CalibrationReport::of(CalibrationState::Unavailable, None);
                    output(Line::Calibration(report))?;
                }
            }
            return self.news(output);
        }
        let is_kept = |(_, since): &mut (_, Millis)| now.elapsed_since(*since) >= FLASH_MS;
        if let Some((memory, _)) = own.learnt.take_if(is_kept)
            && let Some(head) = own.kept.take()
        {
            head.clone_from(memory.head());
            own.input.alignment = memory.alignment();
            self.pipeline.lend(memory);
            let encoder = own.encoder.with_head(head);
            let smoother = own.smoother.clone();
            self.pipeline.resume(now, encoder, smoother, own.input);
            let recalls = own.recalls;
            return output(Line::Calibration(CalibrationReport {
                recalls,
                ..CalibrationReport::of(CalibrationState::Done, None)
            }));
        }
        ControlFlow::Continue(())
    }

    /// Gives up the model while flash is written, if a head was learnt. The state is safe already.
    fn keep(&mut self, now: Millis) {
        if let (Some(memory), Some(own)) = (self.pipeline.take_learnt(), &mut self.calibration) {
            own.learnt = Some((memory, now));
            let _ = self.pipeline.suspend(now);
        }
    }

    /// Begins a calibration after so many samples, rounded up to a notification; with other movement if wanted. The wearer
    /// follows the cues that are written. To be called before the first sample, with the stream's model.
    pub fn calibrate(
        &mut self,
        model: &Model<'s>,
        at: u64,
        others: bool,
        (memory, kept): &'s mut (Memory, Head),
    ) -> Result<(), EvaluationError> {
        let encoder = HostEncoder::new(model)?;
        self.pipeline.lend(memory);
        self.calibration = Some(WearerCalibration {
            at,
            others,
            smoother: Smoother::new(model.header.smoother.in_patches(), encoder.classes())?,
            encoder,
            input: ModelInput {
                preprocessing: model.header.preprocessing,
                template: model.header.template,
                alignment: Alignment::NONE,
            },
            recalls: None,
            kept: Some(kept),
            learnt: None,
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::model::encoder::HostEncoder;
    use shared::model::file::random::{SMALL, random_model};

    #[test]
    fn pieces_of_any_size_give_the_same_lines_and_times() {
        let bytes = random_model(SMALL, 1).to_bytes().unwrap();
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
