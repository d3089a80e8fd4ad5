//! Which targets the build script of the firmware accepts.

#[expect(dead_code, reason = "the build script's own entry point")]
#[path = "../firmware/build.rs"]
mod build;

#[test]
fn only_the_hard_float_target_with_dsp_instructions_is_a_boards() {
    assert!(build::has_fpu_and_dsp("thumbv7em-none-eabihf"));
    for target in [
        "thumbv7em-none-eabi",
        "thumbv7m-none-eabi",
        "thumbv8m.main-none-eabihf",
    ] {
        assert!(!build::has_fpu_and_dsp(target), "{target}");
    }
}
