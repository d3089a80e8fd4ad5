//! Arguments of the command.

use crate::cli::Cli;
use clap::Parser as _;

#[cfg(target_os = "linux")]
mod boards;

#[test]
fn a_file_is_written_or_a_board_is_flashed() {
    let refused = |line: &[&str]| {
        let line = ["myointent", "flash"].iter().chain(line);
        Cli::try_parse_from(line).unwrap_err().to_string()
    };
    let both = refused(&["--model", "x", "--out", "y", "--port", "z"]);
    assert!(both.contains("cannot be used with"), "{both}");
    let other = refused(&["--board", "uno"]);
    assert!(other.contains("xiao, feather, nice-nano"), "{other}");
}
