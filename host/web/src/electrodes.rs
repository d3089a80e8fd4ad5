//! Check of the electrodes while the stream runs: the fault of each in the last seconds.

use recordings::examiner::electrodes::{Fault, faults};
use shared::units::{CHANNELS, Sample};

use crate::event::Event;

/// Samples of a check: 5 s, in which a person does something.
const SPAN: usize = 1000;

/// Check of the electrodes of a stream.
#[derive(Debug, Default)]
pub struct Electrodes {
    samples: Vec<Sample>,
    known: [Option<Fault>; CHANNELS],
}

impl Electrodes {
    /// Takes an event of the stream. Returns the faults when they change.
    pub fn take(&mut self, event: &Event) -> Option<Event> {
        match event {
            Event::Samples { emg, .. } => self.samples.extend(emg),
            Event::Source {
                connected: false, ..
            } => self.samples.clear(),
            _ => {}
        }
        if self.samples.len() < SPAN {
            return None;
        }
        let found = faults(&self.samples);
        self.samples.clear();
        let before = std::mem::replace(&mut self.known, found);
        (before != found).then(|| Event::Electrodes {
            faults: found.map(|fault| fault.map(Fault::name)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use recordings::synthetic::{self, SynthOptions};

    #[test]
    fn an_electrode_without_contact_one_that_clips_and_one_with_hum_are_named_once() {
        let options = SynthOptions {
            subjects: 1,
            recordings: 1,
            seconds: 20,
            ..SynthOptions::default()
        };
        let mut samples = synthetic::generate(&options).remove(0).samples;
        let said = |samples: &[Sample], check: &mut Electrodes| -> Vec<Event> {
            let events = samples.chunks(2).map(|emg| Event::Samples {
                at: 0.0,
                first: 0,
                emg: emg.to_vec(),
                truth: None,
            });
            events.filter_map(|event| check.take(&event)).collect()
        };
        let mut check = Electrodes::default();
        assert_eq!(said(&samples, &mut check), []);
        for (at, sample) in samples.iter_mut().enumerate() {
            sample[2] = 0;
            sample[4] = if at % 20 == 0 { i8::MAX } else { sample[4] };
            let hum = 60.0 * (std::f64::consts::TAU * 50.0 * at as f64 / 200.0 + 0.5).sin();
            sample[6] = sample[6].saturating_add(hum as i8);
        }
        let mut faults = [None; CHANNELS];
        (faults[2], faults[4], faults[6]) = (Some("silent"), Some("clipped"), Some("hum"));
        let expected = Event::Electrodes { faults };
        assert_eq!(said(&samples, &mut check), [expected]);
    }
}
