//! MATLAB files: any bytes behind a right head, and any variables, compressed or not.

use crate::dataset::mat_fixture::{compressed, file, variable};
use crate::dataset::readers::mat::parse;
use crate::input::Input;

/// A file as it is, its bytes behind a head, and its bytes as the content of variables.
pub fn run(data: &[u8]) {
    check(data);
    check(&file(&[data.to_vec()]));
    let mut input = Input(data);
    let mut variables = Vec::new();
    while !input.is_empty() && variables.len() < 4 {
        let how = input.byte();
        let name = String::from_utf8_lossy(input.take(usize::from(how % 8))).into_owned();
        let shape = [i32::from_le_bytes(input.array()), i32::from(input.byte())];
        let (class, kind) = (input.byte() % 17, u32::from(input.byte() % 16));
        let mut content = variable(&name, shape, class, kind, input.short());
        if how & 0x10 != 0 {
            let at = input.byte();
            let changed = input.byte();
            let count = content.len();
            content[usize::from(at) % count] = changed;
        }
        variables.push(if how & 0x80 != 0 {
            compressed(&content)
        } else {
            content
        });
    }
    check(&file(&variables));
}

fn check(bytes: &[u8]) {
    let Ok(matrices) = parse(bytes) else { return };
    for matrix in matrices {
        let [rows, columns] = matrix.shape;
        assert_eq!(rows.checked_mul(columns), Some(matrix.values.len()));
        assert!(matrix.byte < bytes.len() as u64);
        if rows > 0 && columns > 0 {
            let _ = matrix.at(rows - 1, columns - 1);
        }
    }
}
