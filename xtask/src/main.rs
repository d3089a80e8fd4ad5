//! `cargo xtask STEP`: see the library.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

use clap::Parser as _;
use xtask::steps::Arguments;

fn main() -> anyhow::Result<()> {
    Arguments::parse().run()
}
