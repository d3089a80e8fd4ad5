//! The command line of the emulated program.

use alloc::{string::String, vec::Vec};

/// Words of the command line after the program's name.
pub type Arguments = Vec<String>;

/// Returns the words that `-semihosting-config arg=...` passed after the program's name.
///
/// # Panics
/// On a command line above 1 KiB, or not of UTF-8.
#[must_use]
pub fn arguments() -> Arguments {
    let line = semihosting::experimental::env::args::<1024>().expect("a command line");
    line.skip(1)
        .map(|word| word.expect("UTF-8").into())
        .collect()
}
