//! Sets `cfg(cortex_m4)` for targets that run the DSP kernels.
//!
//! Stable Rust does not show a program the target features `dsp` and hard-float ABI; the target's name
//! does.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(cortex_m4)");
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("TARGET").is_ok_and(|target| runs_dsp_kernels(&target)) {
        println!("cargo::rustc-cfg=cortex_m4");
    }
}

/// Whether the target has the DSP instructions (`thumbv7em`) and the hard-float ABI (`eabihf`).
///
/// The kernels take a float argument in s0 and use the FPU. On a soft-float target (`eabi`) the caller
/// would pass it in a core register, and the core may have no FPU: such targets run the portable
/// kernels.
pub(crate) fn runs_dsp_kernels(target: &str) -> bool {
    target.starts_with("thumbv7em-") && target.ends_with("eabihf")
}
