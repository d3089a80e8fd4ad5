//! Parts of a person's recordings: one to tune on, one to hold back.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use shared::intent::Intent;
use shared::units::{SAMPLE_RATE_HZ, WINDOW};

use super::error::PersonalizeError;
use super::person::PersonRecordings;
use evaluation::EvaluatedRecording;
use recordings::labels::motion::{Motion, motions};
use recordings::{Movement, Recording, runs};

/// Divisor of the share that is held back.
const HELD_BACK: usize = 3;
/// Samples between the two parts of one recording: a window, the memory of a model.
const GAP: usize = WINDOW;
/// Number of divisions where a third is too short to judge.
const FOLDS: usize = 4;
/// Least number of stretches of each class in either part.
const FEWEST: usize = 2;

/// Piece of one recording.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Piece {
    /// Index of the recording.
    recording: usize,
    range: Range<usize>,
}

/// Part of a person's recordings: pieces, in order.
#[derive(Clone)]
pub struct PersonPart<'p> {
    person: &'p PersonRecordings,
    pieces: Vec<Piece>,
}

impl PersonRecordings {
    /// Part with all of the recordings.
    pub fn whole(&self) -> PersonPart<'_> {
        let all = self.recordings.iter().enumerate();
        let pieces = all.map(|(at, own)| Piece {
            recording: at,
            range: 0..own.recording.labels.len(),
        });
        PersonPart::new(self, pieces.collect())
    }
}

impl<'p> PersonPart<'p> {
    fn new(person: &'p PersonRecordings, mut pieces: Vec<Piece>) -> Self {
        pieces.sort_by_key(|piece| (piece.recording, piece.range.start));
        pieces.retain(|piece| !piece.range.is_empty());
        Self { person, pieces }
    }

    /// Person whose recordings these are.
    pub(super) const fn person(&self) -> &'p PersonRecordings {
        self.person
    }

    /// Duration in seconds.
    pub fn seconds(&self) -> f64 {
        let samples: usize = self.pieces.iter().map(|piece| piece.range.len()).sum();
        samples as f64 / f64::from(SAMPLE_RATE_HZ)
    }

    /// Divides the part into one to tune on and one to hold back.
    ///
    /// Pieces with the same gestures are divided together. The last ones, recorded after the others, are held back: as few
    /// as make three tenths of the time, so one of three of similar length. Of a single piece, the last third is held back,
    /// less a window of 3 s between the two.
    pub fn divided(&self) -> Result<(Self, Self), PersonalizeError> {
        let (mut tuned, mut judged) = (Vec::new(), Vec::new());
        for pieces in self.by_gestures().into_values() {
            if let [only] = pieces[..] {
                let Range { start, end } = only.range;
                let cut = end - only.range.len() / HELD_BACK;
                tuned.push(only.with(start..cut));
                judged.push(only.with((cut + GAP).min(end)..end));
                continue;
            }
            let total: usize = pieces.iter().map(|piece| piece.range.len()).sum();
            let mut held = 0;
            for (at, piece) in pieces.iter().enumerate().rev() {
                let side = if at > 0 && 10 * held < 3 * total {
                    held += piece.range.len();
                    &mut judged
                } else {
                    &mut tuned
                };
                side.push((*piece).clone());
            }
        }
        self.pair(tuned, judged)
    }

    /// A part to tune on and one to hold back, neither too short.
    fn pair(
        &self,
        tuned: Vec<Piece>,
        judged: Vec<Piece>,
    ) -> Result<(Self, Self), PersonalizeError> {
        let [tuned, judged] = [tuned, judged].map(|pieces| Self::new(self.person, pieces));
        tuned.refuse_too_short("tuned on")?;
        judged.refuse_too_short("held back")?;
        Ok((tuned, judged))
    }

    /// Divides the part into halves: of each motion, the first half of its holds and the other half, each hold with the rest around
    /// it up to the middle. Stretches without a hold count as one motion more.
    pub fn halves(&self) -> Result<(Self, Self), PersonalizeError> {
        let is_hold = |motion: Motion| !matches!(motion, Motion::RELAX | Motion::Unknown);
        let mut holds: BTreeMap<&'static str, Vec<Piece>> = BTreeMap::new();
        for piece in &self.pieces {
            let own = &self.person.recordings[piece.recording].recording;
            let motions = motions(&own.labels, &own.other_movement);
            let Range { start, end } = piece.range;
            let between = runs(&motions[start..end]).into_iter();
            let between = between.filter(|run| !is_hold(run.label));
            let middles = between.map(|run| start + usize::midpoint(run.start, run.end));
            let inside = middles.filter(|&middle| middle > start && middle < end);
            let cuts: Vec<usize> = [start].into_iter().chain(inside).chain([end]).collect();
            for cut in cuts.windows(2) {
                let hold = piece.with(cut[0]..cut[1]);
                let mut own = motions[hold.range.clone()].iter();
                let motion = own.find(|motion| is_hold(**motion));
                let name = motion.unwrap_or(&Motion::RELAX).name();
                holds.entry(name).or_default().push(hold);
            }
        }
        let (mut first, mut second) = (Vec::new(), Vec::new());
        for own in holds.into_values() {
            let (before, after) = own.split_at(own.len() / 2);
            first.extend_from_slice(before);
            second.extend_from_slice(after);
        }
        self.pair(first, second)
    }

    /// Divides the part into one to tune on and one to hold back ([`divided`](Self::divided)). If that is too short, into four such pairs:
    /// each quarter is held back once, from what is recorded in the others.
    pub fn divisions(&self) -> Result<Vec<(Self, Self)>, PersonalizeError> {
        match self.divided() {
            Err(PersonalizeError::TooShort { .. }) => self.folds(),
            divided => Ok(vec![divided?]),
        }
    }

    fn folds(&self) -> Result<Vec<(Self, Self)>, PersonalizeError> {
        let fold = |fold: usize| {
            let (mut tuned, mut judged) = (Vec::new(), Vec::new());
            for piece in &self.pieces {
                let Range { start, end } = piece.range;
                let [from, to] = [fold, fold + 1].map(|at| self.cut_in_rest(piece, at));
                judged.push(piece.with(from..to));
                tuned.push(piece.with(start..from.saturating_sub(GAP).max(start)));
                tuned.push(piece.with((to + GAP).min(end)..end));
            }
            let [tuned, judged] = [tuned, judged].map(|pieces| Self::new(self.person, pieces));
            tuned.refuse_too_short("tuned on")?;
            Ok((tuned, judged))
        };
        self.refuse_too_short("held back")?;
        (0..FOLDS).map(fold).collect()
    }

    /// End of the first `at` of the folds of a piece: the middle of the rest that is nearest to it.
    fn cut_in_rest(&self, piece: &Piece, at: usize) -> usize {
        let Range { start, end } = piece.range;
        let even = start + piece.range.len() * at / FOLDS;
        if at == 0 || at == FOLDS {
            return even;
        }
        let rests = runs(self.labels(piece)).into_iter();
        rests
            .filter(|run| run.label == Some(Intent::Relax))
            .map(|run| (start + usize::midpoint(run.start, run.end)).min(end))
            .min_by_key(|middle| middle.abs_diff(even))
            .unwrap_or(even)
    }

    /// Takes the first `seconds`. Pieces with different gestures get the same time each, as far as they have it, and so do pieces of
    /// rest alone; pieces of other movement alone are left out.
    pub fn first(&self, seconds: f64) -> Self {
        let mut kinds = self.by_gestures();
        if let Some(others) = kinds.get_mut(&BTreeSet::new()) {
            let movements = |piece: &Piece| {
                let own = &self.person.recordings[piece.recording].recording;
                piece.cut(&own.other_movement, 0)
            };
            others.retain(|own| {
                self.labels(own).contains(&Some(Intent::Relax)) && movements(own).is_empty()
            });
        }
        let mut kinds: Vec<Vec<&Piece>> = kinds.into_values().collect();
        let time = |pieces: &[&Piece]| pieces.iter().map(|piece| piece.range.len()).sum::<usize>();
        // The shortest first: the others share the time that it lacks.
        kinds.sort_by_key(|pieces| time(pieces));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a time of minutes"
        )]
        let mut left = (seconds * f64::from(SAMPLE_RATE_HZ)) as usize;
        let mut first = Vec::new();
        let count = kinds.len();
        for (at, pieces) in kinds.into_iter().enumerate() {
            let mut own = left / (count - at);
            for piece in pieces {
                let taken = own.min(piece.range.len());
                first.push(piece.with(piece.range.start..piece.range.start + taken));
                own -= taken;
                left -= taken;
            }
        }
        Self::new(self.person, first)
    }

    /// Recordings for an evaluation: whole ones, which a model sees, with the labels of this part alone.
    pub fn evaluated_recordings(&self) -> Vec<EvaluatedRecording> {
        let mut recordings: Vec<EvaluatedRecording> = Vec::new();
        for (at, own) in self.person.recordings.iter().enumerate() {
            let pieces = || self.pieces.iter().filter(|piece| piece.recording == at);
            if pieces().next().is_none() {
                continue;
            }
            let mut evaluated = own.evaluated.clone();
            let inside = |sample: usize| pieces().any(|piece| piece.range.contains(&sample));
            for (sample, label) in evaluated.lag_compensated.iter_mut().enumerate() {
                *label = label.filter(|_| inside(sample));
            }
            let cuts = pieces().map(|piece| piece.cut(&own.evaluated.other_movement, 0));
            evaluated.other_movement = cuts.flatten().collect();
            evaluated.published = None;
            recordings.push(evaluated);
        }
        recordings
    }

    /// Cuts the pieces into recordings of their own.
    pub(super) fn recordings(&self) -> Vec<Recording> {
        let cut = |piece: &Piece| {
            let own = &self.person.recordings[piece.recording].recording;
            Recording {
                samples: own.samples[piece.range.clone()].to_vec(),
                labels: own.labels[piece.range.clone()].to_vec(),
                other_movement: piece.cut(&own.other_movement, piece.range.start),
                ..own.clone()
            }
        };
        self.pieces.iter().map(cut).collect()
    }

    /// Groups the pieces by the gestures in them.
    fn by_gestures(&self) -> BTreeMap<BTreeSet<Intent>, Vec<&Piece>> {
        let mut kinds: BTreeMap<BTreeSet<Intent>, Vec<&Piece>> = BTreeMap::new();
        for piece in &self.pieces {
            let labels = self.labels(piece).iter().copied().flatten();
            let gestures = labels.filter(|&intent| intent != Intent::Relax).collect();
            kinds.entry(gestures).or_default().push(piece);
        }
        kinds
    }

    fn labels(&self, piece: &Piece) -> &'p [Option<Intent>] {
        &self.person.recordings[piece.recording].recording.labels[piece.range.clone()]
    }

    /// Refuses a part in which a class of the model is too rare.
    fn refuse_too_short(&self, part: &'static str) -> Result<(), PersonalizeError> {
        for intent in self.person.vocabulary.intents() {
            let pieces = self.pieces.iter();
            let of = |piece: &Piece| {
                let all = runs(self.labels(piece)).into_iter();
                all.filter(|run| run.label == Some(*intent)).count()
            };
            let found = pieces.map(of).sum();
            if found < FEWEST {
                return Err(PersonalizeError::TooShort {
                    part,
                    class: intent.name(),
                    expected: FEWEST,
                    found,
                    each: 3 * FEWEST,
                });
            }
        }
        Ok(())
    }
}

impl Piece {
    /// Piece of the same recording with other samples.
    const fn with(&self, range: Range<usize>) -> Self {
        Self {
            recording: self.recording,
            range,
        }
    }

    /// Cuts movements to the piece; positions count from `origin`.
    fn cut(&self, movements: &[Movement], origin: usize) -> Vec<Movement> {
        let Range { start, end } = self.range;
        let inside = |movement: &Movement| {
            let Range {
                start: from,
                end: to,
            } = movement.samples;
            let [from, to] = [from, to].map(|at| at.clamp(start, end) - origin);
            (from < to).then(|| Movement::new(movement.kind, from..to))
        };
        movements.iter().filter_map(inside).collect()
    }
}
