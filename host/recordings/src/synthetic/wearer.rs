//! The muscle activity of a synthetic recording: a person who wears the band and follows cues late.

use std::f64::consts::PI;
use std::ops::Range;

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use shared::intent::Intent;
use shared::units::{CHANNELS, SAMPLE_PERIOD_MS, Sample};

use crate::labels::motion::Motion;
use crate::recording::movement::MovementKind;

/// Amplitude of rest, in counts.
const REST: f64 = 2.0;
/// Constant under all channels, as under the armband's.
pub(super) const BIAS: f64 = -1.0;
/// Weight of the previous innovation: neighbouring samples then correlate at -0.25.
const COLOUR: f64 = -0.268;
/// Share of an electrode's signal that its neighbours on either side receive.
const CROSSTALK: f64 = 0.2;
/// Ramps of the muscle, in samples: rising 60 to 160 ms, falling 100 to 260 ms.
const RISE: Range<usize> = 12..33;
const FALL: Range<usize> = 20..53;

fn normal(random: &mut impl Rng) -> f64 {
    StandardNormal.sample(random)
}

/// A person who wears the band.
pub(super) struct Wearer {
    /// Amplitude in counts by intent and electrode.
    patterns: [[f64; CHANNELS]; Intent::ALL.len()],
    /// Strength of all muscles, and places by which the armband is turned.
    gain: f64,
    rotation: f64,
    /// Time from the cue to the start of the ramp, in samples.
    delay: f64,
}

impl Wearer {
    pub fn new(random: &mut impl Rng, label_lag_ms: u32) -> Self {
        let gain = (0.25 * normal(random)).exp();
        let rotation = random.random_range(-0.8..0.8);
        let patterns = Intent::ALL.map(|intent| {
            let activation: [f64; CHANNELS] = std::array::from_fn(|channel| {
                let own = (0.15 * normal(random)).exp();
                gain * own * activation(intent, channel as f64 + rotation)
            });
            at_electrodes(activation)
        });
        // Half of a mean ramp (about 32 samples either way) belongs to the lag.
        let lag = f64::from(label_lag_ms.clamp(100, 500)) / f64::from(SAMPLE_PERIOD_MS) - 14.0;
        Self {
            patterns,
            gain,
            rotation,
            delay: (lag + 6.0 * normal(random)).max(0.0),
        }
    }

    /// Amplitude of a motion in counts by electrode.
    fn amplitudes(&self, motion: Motion) -> [f64; CHANNELS] {
        match motion {
            Motion::Intent(intent) => self.patterns[intent.class()],
            Motion::Other(kind) => at_electrodes(std::array::from_fn(|channel| {
                self.gain * other_activation(kind, channel as f64 + self.rotation)
            })),
            Motion::Unnamed | Motion::Unknown => self.patterns[Intent::Relax.class()],
        }
    }

    /// Follows the cues; returns the samples and the intent that the muscle moves towards.
    pub(crate) fn perform(
        &self,
        cues: &[Intent],
        random: &mut impl Rng,
    ) -> (Vec<Sample>, Vec<Intent>) {
        let intents = self.follow(cues, random);
        let mut muscle = Muscle::at_rest(self);
        let samples = intents
            .iter()
            .map(|&intent| muscle.sample(self, intent.into(), random))
            .collect();
        (samples, intents)
    }

    /// Samples from a cue to the start of the ramp.
    pub fn reaction(&self, random: &mut impl Rng) -> usize {
        (self.delay + 10.0 * normal(random)).clamp(0.0, 180.0) as usize
    }

    /// Intents of the muscle: the cues, every change later by this person's delay and some chance.
    fn follow(&self, cues: &[Intent], random: &mut impl Rng) -> Vec<Intent> {
        let mut muscle = cues.to_vec();
        for change in (1..cues.len()).filter(|&at| cues[at] != cues[at - 1]) {
            // Below the shortest run of cues, so that no change overtakes the next.
            let delay = self.reaction(random);
            let end = (change + delay).min(cues.len());
            muscle[change..end].fill(cues[change - 1]);
        }
        muscle
    }
}

/// State of the muscle from sample to sample.
pub(super) struct Muscle {
    motion: Motion,
    /// Amplitudes of the motion, now, and when it changed.
    towards: [f64; CHANNELS],
    level: [f64; CHANNELS],
    from: [f64; CHANNELS],
    /// Samples since that change; `ramp` is the number until the new amplitude is reached.
    since: usize,
    ramp: usize,
    tremor: f64,
    innovation: [f64; CHANNELS],
}

impl Muscle {
    pub(crate) const fn at_rest(wearer: &Wearer) -> Self {
        let level = wearer.patterns[Intent::Relax.class()];
        Self {
            motion: Motion::RELAX,
            towards: level,
            level,
            from: level,
            since: 0,
            ramp: 1,
            tremor: 0.0,
            innovation: [0.0; CHANNELS],
        }
    }

    /// The next sample, as the muscle moves towards a motion.
    pub fn sample(&mut self, wearer: &Wearer, motion: Motion, random: &mut impl Rng) -> Sample {
        if self.motion != motion {
            (self.from, self.since, self.motion) = (self.level, 0, motion);
            self.towards = wearer.amplitudes(motion);
            self.ramp = random.random_range(if motion == Motion::RELAX { FALL } else { RISE });
        }
        self.since += 1;
        let risen = (self.since as f64 / self.ramp as f64).min(1.0);
        let share = 0.5 - 0.5 * (PI * risen).cos();
        // Fatigue: a quarter less after five seconds of holding, as in the recorded holds.
        let fatigue = 1.0 - 0.25 * (self.since as f64 / 1000.0).min(1.0);
        self.tremor = 0.97 * self.tremor + 0.04 * normal(random);
        let mut sample = [0; CHANNELS];
        for (channel, value) in sample.iter_mut().enumerate() {
            let to = self.towards[channel] * fatigue;
            self.level[channel] = self.from[channel] + share * (to - self.from[channel]);
            let fresh = normal(random);
            let noise = fresh + COLOUR * self.innovation[channel];
            self.innovation[channel] = fresh;
            let amplitude = self.level[channel] * (1.0 + self.tremor).max(0.2);
            *value = (BIAS + amplitude * noise).round().clamp(-128.0, 127.0) as i8;
        }
        sample
    }
}

/// Amplitudes at the electrodes of muscles that are active below them.
fn at_electrodes(activation: [f64; CHANNELS]) -> [f64; CHANNELS] {
    std::array::from_fn(|channel| {
        let beside =
            activation[(channel + 1) % CHANNELS] + activation[(channel + CHANNELS - 1) % CHANNELS];
        REST + activation[channel] + CROSSTALK * beside
    })
}

/// Activity at a position on the ring (electrodes 0..8) of a muscle at `centre`, from 0 to 1.
fn bump(position: f64, centre: f64, width: f64) -> f64 {
    let clockwise = (position - centre).rem_euclid(CHANNELS as f64);
    let distance = clockwise.min(CHANNELS as f64 - clockwise);
    (-0.5 * (distance / width).powi(2)).exp()
}

/// Amplitude of another movement at a position on the ring, in counts: weaker than a gesture, of muscles between theirs.
fn other_activation(kind: MovementKind, position: f64) -> f64 {
    let bump = |centre, width| bump(position, centre, width);
    match kind {
        MovementKind::Point => 12.0 * bump(2.2, 0.7) + 12.0 * bump(7.2, 0.9),
        MovementKind::ThumbUp => 16.0 * bump(4.2, 0.8) + 8.0 * bump(6.3, 0.8),
        MovementKind::TwoFingers => 10.0 * bump(3.2, 0.8) + 14.0 * bump(7.0, 0.8),
        MovementKind::Pronation => 18.0 * bump(5.0, 0.8),
        MovementKind::Supination => 18.0 * bump(1.0, 0.8) + 8.0 * bump(4.0, 0.7),
        _ => 14.0 * bump(2.7, 1.0) + 10.0 * bump(5.0, 0.8),
    }
}

/// Amplitude of an intent at a position on the ring, in counts.
fn activation(intent: Intent, position: f64) -> f64 {
    // Extensors lie around electrode 2, flexors around 6, the thumb's around 4.
    let bump = |centre, width| bump(position, centre, width);
    match intent {
        Intent::Relax => 0.0,
        Intent::Open => 24.0 * bump(3.0, 1.0) + 8.0 * bump(0.5, 0.8),
        Intent::Close => 26.0 * bump(6.5, 1.2) + 10.0 * bump(2.0, 0.8),
        Intent::WaveIn => 30.0 * bump(5.5, 0.8),
        Intent::WaveOut => 34.0 * bump(1.8, 0.9),
        Intent::Pinch => 14.0 * bump(4.5, 0.9) + 8.0 * bump(7.5, 0.7),
    }
}
