//! Faults of the armband in a run, drawn from a seed, and their expected effect on the board's counters.

use std::ops::RangeInclusive;

use rand::seq::SliceRandom as _;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

/// Notifications of a stream without a fault until labels are valid again: a window is 300, the first label comes 31
/// later, and held notifications are decided in less than 40.
const WINDOW: usize = 380;
/// Number of notifications over which labels are counted then: ten labels.
const COUNTED: usize = 100;
/// Number of notifications from the last fault to the next: the two, and time for the test to look.
const PAUSE: usize = WINDOW + COUNTED + 30;
/// Number of notifications between two small faults: each is decided before the next.
const APART: usize = 10;
/// Number of notifications between two great faults.
const BETWEEN: usize = 60;
/// Largest number of notifications of an incident.
const LONGEST: usize = 500;
/// Smallest number of notifications of a run: an incident between two pauses.
pub const SHORTEST: usize = WINDOW + LONGEST + PAUSE;
/// Milliseconds between two notifications without a subscription, from each connection to its stream.
const CHATTER_MS: usize = 50;

/// Names of the great faults.
pub const KINDS: [&str; 8] = [
    "loss",
    "quota",
    "stall",
    "stalls",
    "long-stall",
    "pause",
    "hang",
    "lost-link",
];

/// Small faults, then two great ones.
pub struct Incident {
    /// Kinds of the two great ones.
    pub kinds: [&'static str; 2],
    /// Number of the first notification after the faults.
    pub end: usize,
    /// Counts that the board adds from the incident before on.
    pub counted: Counted,
}

/// Effects of faults on the counters.
pub struct Counted {
    /// Number of notifications that come twice.
    pub duplicates: u32,
    /// Number of pairs that change places.
    pub reordered: u32,
    /// Number of notifications that are too short.
    pub malformed: u32,
    /// Number of samples that are lost, and of those given up because their place is unknown.
    pub lost: RangeInclusive<u32>,
    /// Number of connections that the board ends because it hears nothing.
    pub stalls: u32,
}

impl Counted {
    const fn nothing() -> Self {
        Self {
            duplicates: 0,
            reordered: 0,
            malformed: 0,
            lost: 0..=0,
            stalls: 0,
        }
    }

    fn lose(&mut self, samples: RangeInclusive<u32>) {
        self.lost = self.lost.start() + samples.start()..=self.lost.end() + samples.end();
    }
}

impl Incident {
    /// Returns the number of the notification at which labels are valid, and counted from.
    pub const fn valid_at(&self) -> usize {
        self.end + WINDOW
    }

    /// Returns the number of the notification up to which labels are counted.
    pub const fn labelled_to(&self) -> usize {
        self.valid_at() + COUNTED
    }
}

/// Faults of a run.
pub struct Plan {
    /// Script of the armband.
    pub script: Vec<Value>,
    /// Incidents in the order of time.
    pub incidents: Vec<Incident>,
    random: ChaCha8Rng,
    /// Number of real milliseconds for one of the board's.
    time_scale: usize,
    at: usize,
    counted: Counted,
}

impl Plan {
    /// Draws the plan of a run of so many notifications from a seed.
    pub fn new(seed: u64, notifications: usize, time_scale: u32) -> Self {
        let mut plan = Self {
            script: Vec::new(),
            incidents: Vec::new(),
            random: ChaCha8Rng::seed_from_u64(seed),
            time_scale: time_scale as usize,
            at: WINDOW,
            counted: Counted::nothing(),
        };
        let chatter = json!({"do": "chatter", "ms": plan.real_ms(CHATTER_MS)});
        plan.script.push(chatter);
        let mut kinds = Vec::new();
        while plan.at + LONGEST + PAUSE <= notifications {
            plan.small();
            let kinds = [(); 2].map(|()| {
                let kind = plan.next_kind(&mut kinds);
                plan.at += BETWEEN;
                plan.great(kind);
                kind
            });
            let counted = std::mem::replace(&mut plan.counted, Counted::nothing());
            plan.incidents.push(Incident {
                kinds,
                end: plan.at,
                counted,
            });
            plan.at += PAUSE + plan.below(1..50);
        }
        plan
    }

    /// Draws a kind, each as often as the others, in any order.
    fn next_kind(&mut self, left: &mut Vec<&'static str>) -> &'static str {
        if left.is_empty() {
            left.extend(KINDS);
            left.shuffle(&mut self.random);
        }
        left.pop().expect("there are kinds")
    }

    fn below(&mut self, range: std::ops::Range<usize>) -> usize {
        self.random.random_range(range)
    }

    /// Converts the board's milliseconds to the script's, which are real ones.
    const fn real_ms(&self, ms: usize) -> usize {
        ms * self.time_scale
    }

    /// Adds a burst of faults that are bridged, repaired or ignored.
    fn small(&mut self) {
        for _ in 0..self.below(3..9) {
            let at = self.at;
            let step = match self.below(0..7) {
                0 => {
                    let count = self.below(1..3);
                    self.counted.lose(2 * count as u32..=2 * count as u32);
                    json!({"do": "drop", "at": at, "count": count})
                }
                1 => {
                    self.counted.duplicates += 1;
                    json!({"do": "duplicate", "at": at})
                }
                2 => {
                    self.counted.reordered += 1;
                    json!({"do": "swap", "at": at})
                }
                3 => {
                    self.counted.malformed += 1;
                    self.counted.lose(2..=2);
                    json!({"do": "corrupt", "at": at, "kind": "short"})
                }
                4 => json!({"do": "corrupt", "at": at, "kind": "long"}),
                5 => {
                    self.counted.lose(2..=2);
                    let kind = ["foreign", "garbage"][self.below(0..2)];
                    json!({"do": "corrupt", "at": at, "kind": kind})
                }
                _ => json!({"do": "battery", "at": at, "percent": self.below(0..101)}),
            };
            self.script.push(step);
            self.at += APART;
        }
    }

    /// Adds a fault that ends the window or the connection, or may.
    fn great(&mut self, kind: &str) {
        let at = self.at;
        match kind {
            // Four and more lost notifications are recognised by their times, to a multiple of four; what came until
            // then is given up.
            "loss" => {
                let count = self.below(3..14);
                self.drop(count);
            }
            "pause" => {
                let count = self.below(25..80);
                self.drop(count);
            }
            // After half a second the mode is set again, after a second the connection ends.
            "hang" => {
                let count = self.below(115..145);
                self.script
                    .push(json!({"do": "drop", "at": at, "count": count}));
                self.at += count;
                // Samples lost between two streams are not counted.
                self.counted.stalls += 1;
            }
            "quota" => {
                let times = self.below(31..40);
                for number in 0..times {
                    self.script
                        .push(json!({"do": "drop", "at": at + 4 * number}));
                }
                self.counted.lose(2 * times as u32..=2 * times as u32);
                self.at += 4 * times;
            }
            "stall" => {
                let ms = self.below(30..170);
                self.delay(ms);
            }
            "stalls" => {
                for _ in 0..self.below(2..6) {
                    let ms = self.below(30..90);
                    self.delay(ms);
                }
            }
            "long-stall" => {
                let ms = self.below(230..450);
                self.delay(ms);
                // More come at once than can be held: the burst and the notifications until its end may be given up.
                self.counted.lose(0..=2 * 100);
            }
            _ => {
                let how = ["vanish", "sleep"][self.below(0..2)];
                let (ms, refuse) = (self.below(100..2000), self.below(0..3));
                let for_ms = self.real_ms(ms);
                self.script
                    .push(json!({"do": how, "at": at, "for_ms": for_ms, "refuse": refuse}));
            }
        }
    }

    fn drop(&mut self, count: usize) {
        self.script
            .push(json!({"do": "drop", "at": self.at, "count": count}));
        let lost = 2 * count as u32;
        // Up to three lost notifications are recognised by their lanes, exactly.
        self.counted.lose(match count {
            0..=3 => lost..=lost,
            _ => lost - 8..=lost + 40,
        });
        self.at += count;
    }

    fn delay(&mut self, ms: usize) {
        let delay = json!({"do": "delay", "at": self.at, "ms": self.real_ms(ms)});
        self.script.push(delay);
        self.at += ms / 10 + APART;
    }
}
