//! Nordic's libraries in an image: where they are, and the functions by which the program enters them.

use std::collections::BTreeMap;
use std::ops::Range;

/// Beginnings of the names of the libraries' functions; internal ones are `sym_` and a checksum.
const PREFIXES: [&str; 4] = ["sdc_", "mpsl_", "MPSL_IRQ_", "sym_"];

/// The libraries of an image: the controller, and MPSL, the scheduler below it.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Library {
    /// Addresses of its instructions.
    pub range: Range<u32>,
    /// Functions by their addresses.
    pub functions: BTreeMap<u32, String>,
}

impl Library {
    /// Finds the libraries among an image's functions, each with address, size and name; `None` in an image without them.
    ///
    /// # Panics
    /// If the linker put another function in between: nothing would tell their instructions apart.
    pub fn find(all: &[(u32, u32, String)]) -> Option<Self> {
        let is_ours = |name: &str| PREFIXES.iter().any(|prefix| name.starts_with(prefix));
        let ours = || all.iter().filter(|(.., name)| is_ours(name));
        let start = ours().map(|(start, ..)| *start).min()?;
        let end = ours().map(|(start, size, _)| start + size).max()?;
        let foreign = all
            .iter()
            .find(|(at, _, name)| (start..end).contains(at) && !is_ours(name));
        assert_eq!(foreign, None, "amid Nordic's library");
        let functions = ours().map(|(start, _, name)| (*start, name.clone()));
        Some(Self {
            range: start..end,
            functions: functions.collect(),
        })
    }

    /// Returns the address to which functions of the program return that the library has called: within its range, the
    /// start of no function.
    pub const fn gate(&self) -> u32 {
        self.range.start + 2
    }
}
