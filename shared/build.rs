//! Says whether the target is a core with the DSP instructions of a Cortex-M4.
//!
//! Stable Rust does not tell a program of the `dsp` feature of its target; the target's name does.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(cortex_m4)");
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv7em-")) {
        println!("cargo::rustc-cfg=cortex_m4");
    }
}
