//! A recording or a simulated person, through the device's pipeline.

use std::time::Duration;

use recordings::labels::motion::Motion;
use shared::intent::Intent;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample, SampleIndex};

use crate::event::Event;
use crate::person::DemoPerson;
use crate::request::SourceRequest;
use crate::scored_pipeline::ScoredPipeline;

/// Samples in one notification of the armband.
const TOGETHER: usize = 2;

/// Time between two notifications.
pub const PERIOD: Duration = Duration::from_millis(TOGETHER as u64 * SAMPLE_PERIOD_MS as u64);

/// Longest delay that is caught up with; after a longer one, time continues from now.
pub const LATE: Duration = Duration::from_millis(500);

/// Source of the samples.
#[derive(Debug)]
pub enum SampleSource {
    /// Recording, repeated.
    Recording {
        /// Samples, at least one.
        samples: Vec<Sample>,
        /// Labels, one for each sample.
        labels: Vec<Option<Intent>>,
    },
    /// Simulated person who does what is asked for.
    Person(Box<DemoPerson>),
}

/// Samples of a notification.
struct Notification {
    emg: Vec<Sample>,
    truth: Option<Vec<Option<&'static str>>>,
    /// Whether a recording begins again with it.
    again: bool,
}

impl SampleSource {
    /// Returns at most a notification of samples, from `first` on.
    fn next(&mut self, first: SampleIndex) -> Notification {
        match self {
            Self::Recording { samples, labels } => {
                let offset = first.0 as usize % samples.len();
                let range = offset..samples.len().min(offset + TOGETHER);
                let truth = &labels[range.clone()];
                let names = || truth.iter().map(|label| label.map(Intent::name)).collect();
                Notification {
                    emg: samples[range].to_vec(),
                    truth: truth.iter().any(Option::is_some).then(names),
                    again: offset == 0 && first.0 > 0,
                }
            }
            Self::Person(person) => {
                let (emg, cues) = person.next::<TOGETHER>(first);
                let names = || cues.map(|cue| cue.map(Intent::name)).to_vec();
                Notification {
                    emg: emg.to_vec(),
                    truth: cues.iter().any(Option::is_some).then(names),
                    again: false,
                }
            }
        }
    }

    /// Tells a person whether an alignment is in progress, and what a calibration or a task asks for. Returns whether the alignment has to
    /// begin anew, because the person has come to rest: one that begins in a gesture could take that for an opening.
    fn ask(&mut self, is_aligning: bool, calibration: Option<Intent>) -> bool {
        match self {
            Self::Recording { .. } => false,
            Self::Person(person) => {
                person.calibrate(calibration);
                person.align(is_aligning)
            }
        }
    }
}

/// Samples and the pipeline that labels them.
pub struct Playback {
    samples: SampleSource,
    scored: ScoredPipeline,
    next: SampleIndex,
    /// Hand that a task asks for.
    task: Option<Intent>,
}

impl Playback {
    /// State before the first sample. Emits the source, the model and the pipeline's state.
    pub fn begin(
        (kind, name): (&'static str, String),
        samples: SampleSource,
        mut scored: ScoredPipeline,
        at: f64,
        emit: &mut dyn FnMut(Event),
    ) -> Self {
        emit(Event::Source {
            kind,
            name,
            connected: true,
            detail: None,
            steps: Vec::new(),
        });
        emit(Event::of_model(scored.model()));
        emit(Event::of_report(at, &scored.state_report()));
        Self {
            samples,
            scored,
            next: SampleIndex(0),
            task: None,
        }
    }

    /// Does what is asked for, but for [`SourceRequest::Turn`].
    pub fn request(&mut self, at: f64, request: SourceRequest, emit: &mut dyn FnMut(Event)) {
        self.scored.request(self.now(), at, request, emit);
    }

    /// Simulated person; none for a recording.
    pub fn person(&mut self) -> Option<&mut DemoPerson> {
        match &mut self.samples {
            SampleSource::Recording { .. } => None,
            SampleSource::Person(person) => Some(person),
        }
    }

    /// Runs another model. Emits it and the pipeline's state.
    pub fn set_model(&mut self, at: f64, scored: ScoredPipeline, emit: &mut dyn FnMut(Event)) {
        self.scored.replace(self.now(), at, scored, emit);
    }

    /// Tells a simulated person what a session asks for, and a task.
    pub fn ask(&mut self, session: Option<Motion>, task: Option<Intent>) {
        self.task = task;
        if let (SampleSource::Person(person), Some(cue)) = (&mut self.samples, session) {
            person.ask(cue);
        }
    }

    /// Time of the device's clock, which starts with the first sample.
    const fn now(&self) -> Millis {
        Millis(self.next.0.wrapping_mul(SAMPLE_PERIOD_MS))
    }

    /// Emits the samples of the next notification, and what the pipeline makes of them.
    pub fn step(&mut self, at: f64, emit: &mut dyn FnMut(Event)) {
        let is_aligning = self.scored.is_aligning();
        let cue = self.scored.cue().or(self.task);
        if self.samples.ask(is_aligning, cue) {
            self.scored.begin_alignment();
        }
        let Notification { emg, truth, again } = self.samples.next(self.next);
        if again {
            let text = "the recording begins again".to_owned();
            let sample = self.next.0;
            emit(Event::Mark { sample, text });
        }
        emit(Event::Samples {
            at,
            first: self.next.0,
            emg: emg.clone(),
            truth,
        });
        let now = self.now();
        for sample in emg {
            let output = self.scored.sample(now, at, self.next, sample);
            output.events(at, emit);
            self.next = self.next.plus(1);
        }
    }
}
