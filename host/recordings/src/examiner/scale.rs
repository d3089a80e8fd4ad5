//! Scale of values that should be counts: -128 to 127, whole.

use crate::examiner::finding::Finding;

/// Maximum number of rows whose values are kept to find their step.
const KEPT: usize = 4096;
/// Largest distance of a count from a whole number: decimals are printed short.
const ROUNDED: f64 = 0.01;
/// Largest distance of a value from a whole multiple of a step, in steps.
const OFF_STEP: f64 = 0.02;
/// Largest ratio of a value to the step: a count of 128, which a rescaled source may hold.
const MOST: f64 = 128.5;
/// Minimum of the largest magnitude of counts: below a half, all would be read as zeros.
const LEAST: f64 = 0.5;
/// Share of rows with counts from which the other rows are damage.
const COUNTS: f64 = 0.99;
/// Scales that files are known to have: the value of one count, and a description.
const KNOWN: [(f64, &str); 8] = [
    (1.0 / 128.0, "counts divided by 128"),
    (1.0 / 127.0, "counts divided by 127"),
    (1e-5, "volts, 0.00001 a count"),
    (1e-2, "millivolts, 0.01 a count"),
    (10.0, "microvolts, 10 a count"),
    (1e-6, "volts, 0.000001 a count"),
    (1e-3, "millivolts, 0.001 a count"),
    (256.0, "counts times 256, the bytes of each value exchanged"),
];

/// Scale of values that should be counts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Scale {
    /// Counts, a few damaged rows among them.
    Counts,
    /// Whole multiples of the value of one count.
    Step(f64, Option<&'static str>),
    /// Values that no step makes counts of: what they are, and how to make counts of them.
    Other(&'static str, &'static str),
}

impl Scale {
    /// Value of one count, if there is one that makes counts of all values.
    pub const fn step(self) -> Option<f64> {
        match self {
            Self::Counts => Some(1.0),
            Self::Step(step, _) => Some(step),
            _ => None,
        }
    }

    /// Description of the values, and advice on converting them to counts; `None` for counts.
    fn words(self) -> Option<[String; 2]> {
        Some(match self {
            Self::Counts => return None,
            Self::Step(step, known) => [
                known.map_or_else(|| format!("whole multiples of {step}"), str::to_owned),
                if step < 1.0 {
                    format!("multiply by {} and round", (1.0 / step).round())
                } else {
                    format!("divide by {step}")
                },
            ],
            Self::Other(words, advice) => [words, advice].map(str::to_owned),
        })
    }
}

/// Detector of the scale of a file's values, row by row.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct ScaleDetector {
    values: Vec<f64>,
    rows: usize,
    counts: usize,
    least: f64,
    most: f64,
    whole: bool,
}

impl Default for ScaleDetector {
    fn default() -> Self {
        Self {
            values: Vec::new(),
            rows: 0,
            counts: 0,
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
            whole: true,
        }
    }
}

impl ScaleDetector {
    /// Adds the channels of a row.
    pub fn push(&mut self, row: &[f64]) {
        let is_count = |value: &f64| {
            (value - value.round()).abs() <= ROUNDED && (-128.0..=128.0).contains(&value.round())
        };
        self.rows += 1;
        self.counts += usize::from(row.iter().all(is_count));
        for &value in row {
            self.least = self.least.min(value);
            self.most = self.most.max(value);
            self.whole &= value.fract() == 0.0;
        }
        if self.values.len() < KEPT * row.len() {
            self.values
                .extend(row.iter().filter(|value| **value != 0.0));
        }
    }

    /// Accepts counts.
    ///
    /// # Errors
    /// The scale if the values are no counts.
    pub fn finish(&self) -> Result<(), Finding> {
        let Some([words, advice]) = self.scale().words() else {
            return Ok(());
        };
        let (least, most) = (self.least, self.most);
        let what = format!(
            "expected the armband's counts, whole numbers from -128 to 127; found values from {least} to {most}: {words}"
        );
        Err(Finding::warning("scale", what, advice))
    }

    /// Scale of the values.
    pub fn scale(&self) -> Scale {
        let largest = self.least.abs().max(self.most.abs());
        let counts = self.counts as f64 >= COUNTS * self.rows as f64 && largest >= LEAST;
        if self.rows == 0 || counts || largest == 0.0 {
            return Scale::Counts;
        }
        if self.whole && self.least >= 0.0 && self.most > 127.0 && self.most <= 255.0 {
            let values = self.values.iter();
            let middle = values.filter(|value| (64.0..192.0).contains(*value));
            return if 2 * middle.count() > self.values.len() {
                Scale::Other("bytes with 128 added", "subtract 128 from each value")
            } else {
                let advice = "subtract 256 from each value above 127";
                Scale::Other("bytes without a sign", advice)
            };
        }
        let fits = |step: f64| {
            let multiple = |value: &f64| (value / step - (value / step).round()).abs() <= OFF_STEP;
            (0.9..=MOST).contains(&(largest / step)) && self.values.iter().all(multiple)
        };
        // The largest step that fits: its multiples are multiples of smaller steps too.
        let known = KNOWN.iter().filter(|(step, _)| fits(*step));
        if let Some(&(step, name)) = known.max_by(|(a, _), (b, _)| a.total_cmp(b)) {
            return Scale::Step(step, Some(name));
        }
        let smallest = self.values.iter().map(|value| value.abs());
        let step = smallest.fold(f64::INFINITY, f64::min);
        if fits(step) {
            Scale::Step(step, None)
        } else {
            let advice = "export the armband's own samples, as they came";
            Scale::Other("filtered, normalized, or of another device", advice)
        }
    }
}
