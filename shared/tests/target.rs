//! Targets that the build script gives the DSP kernels.

#[expect(dead_code, reason = "the build script's own entry point")]
#[path = "../build.rs"]
mod build;

#[test]
fn only_hard_float_targets_with_dsp_instructions_run_the_dsp_kernels() {
    for target in ["thumbv7em-none-eabihf", "thumbv7em-nuttx-eabihf"] {
        assert!(build::runs_dsp_kernels(target), "{target}");
    }
    for target in [
        "thumbv7em-none-eabi",
        "thumbv7m-none-eabi",
        "thumbv8m.main-none-eabihf",
        "x86_64-unknown-linux-gnu",
    ] {
        assert!(!build::runs_dsp_kernels(target), "{target}");
    }
}
