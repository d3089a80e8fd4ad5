//! The command line of `myointent`.

use std::process::ExitCode;

use myointent::cli::Cli;

// Training allocates and frees large tensors by the thousand; this allocator keeps their pages.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    Cli::from_command_line().run()
}
