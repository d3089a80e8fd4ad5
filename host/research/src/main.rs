//! The binary `myointent-research`.

use std::process::ExitCode;

use clap::Parser;
use myointent_research::cli::Cli;

// Training allocates and frees thousands of large tensors; this allocator keeps their pages.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    Cli::parse().run()
}
