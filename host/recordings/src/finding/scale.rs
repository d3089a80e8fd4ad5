//! Scale of values that are no counts.

/// Scale of values that should be counts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Scale {
    /// Whole multiples of the value of one count.
    Step {
        /// The value of one count.
        step: f64,
        /// Name of the scale, if it is a known one.
        known: Option<&'static str>,
    },
    /// Bytes without a sign, 0 to 255: those above 127 are negative counts.
    Unsigned,
    /// Bytes with 128 added, 0 to 255.
    Offset,
    /// Values that are multiples of no step.
    Unknown,
}

impl Scale {
    /// Description of the values.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Step {
                known: Some(known), ..
            } => known.to_owned(),
            Self::Step { step, known: None } => format!("whole multiples of {step}"),
            Self::Unsigned => "bytes without a sign".to_owned(),
            Self::Offset => "bytes with 128 added".to_owned(),
            Self::Unknown => "filtered, normalized, or of another device".to_owned(),
        }
    }

    /// Advice on converting the values to counts.
    pub(crate) fn advice(self) -> String {
        match self {
            Self::Step { step, .. } if step < 1.0 => {
                format!("multiply by {} and round", (1.0 / step).round())
            }
            Self::Step { step, .. } => format!("divide by {step}"),
            Self::Unsigned => "subtract 256 from each value above 127".to_owned(),
            Self::Offset => "subtract 128 from each value".to_owned(),
            Self::Unknown => "export the armband's own samples, as they came".to_owned(),
        }
    }
}
