//! Runs a golden check from a file that the PC has written. The argument is its path.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![forbid(unsafe_code)]

#[cfg(target_os = "none")]
mod image {
    use checks::Check;
    use device::{arguments, files};

    fn main() {
        let path = arguments().into_iter().next().expect("the check's file");
        let bytes = files::read(&path).expect("a readable file");
        let check: Check = postcard::from_bytes(&bytes).expect("a check of this version");
        check.run();
    }

    device::entry!(main);
}

/// Points to `cargo test --test on_device`: on a PC there is nothing to emulate.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the emulated core: `cargo test --test on_device`");
}
