//! Synthetic recordings, so that everything runs with no data set at hand.
//!
//! A caricature of forearm EMG: every intent activates the electrodes in a pattern of its own,
//! smeared by crosstalk, scaled and turned by how a person wears the band; the activation rises
//! and falls in ramps, trembles and tires; the signal is noise of that amplitude, its neighbouring
//! samples correlated as in real recordings. Labels are cues that the muscle follows late. Numbers
//! got on it say that the code works, nothing about people.

use std::io::Write;
use std::path::{Path, PathBuf};

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use shared::intent::{Intent, Vocabulary};
use shared::units::{CHANNELS, SAMPLE_PERIOD_MS, SAMPLE_RATE_HZ, Sample};

use super::react_emg::MUSCLE_COLUMN;
use super::splice::fnv;
use super::{DataSet, LoadError, Recording};

/// What to generate.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SynthOptions {
    /// People, `s1` and on.
    pub subjects: usize,
    /// Recordings of each.
    pub recordings: usize,
    /// Seconds of each recording.
    pub seconds: usize,
    /// Intents that occur.
    pub vocabulary: Vocabulary,
    /// Mean time from a cue to half of the muscle's ramp, in ms, 100..=500.
    pub label_lag_ms: u32,
    /// Drives everything; a recording does not depend on how many others are made.
    pub seed: u64,
}

impl Default for SynthOptions {
    /// 8 people, 4 recordings of a minute each, three classes, [`DataSet::label_lag`].
    fn default() -> Self {
        Self {
            subjects: 8,
            recordings: 4,
            seconds: 60,
            vocabulary: Vocabulary::Three,
            label_lag_ms: DataSet::Synthetic.label_lag() as u32 * SAMPLE_PERIOD_MS,
            seed: 42,
        }
    }
}

/// Amplitude of rest, in counts.
const REST: f64 = 2.0;
/// Constant under all channels, as under the armband's.
const BIAS: f64 = -1.0;
/// Weight of the previous innovation: neighbouring samples then correlate at -0.25.
const COLOUR: f64 = -0.268;
/// How much of an electrode's signal its neighbours on either side see.
const CROSSTALK: f64 = 0.2;
/// Ramps of the muscle, in samples: rising 60 to 160 ms, falling 100 to 260 ms.
const RISE: std::ops::Range<usize> = 12..33;
const FALL: std::ops::Range<usize> = 20..53;

/// Makes the recordings in memory, ordered by person.
#[must_use]
pub fn generate(options: &SynthOptions) -> Vec<Recording> {
    made(options).map(|(recording, _)| recording).collect()
}

/// Makes the recordings and writes them below a folder, in ReactEMG's csv layout:
/// `s3/s3_synthetic_1.csv`. Returns the paths.
///
/// The column `synthetic_muscle` besides says what the muscle does at each sample.
///
/// # Errors
/// [`LoadError::Io`] with the path that could not be written.
pub fn write(options: &SynthOptions, folder: &Path) -> Result<Vec<PathBuf>, LoadError> {
    made(options)
        .map(|(recording, muscle)| {
            let person = recording.subject.rsplit('/').next().unwrap_or_default();
            let path = folder.join(person).join(format!("{}.csv", recording.name));
            write_csv(&path, &recording, &muscle).map_err(|source| LoadError::Io {
                path: path.clone(),
                source,
            })?;
            Ok(path)
        })
        .collect()
}

fn made(options: &SynthOptions) -> impl Iterator<Item = (Recording, Vec<Intent>)> {
    let options = *options;
    (1..=options.subjects).flat_map(move |number| {
        let person = format!("s{number}");
        let wearer = Wearer::new(&mut random(options.seed, &person), options.label_lag_ms);
        (1..=options.recordings).map(move |index| {
            let name = format!("{person}_synthetic_{index}");
            let mut random = random(options.seed, &name);
            let cues = cues(&options, &mut random);
            let (samples, muscle) = wearer.perform(&cues, &mut random);
            let recording = Recording {
                data_set: DataSet::Synthetic,
                subject: format!("{}/{person}", DataSet::Synthetic.name()),
                path: PathBuf::new(),
                labels: cues.into_iter().map(Some).collect(),
                samples,
                notes: Vec::new(),
                name,
            };
            (recording, muscle)
        })
    })
}

fn random(seed: u64, name: &str) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed ^ fnv(name))
}

fn normal(random: &mut impl Rng) -> f64 {
    StandardNormal.sample(random)
}

/// The label of every sample: rests and gestures of random length, sometimes gesture to gesture.
fn cues(options: &SynthOptions, random: &mut impl Rng) -> Vec<Intent> {
    let samples = options.seconds * SAMPLE_RATE_HZ as usize;
    let gestures = &options.vocabulary.intents()[1..];
    let mut cues = Vec::with_capacity(samples);
    let mut intent = Intent::Relax;
    while cues.len() < samples {
        let length = if intent == Intent::Relax {
            200..600
        } else {
            240..800
        };
        let length = random.random_range(length).min(samples - cues.len());
        cues.extend(std::iter::repeat_n(intent, length));
        let direct = intent == Intent::Relax || random.random_bool(0.2);
        intent = if direct {
            other_than(intent, gestures, random)
        } else {
            Intent::Relax
        };
    }
    cues
}

fn other_than(intent: Intent, gestures: &[Intent], random: &mut impl Rng) -> Intent {
    loop {
        let next = gestures[random.random_range(0..gestures.len())];
        if next != intent {
            return next;
        }
    }
}

/// A person with the band on.
struct Wearer {
    /// Amplitude in counts by intent and electrode.
    patterns: [[f64; CHANNELS]; Intent::ALL.len()],
    /// From the cue to the start of the ramp, in samples.
    delay: f64,
}

impl Wearer {
    fn new(random: &mut impl Rng, label_lag_ms: u32) -> Self {
        let gain = (0.25 * normal(random)).exp();
        let rotation = random.random_range(-0.8..0.8);
        let patterns = Intent::ALL.map(|intent| {
            let activation: [f64; CHANNELS] = std::array::from_fn(|channel| {
                let own = (0.15 * normal(random)).exp();
                gain * own * activation(intent, channel as f64 + rotation)
            });
            std::array::from_fn(|channel| {
                let beside = activation[(channel + 1) % CHANNELS]
                    + activation[(channel + CHANNELS - 1) % CHANNELS];
                REST + activation[channel] + CROSSTALK * beside
            })
        });
        // Half of a mean ramp (about 32 samples either way) belongs to the lag.
        let lag = f64::from(label_lag_ms.clamp(100, 500)) / f64::from(SAMPLE_PERIOD_MS) - 14.0;
        Self {
            patterns,
            delay: (lag + 6.0 * normal(random)).max(0.0),
        }
    }

    /// Follows the cues; gives the samples and the intent towards which the muscle works.
    fn perform(&self, cues: &[Intent], random: &mut impl Rng) -> (Vec<Sample>, Vec<Intent>) {
        let muscle = self.follow(cues, random);
        let mut samples = Vec::with_capacity(cues.len());
        let mut level = self.patterns[Intent::Relax.class()];
        let (mut from, mut since, mut ramp) = (level, 0, 1);
        let mut innovation = [0.0; CHANNELS];
        let mut tremor = 0.0;
        for (at, &intent) in muscle.iter().enumerate() {
            if at > 0 && muscle[at - 1] != intent {
                (from, since) = (level, 0);
                ramp = random.random_range(if intent == Intent::Relax { FALL } else { RISE });
            }
            since += 1;
            let risen = (since as f64 / ramp as f64).min(1.0);
            let share = 0.5 - 0.5 * (std::f64::consts::PI * risen).cos();
            // Holding tires: a quarter less after five seconds, as the real holds show.
            let tired = 1.0 - 0.25 * (since as f64 / 1000.0).min(1.0);
            tremor = 0.97 * tremor + 0.04 * normal(random);
            let mut sample = [0; CHANNELS];
            for channel in 0..CHANNELS {
                let to = self.patterns[intent.class()][channel] * tired;
                level[channel] = from[channel] + share * (to - from[channel]);
                let fresh = normal(random);
                let noise = fresh + COLOUR * innovation[channel];
                innovation[channel] = fresh;
                let amplitude = level[channel] * (1.0 + tremor).max(0.2);
                sample[channel] = (BIAS + amplitude * noise).round().clamp(-128.0, 127.0) as i8;
            }
            samples.push(sample);
        }
        (samples, muscle)
    }

    /// The cues, every change later by this person's delay and some chance.
    fn follow(&self, cues: &[Intent], random: &mut impl Rng) -> Vec<Intent> {
        let mut muscle = cues.to_vec();
        for change in (1..cues.len()).filter(|&at| cues[at] != cues[at - 1]) {
            // Below the shortest run of cues, so that no change overtakes the next.
            let delay = (self.delay + 10.0 * normal(random)).clamp(0.0, 180.0) as usize;
            let end = (change + delay).min(cues.len());
            muscle[change..end].fill(cues[change - 1]);
        }
        muscle
    }
}

/// What an intent does at a place on the ring (electrodes 0..8), in counts.
fn activation(intent: Intent, place: f64) -> f64 {
    // Extensors lie around electrode 2, flexors around 6, the thumb's around 4.
    let bump = |centre: f64, width: f64| {
        let turn = (place - centre).rem_euclid(CHANNELS as f64);
        let distance = turn.min(CHANNELS as f64 - turn);
        (-0.5 * (distance / width).powi(2)).exp()
    };
    match intent {
        Intent::Relax => 0.0,
        Intent::Open => 24.0 * bump(3.0, 1.0) + 8.0 * bump(0.5, 0.8),
        Intent::Close => 26.0 * bump(6.5, 1.2) + 10.0 * bump(2.0, 0.8),
        Intent::WaveIn => 30.0 * bump(5.5, 0.8),
        Intent::WaveOut => 34.0 * bump(1.8, 0.9),
        Intent::Pinch => 14.0 * bump(4.5, 0.9) + 8.0 * bump(7.5, 0.7),
    }
}

/// Writes under a temporary name first: a file that is there is whole.
fn write_csv(path: &Path, recording: &Recording, muscle: &[Intent]) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let temporary = path.with_extension("csv.part");
    let mut file = std::io::BufWriter::new(std::fs::File::create(&temporary)?);
    write!(file, "gt")?;
    for channel in 0..CHANNELS {
        write!(file, ",emg_{channel}")?;
    }
    writeln!(file, ",{MUSCLE_COLUMN}")?;
    for ((sample, label), muscle) in recording.samples.iter().zip(&recording.labels).zip(muscle) {
        match label {
            Some(intent) => write!(file, "{}", intent.class())?,
            None => write!(file, "-1")?,
        }
        for count in sample {
            write!(file, ",{count}")?;
        }
        writeln!(file, ",{}", muscle.class())?;
    }
    file.into_inner()
        .map_err(std::io::IntoInnerError::into_error)?
        .sync_all()?;
    std::fs::rename(temporary, path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::LoadOptions;
    use crate::dataset::lag;
    use crate::dataset::load;

    const SMALL: SynthOptions = SynthOptions {
        subjects: 3,
        recordings: 2,
        seconds: 30,
        vocabulary: Vocabulary::Six,
        label_lag_ms: 250,
        seed: 7,
    };

    #[test]
    fn the_seed_makes_the_recordings_whatever_else_is_made() {
        let some = generate(&SMALL);
        assert_eq!(some, generate(&SMALL));
        let more = generate(&SynthOptions {
            subjects: 5,
            ..SMALL
        });
        assert_eq!(some[..], more[..some.len()]);
        assert_ne!(some, generate(&SynthOptions { seed: 8, ..SMALL }));
        assert_ne!(some[0].samples, some[1].samples);
    }

    #[test]
    fn the_muscle_follows_its_label_by_the_lag() {
        for label_lag_ms in [150, 250, 400] {
            let options = SynthOptions {
                label_lag_ms,
                subjects: 8,
                ..SMALL
            };
            let recordings = generate(&options);
            let lag = lag::estimate(&recordings.iter().collect::<Vec<_>>()).unwrap();
            let found = lag.lag_samples as u32 * SAMPLE_PERIOD_MS;
            assert!(
                found.abs_diff(label_lag_ms) <= 30,
                "{label_lag_ms}: {lag:?}"
            );
        }
    }

    #[test]
    fn neighbouring_samples_correlate_as_real_ones() {
        let recordings = generate(&SMALL);
        let signal: Vec<f64> = recordings[0]
            .samples
            .iter()
            .map(|sample| f64::from(sample[3]) - BIAS)
            .collect();
        let power: f64 = signal.iter().map(|x| x * x).sum();
        let product: f64 = signal.windows(2).map(|pair| pair[0] * pair[1]).sum();
        assert!(
            (-0.35..-0.15).contains(&(product / power)),
            "{}",
            product / power
        );
    }

    #[test]
    fn written_recordings_are_read_back_as_they_were_made() {
        let folder = std::env::temp_dir().join(format!("myointent-synth-{}", std::process::id()));
        let paths = write(&SMALL, &folder).unwrap();
        let library = load(&folder, &LoadOptions::default()).unwrap();
        let made = generate(&SMALL);
        assert_eq!(
            (paths.len(), library.recordings.len()),
            (made.len(), made.len())
        );
        for (read, made) in library.recordings.iter().zip(&made) {
            assert_eq!(read.data_set, DataSet::Synthetic);
            assert_eq!((&read.subject, &read.name), (&made.subject, &made.name));
            assert_eq!((&read.samples, &read.labels), (&made.samples, &made.labels));
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
