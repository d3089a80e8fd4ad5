//! Breaks order and rhythm: the same holds and transitions, in random order and of random length.
//!
//! `roshambo` always asks rock, paper, scissor, two seconds each and one of rest: a window of 3 s
//! learns to guess the next gesture. Spliced, only the muscle tells it.
//!
//! A person's recordings, labels moved by the lag, are cut into pieces that each hold one
//! transition, from somewhere in the middle of one run to somewhere in the middle of the next.
//! Pieces are then joined at random so that labels fit: a piece that starts in label A follows one
//! that ended in A. A run of none (`scissor`) is a label like any other here, and its pieces are
//! kept: without them rest would never follow a gesture that nobody knows. Recordings of one steady
//! label (minutes of rest) go in between as random crops.
//!
//! Where nobody recorded a transition (`cote-allard`: steady holds), random crops of the holds are
//! joined instead, rest between two gestures or not. That gives the changes between open and
//! close that the public sets lack; their edges are abrupt, as no muscle is.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;

use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;

use super::{Recording, lag, runs};

/// Samples of a crop of a steady hold: 0.6 to 3 s.
const HOLD: Range<usize> = 120..601;
/// Chance that a steady recording goes on with the label at hand, before the next transition.
const STEADY: f64 = 0.3;
/// Samples of such a crop: 1 to 5 s.
const STEADY_FOR: Range<usize> = 200..1000;
/// How often rest comes between two steady gestures.
const REST_BETWEEN: f64 = 0.6;

/// What to make.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SpliceOptions {
    /// Samples of every spliced recording.
    pub samples: usize,
    /// Spliced recordings of every subject.
    pub count: usize,
    /// Samples by which the labels are moved before cutting ([`lag::shifted`]), and stay moved.
    pub lag_samples: usize,
    /// Drives every draw; a subject's draws do not depend on the other subjects.
    pub seed: u64,
}

/// Splices every subject's labelled recordings; pass recordings of one data set.
///
/// Gives `count` recordings, `spliced-0` and on, for each subject with at least one usable
/// transition or two different steady holds, in alphabetical order of subjects. Their path is
/// empty: they lie in no file.
#[must_use]
pub fn splice(recordings: &[&Recording], options: &SpliceOptions) -> Vec<Recording> {
    let mut by_subject: BTreeMap<&str, Vec<&Recording>> = BTreeMap::new();
    for recording in recordings.iter().filter(|r| r.has_labels()) {
        by_subject
            .entry(&recording.subject)
            .or_default()
            .push(recording);
    }
    let mut spliced = Vec::new();
    for (subject, recordings) in by_subject {
        let sources: Vec<Source<'_>> = recordings
            .iter()
            .map(|r| Source::new(r, options.lag_samples))
            .collect();
        let material = Material::of(&sources);
        for index in 0..options.count {
            let seed = options.seed ^ fnv(subject) ^ (index as u64).rotate_left(32);
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let Some((samples, labels)) = material.walk(options.samples, &mut random) else {
                continue;
            };
            spliced.push(Recording {
                data_set: recordings[0].data_set,
                subject: subject.to_owned(),
                name: format!("spliced-{index}"),
                path: PathBuf::new(),
                samples,
                labels,
                notes: vec![format!("spliced from {} recordings", recordings.len())],
            });
        }
    }
    spliced
}

/// A recording with the labels that the pieces carry.
struct Source<'a> {
    recording: &'a Recording,
    labels: Vec<Option<Intent>>,
}

impl<'a> Source<'a> {
    fn new(recording: &'a Recording, lag_samples: usize) -> Self {
        Self {
            recording,
            labels: lag::shifted(&recording.labels, lag_samples),
        }
    }
}

/// One transition and the places where it may be cut.
#[derive(Clone)]
struct Piece<'a> {
    source: &'a Source<'a>,
    from: Option<Intent>,
    to: Option<Intent>,
    start: Range<usize>,
    end: Range<usize>,
}

/// What a subject's recordings are good for.
enum Material<'a> {
    Transitions(Vec<Piece<'a>>, Holds<'a>),
    Holds(Holds<'a>),
}

/// Recordings of one steady label, by label.
type Holds<'a> = BTreeMap<Intent, Vec<&'a Source<'a>>>;

type Joined = (Vec<shared::units::Sample>, Vec<Option<Intent>>);

impl<'a> Material<'a> {
    fn of(sources: &'a [Source<'a>]) -> Self {
        let mut pieces: Vec<Piece<'a>> = sources.iter().flat_map(transitions).collect();
        // Pieces that lead nowhere (a motion that is never seen to end) would break the walk.
        loop {
            let starts: BTreeSet<_> = pieces.iter().map(|p| p.from).collect();
            let before = pieces.len();
            pieces.retain(|p| starts.contains(&p.to));
            if pieces.len() == before {
                break;
            }
        }
        let mut holds: BTreeMap<Intent, Vec<_>> = BTreeMap::new();
        for source in sources {
            if let [run] = runs(&source.labels)[..]
                && let Some(intent) = run.label
            {
                holds.entry(intent).or_default().push(source);
            }
        }
        if pieces.is_empty() {
            Self::Holds(holds)
        } else {
            Self::Transitions(pieces, holds)
        }
    }

    fn walk(&self, samples: usize, random: &mut ChaCha8Rng) -> Option<Joined> {
        match self {
            Self::Transitions(pieces, holds) => walk_transitions(pieces, holds, samples, random),
            Self::Holds(holds) => walk_holds(holds, samples, random),
        }
    }
}

fn transitions<'a>(source: &'a Source<'a>) -> Vec<Piece<'a>> {
    // The middle half: of a rest of 1 s a quarter covers most people's deviation from the lag.
    // Joined runs are then 0.5 to 1.5 times as long as the recorded ones.
    let middle = |start: usize, end: usize| {
        let quarter = (end - start) / 4;
        start + quarter..end - quarter
    };
    runs(&source.labels)
        .windows(2)
        .map(|pair| Piece {
            source,
            from: pair[0].label,
            to: pair[1].label,
            start: middle(pair[0].start, pair[0].end),
            end: middle(pair[1].start, pair[1].end),
        })
        .collect()
}

/// Next label first, then one of its pieces: a gesture recorded often does not come more often.
fn walk_transitions(
    pieces: &[Piece<'_>],
    holds: &Holds<'_>,
    samples: usize,
    random: &mut ChaCha8Rng,
) -> Option<Joined> {
    let mut joined = Joined::default();
    let mut label = pieces.choose(random)?.from;
    while joined.0.len() < samples {
        // Now and then a steady recording of the same label, longer than any cue: rest lasts in life.
        if let Some(steady) = label.and_then(|intent| holds.get(&intent))
            && random.random_bool(STEADY)
        {
            let source = steady.choose(random)?;
            let all = source.recording.samples.len();
            let length = random.random_range(STEADY_FOR).min(all);
            let start = random.random_range(0..=all - length);
            append(&mut joined, source, start..start + length, samples);
            continue;
        }
        let here: Vec<_> = pieces.iter().filter(|p| p.from == label).collect();
        let nexts: Vec<_> = here
            .iter()
            .map(|p| p.to)
            .collect::<BTreeSet<_>>()
            .into_iter()
            .collect();
        let next = *nexts.choose(random)?;
        let fitting: Vec<_> = here.into_iter().filter(|p| p.to == next).collect();
        let piece = fitting.choose(random)?;
        let start = random.random_range(piece.start.clone());
        let end = random.random_range(piece.end.clone());
        append(&mut joined, piece.source, start..end, samples);
        label = next;
    }
    Some(joined)
}

fn walk_holds(holds: &Holds<'_>, samples: usize, random: &mut ChaCha8Rng) -> Option<Joined> {
    let gestures: Vec<Intent> = holds
        .keys()
        .copied()
        .filter(|&intent| intent != Intent::Relax)
        .collect();
    let rests = holds.contains_key(&Intent::Relax);
    if gestures.len() + usize::from(rests) < 2 {
        return None;
    }
    let mut joined = Joined::default();
    let mut label = *gestures.choose(random)?;
    while joined.0.len() < samples {
        let source = holds[&label].choose(random)?;
        let all = source.recording.samples.len();
        let length = random.random_range(HOLD).min(all);
        let start = random.random_range(0..=all - length);
        append(&mut joined, source, start..start + length, samples);

        let others: Vec<_> = gestures.iter().copied().filter(|&g| g != label).collect();
        let rest = rests && label != Intent::Relax;
        label = if rest && (others.is_empty() || random.random_bool(REST_BETWEEN)) {
            Intent::Relax
        } else {
            *others.choose(random)?
        };
    }
    Some(joined)
}

/// Appends a stretch, but no more than `samples` in all.
fn append(joined: &mut Joined, source: &Source<'_>, stretch: Range<usize>, samples: usize) {
    let end = stretch.end.min(stretch.start + samples - joined.0.len());
    joined
        .0
        .extend_from_slice(&source.recording.samples[stretch.start..end]);
    joined
        .1
        .extend_from_slice(&source.labels[stretch.start..end]);
}

/// FNV-1a: fixed over releases, unlike the standard library's hashes.
pub(super) fn fnv(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::DataSet;

    const R: Option<Intent> = Some(Intent::Relax);
    const O: Option<Intent> = Some(Intent::Open);
    const C: Option<Intent> = Some(Intent::Close);

    /// Every sample carries its label's number, so that a joint at the wrong place shows.
    fn recording(subject: &str, sequence: &[(Option<Intent>, usize)]) -> Recording {
        let labels: Vec<_> = sequence
            .iter()
            .flat_map(|&(label, count)| vec![label; count])
            .collect();
        Recording {
            data_set: DataSet::Synthetic,
            subject: subject.into(),
            name: "r".into(),
            path: PathBuf::new(),
            samples: labels.iter().map(|&label| [mark(label); 8]).collect(),
            labels,
            notes: Vec::new(),
        }
    }

    fn mark(label: Option<Intent>) -> i8 {
        label.map_or(-1, |intent| intent.class() as i8)
    }

    const OPTIONS: SpliceOptions = SpliceOptions {
        samples: 4321,
        count: 2,
        lag_samples: 0,
        seed: 42,
    };

    /// Rock, rest, paper, rest, scissor, rest.
    fn roshambo() -> Recording {
        let round = [
            (C, 400),
            (R, 200),
            (O, 400),
            (R, 200),
            (None, 400),
            (R, 200),
        ];
        recording("a", &round.repeat(3))
    }

    #[test]
    fn steady_recordings_come_in_between_transitions() {
        let cued = recording("a", &[(R, 400), (C, 400), (R, 400)]);
        let mut steady = recording("a", &[(R, 3000)]);
        steady.samples.fill([77; 8]);
        let options = SpliceOptions {
            samples: 20_000,
            ..OPTIONS
        };
        let spliced = splice(&[&cued, &steady], &options);
        let marked = spliced[0]
            .samples
            .iter()
            .zip(&spliced[0].labels)
            .filter(|(sample, _)| **sample == [77; 8]);
        let labels: BTreeSet<_> = marked.clone().map(|(_, &label)| label).collect();
        assert_eq!(labels, BTreeSet::from([R]));
        assert!(marked.count() > 1000);
    }

    #[test]
    fn samples_keep_their_labels_and_the_length_is_exact() {
        let spliced = splice(&[&roshambo()], &OPTIONS);
        assert_eq!(spliced.len(), 2);
        for recording in &spliced {
            assert_eq!(
                (recording.samples.len(), recording.labels.len()),
                (4321, 4321)
            );
            let marks = recording.samples.iter().zip(&recording.labels);
            assert!(
                marks
                    .into_iter()
                    .all(|(sample, &label)| sample[0] == mark(label))
            );
        }
        assert_ne!(spliced[0].labels, spliced[1].labels);
        assert_eq!(spliced, splice(&[&roshambo()], &OPTIONS));
    }

    #[test]
    fn the_order_is_broken_and_only_recorded_transitions_occur() {
        let options = SpliceOptions {
            samples: 200_000,
            count: 1,
            ..OPTIONS
        };
        let spliced = splice(&[&roshambo()], &options);
        let found = runs(&spliced[0].labels);
        let gestures: Vec<_> = found.iter().map(|r| r.label).filter(|&l| l != R).collect();
        let pairs: BTreeSet<_> = gestures.windows(2).map(|p| (p[0], p[1])).collect();
        assert_eq!(pairs.len(), 9, "every gesture follows every gesture");
        assert!(found.windows(2).all(|p| p[0].label == R || p[1].label == R));
        let whole = &found[1..found.len() - 1];
        let lengths: Vec<_> = whole.iter().map(super::super::Run::samples).collect();
        assert!(lengths.iter().all(|length| (100..=600).contains(length)));
        assert!(lengths.iter().min() < Some(&120) && lengths.iter().max() > Some(&550));
    }

    #[test]
    fn labels_are_moved_before_the_cut() {
        let still = recording("a", &[(R, 300), (C, 300), (R, 300)].repeat(4));
        let options = SpliceOptions {
            lag_samples: 20,
            ..OPTIONS
        };
        let spliced = &splice(&[&still], &options)[0];
        let wrong = spliced.samples.iter().zip(&spliced.labels);
        let wrong = wrong
            .filter(|(sample, label)| sample[0] != mark(**label))
            .count();
        let changes = runs(&spliced.labels).len() - 1;
        assert!(
            wrong >= 20 * (changes - 1) && wrong <= 20 * (changes + 1),
            "{wrong} {changes}"
        );
    }

    #[test]
    fn motions_without_a_known_end_do_not_stop_the_walk() {
        let close = recording("a", &[(R, 200), (C, 400), (R, 400)]);
        let unknown = recording("a", &[(R, 200), (None, 800)]);
        let spliced = splice(&[&close, &unknown], &OPTIONS);
        assert_eq!(spliced.len(), 2);
        assert!(spliced[0].labels.iter().all(Option::is_some));
    }

    #[test]
    fn steady_holds_are_joined_with_and_without_rest_between() {
        let holds: Vec<_> = [R, O, C]
            .map(|label| recording("a", &[(label, 1000)]))
            .into();
        let options = SpliceOptions {
            samples: 100_000,
            count: 1,
            ..OPTIONS
        };
        let spliced = splice(&holds.iter().collect::<Vec<_>>(), &options);
        let found = runs(&spliced[0].labels);
        let pairs: BTreeSet<_> = found.windows(2).map(|p| (p[0].label, p[1].label)).collect();
        assert_eq!(
            pairs.len(),
            6,
            "rest, open and close all follow one another"
        );
        let whole = &found[1..found.len() - 1];
        assert!(whole.iter().all(|run| HOLD.contains(&run.samples())));
        assert_eq!(spliced[0].samples.len(), 100_000);
    }

    #[test]
    fn subjects_are_not_mixed_and_unlabelled_ones_left_out() {
        let people = [
            roshambo(),
            recording("b", &[(None, 5000)]),
            recording("c", &[(R, 900)]),
        ];
        let spliced = splice(&people.iter().collect::<Vec<_>>(), &OPTIONS);
        assert!(spliced.iter().all(|r| r.subject == "a"));
    }
}
