//! Check of the electrodes while the stream runs: the fault of each in the last seconds, and how many times its rest it has reached.

use recordings::examiner::electrodes::{Fault, SATURATED, faults, levels, saturation};
use shared::units::{CHANNELS, Sample};

use crate::event::Event;

/// Samples of a check for faults: 5 s, in which a person does something.
const SPAN: usize = 1000;

/// Samples after which the strength is judged anew: 1 s.
const SECOND: usize = 200;

/// Samples whose level counts: 0.25 s.
const BLOCK: usize = 50;

/// Levels that are remembered: those of 20 s, in which a person rests and makes a fist.
const LEVELS: usize = 80;

/// Fewest levels that are judged: those of 5 s.
const FEWEST: usize = 20;

/// Level of rest in counts, at least: that of an electrode's own noise.
const NOISE: f64 = 1.0;

/// Number of levels that a gesture lifts, at least: a knock against the armband lifts one or two.
const HIGH: usize = 3;

/// Times its rest that the best electrode reaches when a person moves the hand.
const MOVED: u8 = 3;

/// Check of the electrodes of a stream.
#[derive(Debug, Default)]
pub struct Electrodes {
    samples: Vec<Sample>,
    /// Samples whose levels are taken.
    taken: usize,
    levels: Vec<[f64; CHANNELS]>,
    judged: Judged,
}

/// Judgement of the electrodes.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct Judged {
    faults: [Option<Fault>; CHANNELS],
    /// Greatest number of times its rest that each electrode has reached since the armband or a fault of an electrode came or went:
    /// another gesture does not make it weak. `None` before the hand was moved.
    times: Option<[u8; CHANNELS]>,
}

impl Electrodes {
    /// Takes an event of the stream. Returns faults and strengths when they change.
    pub fn take(&mut self, event: &Event) -> Option<Event> {
        match event {
            Event::Samples { emg, .. } => self.samples.extend(emg),
            Event::Source {
                connected: false, ..
            } => *self = Self::default(),
            _ => {}
        }
        let second = self.samples.get(self.taken..self.taken + SECOND)?;
        // One electrode that clips in a firm gesture hides no other.
        let unclipped = |block: &&[Sample]| {
            let shares = saturation(block);
            2 * shares.iter().filter(|share| **share > SATURATED).count() < CHANNELS
        };
        let blocks = second.chunks(BLOCK).filter(unclipped);
        self.levels.extend(blocks.map(levels));
        self.taken += SECOND;
        let before = self.judged;
        let old = self.levels.len().saturating_sub(LEVELS);
        self.levels.drain(..old);
        if let Some(times) = times(&self.levels) {
            let greatest = self.judged.times.get_or_insert(times);
            for (greatest, own) in greatest.iter_mut().zip(times) {
                *greatest = own.max(*greatest);
            }
        }
        if self.taken == SPAN {
            self.judged.faults = faults(&self.samples[..SPAN]);
            self.samples.drain(..SPAN);
            self.taken = 0;
            if self.judged.faults != before.faults {
                self.levels.clear();
                self.judged.times = None;
            }
        }
        (before != self.judged).then(|| Event::Electrodes {
            faults: self.judged.faults.map(|fault| fault.map(Fault::name)),
            times: self.judged.times,
        })
    }
}

/// Number of times its rest that each electrode reached: the third highest of its levels by the lowest tenth. `None` if the hand was not moved.
fn times(levels: &[[f64; CHANNELS]]) -> Option<[u8; CHANNELS]> {
    if levels.len() < FEWEST {
        return None;
    }
    let times: [u8; CHANNELS] = std::array::from_fn(|channel| {
        let mut own: Vec<f64> = levels.iter().map(|level| level[channel]).collect();
        own.sort_by(f64::total_cmp);
        (own[own.len() - HIGH] / own[own.len() / 10].max(NOISE)) as u8
    });
    times.iter().any(|own| *own >= MOVED).then_some(times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo;
    use recordings::synthetic::{self, SynthOptions};
    use shared::intent::Intent;

    /// Faults of an event that tells any.
    fn faulty(event: Event) -> Option<[Option<&'static str>; CHANNELS]> {
        match event {
            Event::Electrodes { faults, .. } if faults != [None; CHANNELS] => Some(faults),
            _ => None,
        }
    }

    /// Cues of a simulated person who is to learn the strengths, with their seconds: rest, a fist, rest.
    const FIST: [(Intent, usize); 3] = [(Intent::Relax, 6), (Intent::Close, 3), (Intent::Relax, 3)];

    /// Strengths after each second of a simulated person who does what is asked; `change` alters the sample of a number.
    fn strengths(
        asked: &[(Intent, usize)],
        change: impl Fn(usize, &mut Sample),
    ) -> Vec<Option<[u8; CHANNELS]>> {
        let (mut check, mut person) = (Electrodes::default(), demo::follower());
        let seconds = asked.iter().flat_map(|(cue, seconds)| vec![*cue; *seconds]);
        let mut known = None;
        let told = seconds.enumerate().map(|(second, cue)| {
            for index in (second * SECOND..(second + 1) * SECOND).step_by(2) {
                let mut emg = vec![person.sample(cue), person.sample(cue)];
                change(index, &mut emg[0]);
                change(index + 1, &mut emg[1]);
                let (at, first, truth) = (0.0, 0, None);
                let event = Event::Samples {
                    at,
                    first,
                    emg,
                    truth,
                };
                if let Some(Event::Electrodes { times, .. }) = check.take(&event) {
                    known = times;
                }
            }
            known
        });
        told.collect()
    }

    #[test]
    fn a_fist_after_rest_tells_how_strong_each_electrode_is_and_which_one_is_weak() {
        let good = strengths(&FIST, |_, _| ());
        assert_eq!(good[..6], [None; 6], "nothing is known at rest");
        let fist = good[9].unwrap();
        assert!(fist.iter().all(|times| *times >= 2), "{fist:?}");
        let weak = strengths(&FIST, |_, sample| {
            // One hears its own noise alone, and one has no contact.
            sample[3] = if sample[3] % 2 == 0 { 2 } else { -2 };
            sample[5] = 0;
        });
        let weak = weak[11].unwrap();
        assert_eq!((weak[3] < 2, weak[5]), (true, 0), "{weak:?}");
        assert!([0, 1, 2, 4, 6, 7].iter().all(|&other| weak[other] >= 2));
    }

    #[test]
    fn an_electrode_that_clips_in_a_fist_hides_no_other() {
        let told = strengths(&FIST, |index, sample| {
            if (6..9).contains(&(index / SECOND)) && index % 12 == 0 {
                sample[1] = 127;
            }
        });
        assert!(told[8].is_some(), "before the check for faults");
    }

    #[test]
    fn an_electrode_that_rose_once_stays_strong_whatever_other_gestures_follow() {
        let asked = [&FIST[..], &[(Intent::Relax, 25), (Intent::Close, 3)]].concat();
        let told = strengths(&asked, |index, sample| {
            // The second gesture moves two electrodes alone.
            if index > 12 * SECOND {
                sample[2..]
                    .iter_mut()
                    .for_each(|value| *value = *value / 64 + (index % 2) as i8);
            }
        });
        let (fist, last) = (told[9].unwrap(), told.last().unwrap().unwrap());
        let grows = fist
            .iter()
            .zip(&last)
            .all(|(before, after)| before <= after);
        assert!(grows, "{fist:?}, then {last:?}");
    }

    #[test]
    fn a_knock_and_a_pull_that_clips_are_no_gesture() {
        let asked = [(Intent::Relax, 20)];
        let told = |is_pulled: fn(usize) -> bool, height: i8| {
            strengths(&asked, move |index, sample| {
                if is_pulled(index) {
                    *sample = [height; CHANNELS];
                }
            })
        };
        let knock = told(|index| (1475..1525).contains(&index) && index % 2 == 0, 90);
        assert_eq!(knock, [None; 20], "a quarter of a second");
        let pull = told(
            |index| (1600..1800).contains(&index) && index % 12 == 0,
            127,
        );
        assert_eq!(pull, [None; 20]);
    }

    #[test]
    fn what_an_electrode_did_before_a_fault_came_or_went_counts_no_more() {
        let asked = [&FIST[..], &[(Intent::Relax, 20)]].concat();
        let told = strengths(&asked, |index, sample| {
            if (15 * SECOND..20 * SECOND).contains(&index) {
                sample[5] = 0;
            }
        });
        assert!(told[18].is_some());
        assert_eq!(told[19..], [None; 13]);
    }

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
        assert_eq!(
            said(&samples, &mut check).into_iter().find_map(faulty),
            None
        );
        for (at, sample) in samples.iter_mut().enumerate() {
            sample[2] = 0;
            sample[4] = if at % 20 == 0 { i8::MAX } else { sample[4] };
            let hum = 60.0 * (std::f64::consts::TAU * 50.0 * at as f64 / 200.0 + 0.5).sin();
            sample[6] = sample[6].saturating_add(hum as i8);
        }
        let mut faults = [None; CHANNELS];
        (faults[2], faults[4], faults[6]) = (Some("silent"), Some("clipped"), Some("hum"));
        let said = said(&samples, &mut check);
        let mut told: Vec<_> = said.into_iter().filter_map(faulty).collect();
        told.dedup();
        assert_eq!(told, [faults]);
    }
}
