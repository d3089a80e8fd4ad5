//! The command line of `myointent`.

fn main() {}
