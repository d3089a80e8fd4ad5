//! What goes wrong, drawn from a seed.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Silences from here on end the stream, after a second; shorter ones, below [`PAUSED_MS`], do not.
pub const STALLED_MS: u32 = 1_200;
const PAUSED_MS: u32 = 900;

/// Something that goes wrong once.
#[derive(Clone, Copy, Debug)]
pub enum Fault {
    /// So many notifications are lost; the next one arrives in time.
    Lose(u32),
    /// One notification of two is lost, so many times.
    LoseEveryOther(u32),
    /// A notification comes twice.
    Duplicate,
    /// Two notifications change places.
    Swap,
    /// The radio delays everything for so many milliseconds.
    Stall(u32),
    /// No notification for so many milliseconds; then the stream goes on.
    Silence(u32),
    /// The link is lost, so many attempts to connect fail, and so many operations of the set-up are not answered.
    Disconnect {
        /// Attempts to connect that fail.
        refused: u32,
        /// Operations without an answer.
        unanswered: u32,
    },
    /// The link is lost, and the armband refuses the first subscription.
    FailedSetUp,
    /// The link is lost, and the armband has a firmware that is refused, once.
    OldFirmware,
    /// A notification is cut to so many bytes.
    Malformed(u8),
    /// A notification of a characteristic that nobody subscribed to.
    Foreign,
    /// The inference does not run for so many milliseconds.
    Backlog(u32),
}

impl Fault {
    /// Names of all.
    pub const KINDS: [&'static str; 12] = [
        "lose",
        "lose-every-other",
        "duplicate",
        "swap",
        "stall",
        "silence",
        "disconnect",
        "malformed",
        "foreign",
        "backlog",
        "failed-set-up",
        "old-firmware",
    ];

    /// Its name.
    pub const fn kind(self) -> &'static str {
        Self::KINDS[match self {
            Self::Lose(_) => 0,
            Self::LoseEveryOther(_) => 1,
            Self::Duplicate => 2,
            Self::Swap => 3,
            Self::Stall(_) => 4,
            Self::Silence(_) => 5,
            Self::Disconnect { .. } => 6,
            Self::Malformed(_) => 7,
            Self::Foreign => 8,
            Self::Backlog(_) => 9,
            Self::FailedSetUp => 10,
            Self::OldFirmware => 11,
        }]
    }
}

/// The faults of a run, and the pauses between them.
pub struct Faults(ChaCha8Rng);

impl Faults {
    /// Of a seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Notifications without a fault: 4 to 12 s; and now and then five minutes, in which a clock of 200 ppm goes wrong by
    /// more than a round of the lanes.
    pub fn pause(&mut self) -> u32 {
        if self.0.random_ratio(1, 40) {
            30_000
        } else {
            self.0.random_range(400..1200)
        }
    }

    /// The next one.
    pub fn next(&mut self) -> Fault {
        let random = &mut self.0;
        match random.random_range(0..Fault::KINDS.len()) {
            0 => Fault::Lose(random.random_range(1..14)),
            1 => Fault::LoseEveryOther(random.random_range(2..40)),
            2 => Fault::Duplicate,
            3 => Fault::Swap,
            4 => Fault::Stall(random.random_range(10..=200)),
            5 if random.random() => Fault::Silence(random.random_range(250..PAUSED_MS)),
            5 => Fault::Silence(random.random_range(STALLED_MS..8000)),
            6 => Fault::Disconnect {
                refused: random.random_range(0..4),
                unanswered: random.random_range(0..2),
            },
            7 => Fault::Malformed(random.random_range(0..16)),
            8 => Fault::Foreign,
            9 => Fault::Backlog(random.random_range(20..2000)),
            10 => Fault::FailedSetUp,
            _ => Fault::OldFirmware,
        }
    }
}
