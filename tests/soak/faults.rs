//! Faults, drawn from a seed.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Shortest silence that ends the stream, after a second. Shorter ones, below [`PAUSED_MS`], do not.
pub const STALLED_MS: u32 = 1_200;
const PAUSED_MS: u32 = 900;

/// Fault that happens once.
#[derive(Clone, Copy, Debug)]
pub enum Fault {
    /// Loss of so many notifications; the next one arrives in time.
    Lose(u32),
    /// Loss of one notification of two, so many times.
    LoseEveryOther(u32),
    /// Notification that comes twice.
    Duplicate,
    /// Exchange of two notifications.
    Swap,
    /// Delay of everything by the radio, for so many milliseconds.
    Stall(u32),
    /// Silence of so many milliseconds; then the stream goes on.
    Silence(u32),
    /// Loss of the link, after which attempts to connect fail and operations of the set-up are not answered.
    Disconnect {
        /// Number of attempts to connect that fail.
        refused: u32,
        /// Number of operations without an answer.
        unanswered: u32,
    },
    /// Loss of the link, after which the armband refuses the first subscription.
    FailedSetUp,
    /// Loss of the link, after which the armband once has a firmware that is refused.
    OldFirmware,
    /// Notification that is cut to so many bytes.
    Malformed(u8),
    /// Notification of a characteristic without a subscription.
    Foreign,
    /// Pause of the inference, for so many milliseconds.
    Backlog(u32),
}

impl Fault {
    /// Names of all faults.
    #[rustfmt::skip]
    pub const KINDS: [&'static str; 12] = [
        "lose", "lose-every-other", "duplicate", "swap", "stall", "silence", "disconnect", "malformed", "foreign",
        "backlog", "failed-set-up", "old-firmware",
    ];

    /// Returns the name of the fault.
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

/// Faults of a run, and the pauses between them.
pub struct Faults(ChaCha8Rng);

impl Faults {
    /// Creates the faults of a seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Draws the number of notifications without a fault: 4 to 12 s, and sometimes five minutes, in which a clock of
    /// 200 ppm goes wrong by more than a round of the lanes.
    pub fn pause(&mut self) -> u32 {
        if self.0.random_ratio(1, 40) {
            30_000
        } else {
            self.0.random_range(400..1200)
        }
    }

    /// Draws the next fault.
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
