//! Command line and files of the host, by semihosting.

use alloc::{ffi::CString, string::String, vec, vec::Vec};

use semihosting::{
    fs::File,
    io::{self, Read as _},
};

/// Reads a whole file.
///
/// # Panics
/// On a path with a zero byte.
pub fn read(path: &str) -> io::Result<Vec<u8>> {
    let path = CString::new(path).expect("a path without zero bytes");
    let mut file = File::open(path.as_c_str())?;
    let length = file.metadata()?.len();
    let mut bytes = vec![0; length as usize];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Words of the command line after the program's name.
pub type Arguments = Vec<String>;

/// Returns the words that `-semihosting-config arg=...` passed after the program's name.
///
/// # Panics
/// On a command line above 1 KiB, or not of UTF-8.
pub fn arguments() -> Arguments {
    let line = semihosting::experimental::env::args::<1024>().expect("a command line");
    line.skip(1)
        .map(|word| word.expect("UTF-8").into())
        .collect()
}
