//! The UART line of an alignment: begun, a gesture found, the result.
//!
//! ```text
//! line     = "$" body "*" checksum CR LF
//! body     = "ALIGN," sequence "," emitted "," state "," gestures "," turn "," mirrored ","
//!            distance "," margin
//! sequence = number            of the line, in one count with the others
//! emitted  = number            index of the newest sample received by then
//! state    = "waiting"         open the hand, with rest before and after
//!          | "aligned"         the electrodes are as `turn` and `mirrored` say from here on
//!          | "poor-distance"   nothing changed: the gestures look like no open hand
//!          | "poor-margin"     nothing changed: two placements look nearly as good; or, where these are on different
//!                              arms, samples were lost while the model decided
//!          | "timeout"         nothing changed: fewer than two gestures in 30 s
//!          | "cancelled"       nothing changed: on request
//!          | "disconnected"    the armband may have been taken off: as in training again
//!          | "unavailable"     the model has no template
//!          | "set"             `turn` and `mirrored` were given
//! gestures = number            found so far
//! turn     = "0" ... "7"       places that the armband is turned by, as in force now
//! mirrored = "0" | "1"         whether the electrodes run the other way round, as in force now
//! distance = number | "-"      of the gestures from the template, hundredths of a nat; with a result alone
//! margin   = number | "-"      how much further the best other placement is, likewise
//! ```
//!
//! `number` and `checksum` are those of the other lines.
//!
//! ```text
//! $ALIGN,3,660,waiting,0,0,0,-,-*15
//! $ALIGN,97,2550,aligned,2,5,0,214,1130*2E
//! ```

use core::fmt;

use super::{ParseError, fields, flag, framed, number, write_framed};
use crate::stream::alignment::{Alignment, Fit, NAT};
use crate::units::SampleIndex;

/// State of an alignment.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum AlignmentState {
    /// Gestures are waited for.
    Waiting,
    /// A placement was found and is in force.
    Aligned,
    /// No placement looks like an open hand.
    PoorDistance,
    /// Another placement looks nearly as good.
    PoorMargin,
    /// Too few gestures in time.
    Timeout,
    /// Ended on request.
    Cancelled,
    /// The alignment was dropped with the connection.
    Disconnected,
    /// The model has no template.
    Unavailable,
    /// An alignment was given from outside.
    Set,
}

impl AlignmentState {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Waiting,
        Self::Aligned,
        Self::PoorDistance,
        Self::PoorMargin,
        Self::Timeout,
        Self::Cancelled,
        Self::Disconnected,
        Self::Unavailable,
        Self::Set,
    ];

    /// Name on the line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Aligned => "aligned",
            Self::PoorDistance => "poor-distance",
            Self::PoorMargin => "poor-margin",
            Self::Timeout => "timeout",
            Self::Cancelled => "cancelled",
            Self::Disconnected => "disconnected",
            Self::Unavailable => "unavailable",
            Self::Set => "set",
        }
    }
}

/// Content of a line. `Display` writes the line, CR LF included: at most 77 bytes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct AlignmentReport {
    /// Number of the line, from 0; wraps.
    pub sequence: u32,
    /// The newest sample received when it was written.
    pub emitted: SampleIndex,
    /// What happened.
    pub state: AlignmentState,
    /// Gestures found so far.
    pub gestures: u8,
    /// In force now.
    pub alignment: Alignment,
    /// Distance and margin of the best placement ([`Fit::distance`], [`Fit::margin`]); with a result alone.
    pub quality: Option<(u32, u32)>,
}

impl AlignmentReport {
    /// Distance and margin of a fit, in hundredths of a nat.
    #[must_use]
    pub(crate) const fn quality_of(fit: Fit) -> (u32, u32) {
        (hundredths(fit.distance), hundredths(fit.margin))
    }

    /// Reads one line, CR LF included.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field.
    pub fn parse(line: &[u8]) -> Result<Self, ParseError> {
        let [
            kind,
            sequence,
            emitted,
            state,
            gestures,
            turn,
            mirrored,
            distance,
            margin,
        ] = fields(framed(line)?)?;
        let wrong = |field| ParseError::Field { field };
        if kind != "ALIGN" {
            return Err(wrong("kind"));
        }
        let sequence = number(sequence, "sequence")?;
        let emitted = SampleIndex(number(emitted, "emitted")?);
        let named = AlignmentState::ALL
            .into_iter()
            .find(|known| known.name() == state);
        let gestures = u8::try_from(number(gestures, "gestures")?);
        let turn = number(turn, "turn")?;
        let turn = u8::try_from(turn).ok().filter(|turn| *turn < 8);
        Ok(Self {
            sequence,
            emitted,
            state: named.ok_or(wrong("state"))?,
            gestures: gestures.map_err(|_| wrong("gestures"))?,
            alignment: Alignment::new(
                turn.ok_or(wrong("turn"))?,
                flag(mirrored).ok_or(wrong("mirrored"))?,
            ),
            quality: match (distance, margin) {
                ("-", "-") => None,
                _ => Some((number(distance, "distance")?, number(margin, "margin")?)),
            },
        })
    }
}

impl fmt::Display for AlignmentReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = format_args!(
            "ALIGN,{},{},{},{},{},{}",
            self.sequence,
            self.emitted.0,
            self.state.name(),
            self.gestures,
            self.alignment.turn(),
            u8::from(self.alignment.mirrored()),
        );
        match self.quality {
            Some((distance, margin)) => {
                write_framed(formatter, format_args!("{head},{distance},{margin}"))
            }
            None => write_framed(formatter, format_args!("{head},-,-")),
        }
    }
}

/// Of a nat.
const fn hundredths(distance: u32) -> u32 {
    (distance as u64 * 100 / NAT as u64) as u32
}

/// Reads `turn,mirrored`.
pub(super) fn placement(text: &str) -> Option<Alignment> {
    let (turn, mirrored) = text.split_once(',')?;
    let turn = u8::try_from(number(turn, "turn").ok()?).ok()?;
    let mirrored = flag(mirrored)?;
    (turn < 8).then(|| Alignment::new(turn, mirrored))
}

/// `turn,mirrored`
pub(super) struct Placed(pub(super) Alignment);

impl fmt::Display for Placed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(alignment) = self;
        let mirrored = u8::from(alignment.mirrored());
        write!(formatter, "{},{mirrored}", alignment.turn())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;
    use proptest::prelude::*;

    const WAITING: AlignmentReport = AlignmentReport {
        sequence: 3,
        emitted: SampleIndex(660),
        state: AlignmentState::Waiting,
        gestures: 0,
        alignment: Alignment::NONE,
        quality: None,
    };

    #[test]
    fn lines_are_those_of_the_documentation() {
        assert_eq!(WAITING.to_string(), "$ALIGN,3,660,waiting,0,0,0,-,-*15\r\n");
        let aligned = AlignmentReport {
            sequence: 97,
            emitted: SampleIndex(2550),
            state: AlignmentState::Aligned,
            gestures: 2,
            alignment: Alignment::new(5, false),
            quality: Some((214, 1130)),
        };
        assert_eq!(
            aligned.to_string(),
            "$ALIGN,97,2550,aligned,2,5,0,214,1130*2E\r\n"
        );
    }

    #[test]
    fn the_longest_line_has_77_bytes() {
        let longest = AlignmentReport {
            sequence: u32::MAX,
            emitted: SampleIndex(u32::MAX),
            state: AlignmentState::PoorDistance,
            gestures: u8::MAX,
            alignment: Alignment::new(7, true),
            quality: Some((u32::MAX, u32::MAX)),
        };
        assert_eq!(longest.to_string().len(), 77);
    }

    #[test]
    fn each_wrong_field_is_named() {
        let line = WAITING.to_string();
        let with = |from: &str, to: &str| {
            let body = line[1..line.len() - 5].replacen(from, to, 1);
            let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
            AlignmentReport::parse(alloc::format!("${body}*{sum:02X}\r\n").as_bytes())
        };
        let field = |field| Err(ParseError::Field { field });
        assert_eq!(with("ALIGN", "LABEL"), field("kind"));
        assert_eq!(with(",3,", ",03,"), field("sequence"));
        assert_eq!(with("660", "x"), field("emitted"));
        assert_eq!(with("waiting", "wait"), field("state"));
        assert_eq!(with("waiting,0", "waiting,256"), field("gestures"));
        assert_eq!(with("0,0,0", "0,8,0"), field("turn"));
        assert_eq!(with("0,0,0", "0,0,2"), field("mirrored"));
        assert_eq!(with("-,-", "-,1"), field("distance"));
        assert_eq!(with("-,-", "1,-"), field("margin"));
        let found = with("-,-", "-");
        assert_eq!(
            found,
            Err(ParseError::Fields {
                expected: 9,
                found: 8
            })
        );
    }

    proptest! {
        #[test]
        fn every_report_is_read_back(
            (sequence, emitted, gestures) in any::<(u32, u32, u8)>(),
            (state, turn, mirrored) in (0_usize..9, 0_u8..8, any::<bool>()),
            quality in any::<Option<(u32, u32)>>(),
        ) {
            let report = AlignmentReport {
                sequence,
                emitted: SampleIndex(emitted),
                state: AlignmentState::ALL[state],
                gestures,
                alignment: Alignment::new(turn, mirrored),
                quality,
            };
            prop_assert_eq!(AlignmentReport::parse(report.to_string().as_bytes()), Ok(report));
        }

        #[test]
        fn arbitrary_bytes_never_panic(bytes: alloc::vec::Vec<u8>) {
            let _ = AlignmentReport::parse(&bytes);
        }
    }
}
