//! The answer to `COUNTERS`.

use core::fmt;

use crate::myo::Counters;
use crate::uart_line::ParseError;
use crate::uart_line::fields::{Fields, Reader, Writer};

/// Losses since the start. The counts of dropped entries wrap; the others stay at their maximum.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Counts {
    /// Counts of the sessions with armbands.
    pub session: Counters,
    /// Packets of two samples that the inference was too slow for.
    pub packets_dropped: u32,
    /// Lines that the UART was too slow for.
    pub lines_dropped: u32,
    /// `$EMG` lines that the UART was too slow for.
    pub emg_dropped: u32,
}

/// Implements both directions of the counts, in the order of the line.
macro_rules! counts {
    ($($session:ident)+, $($own:ident)+) => {
        impl Counts {
            /// All counts, in the order of the line.
            #[must_use]
            pub const fn numbers(&self) -> [u32; 16] {
                [$(self.session.$session,)+ $(self.$own),+]
            }
        }

        impl Fields<'_> for Counts {
            type Value = Self;
            const COUNT: usize = 16;

            fn write(counts: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
                counts.numbers().iter().try_for_each(|number| u32::write(number, line))
            }

            fn read(line: &mut Reader<'_>, _name: &'static str) -> Result<Self, ParseError> {
                Ok(Self {
                    session: Counters { $($session: u32::read(line, stringify!($session))?),+ },
                    $($own: u32::read(line, stringify!($own))?),+
                })
            }
        }
    };
}
counts!(
    connections failed_connects timeouts stalls failed_set_ups refused notifications lost given_up duplicates
    reordered malformed foreign,
    packets_dropped lines_dropped emg_dropped
);
