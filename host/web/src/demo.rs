//! Demo: whom it simulates, and what that person is asked for.

use recordings::synthetic::{self, Follower, SynthOptions};
use shared::intent::Intent;

/// Number of the simulated person: the first whom the shipped model recognises in every gesture, and whose openings of the
/// hand align as the armband sits.
const PERSON: usize = 14;

/// The simulated person, at rest.
pub fn follower() -> Follower {
    Follower::new(&format!("s{PERSON}"))
}

/// A minute of cues: rests and gestures of random length.
pub fn cues() -> Vec<Intent> {
    let options = SynthOptions {
        recordings: 1,
        ..SynthOptions::default()
    };
    let recording = synthetic::generate_person(&options, PERSON).remove(0);
    recording.labels.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use evaluation::{EvaluatedRecording, LookAhead, gestures, integer_candidate};
    use recordings::Recording;
    use recordings::labels::compensation::Compensation;
    use shared::intent::Vocabulary;
    use shared::model::encoder::HostEncoder;
    use shared::model::file::Model;
    use shared::pipeline::{AlignmentPhase, Pipeline};
    use shared::stream::alignment::{Alignment, Arm};
    use shared::uart_line::alignment::AlignmentState;
    use shared::units::{Millis, SAMPLE_PERIOD_MS, SampleIndex};

    use super::*;
    use crate::SHIPPED;
    use crate::person::{Cues, DemoPerson};

    /// Minutes of the demo that are looked at.
    const MINUTES: usize = 3;

    fn person() -> DemoPerson {
        DemoPerson::new(follower(), Cues::List(cues()))
    }

    /// Records the demo.
    fn recorded() -> Recording {
        let (mut person, minute) = (person(), cues().len());
        let options = SynthOptions {
            recordings: 1,
            ..SynthOptions::default()
        };
        let mut recording = synthetic::generate_person(&options, PERSON).remove(0);
        recording.samples.clear();
        recording.labels.clear();
        for index in 0..MINUTES * minute {
            let ([sample], [cue]) = person.next(SampleIndex(index as u32));
            recording.samples.push(sample);
            recording.labels.push(cue);
        }
        recording
    }

    #[test]
    fn the_shipped_model_recognises_every_gesture_of_the_demo() {
        let (recording, vocabulary) = (recorded(), Vocabulary::Three);
        let compensation = Compensation::EachCue;
        let recordings = [EvaluatedRecording::new(
            &recording,
            |_| {},
            vocabulary,
            compensation,
        )];
        let file = SHIPPED.to_vec();
        let model = Model::parse(&file).unwrap();
        let candidate = integer_candidate("shipped", &model, &recordings).unwrap();
        let made = gestures(&candidate, &recordings, vocabulary, LookAhead::AllRows).unwrap();
        let missed = made.iter().filter(|gesture| gesture.latency.is_none());
        assert_eq!((missed.count(), made.len() > 24), (0, true), "{made:?}");
    }

    /// Placement that an alignment finds which is begun with a sample of the demo.
    ///
    /// # Errors
    /// State in which it ends otherwise.
    fn aligned(begin: u32) -> Result<Alignment, AlignmentState> {
        let file = SHIPPED.to_vec();
        let model = Model::parse(&file).unwrap();
        let encoder = HostEncoder::new(&model).unwrap();
        let mut state = encoder.fresh();
        let mut pipeline = Pipeline::of_model(&model, encoder, &mut state).unwrap();
        let mut person = person();
        for index in (0..).map(SampleIndex) {
            let is_aligning = pipeline.alignment_phase() == AlignmentPhase::Waiting;
            if person.align(is_aligning) || index.0 == begin {
                pipeline.begin_alignment(Arm::Unknown);
            }
            let ([sample], _) = person.next(index);
            let now = Millis(index.0 * SAMPLE_PERIOD_MS);
            let _ = pipeline.sample(now, sample);
            match pipeline.take_alignment_report().map(|report| report.state) {
                None | Some(AlignmentState::Waiting) => {}
                Some(AlignmentState::Aligned) => return Ok(pipeline.alignment()),
                Some(failed) => return Err(failed),
            }
        }
        unreachable!("an alignment ends after 30 s");
    }

    #[test]
    fn an_alignment_of_the_demo_finds_the_armband_as_it_sits() {
        // In rest and in gestures.
        for begin in (1000..12_000).step_by(1375) {
            assert_eq!(aligned(begin), Ok(Alignment::NONE), "begun with {begin}");
        }
    }
}
