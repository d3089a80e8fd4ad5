//! Coverage-guided fuzzing of the code that takes input from outside: `cargo xtask fuzz`.
//!
//! The program has all targets; `MYOINTENT_FUZZ_TARGET` names the one that it runs. A target takes any bytes and
//! panics if a condition of the answer does not hold: libFuzzer looks for such bytes.
//!
//! | module | content |
//! | --- | --- |
//! | [`targets`] | the targets, each a file; registered in [`targets::ALL`] |
//! | [`input`] | reads an input's bytes as numbers and choices |
//! | [`radio`] | a session with an armband, and the conditions of its actions |
#![no_main]
#![forbid(unsafe_code)]

mod input;
mod radio;
mod targets;

use std::sync::LazyLock;

use targets::Target;

/// Target that the environment names.
static TARGET: LazyLock<Target> = LazyLock::new(|| {
    let name = std::env::var("MYOINTENT_FUZZ_TARGET").unwrap_or_default();
    let found = targets::ALL.into_iter().find(|target| target.name == name);
    found.unwrap_or_else(|| {
        let names = targets::ALL.map(|target| target.name).join(", ");
        panic!("MYOINTENT_FUZZ_TARGET is \"{name}\", expected one of {names}")
    })
});

/// Lists the targets if xtask asks for them.
fn asked() {
    if std::env::var_os("MYOINTENT_FUZZ_LIST").is_some() {
        targets::ALL
            .iter()
            .for_each(|target| println!("{} {}", target.name, target.longest));
        std::process::exit(0);
    }
}

libfuzzer_sys::fuzz_target!(init: asked(), |data: &[u8]| (TARGET.run)(data));
