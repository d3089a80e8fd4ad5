//! Files of the host, by semihosting.

use alloc::{ffi::CString, vec, vec::Vec};

use semihosting::{
    fs::File,
    io::{self, Read as _},
};

/// Reads a whole file.
///
/// # Errors
/// Where the emulator cannot open or read it.
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
