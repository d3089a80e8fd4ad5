//! Arrays of numpy: any bytes, and any header in front of any elements.

use crate::input::Input;
use recordings::readers::npy::{Values, encode, parse};

/// Element types that are read, and some that are not.
const TYPES: [&str; 12] = [
    "|i1", "<i2", "<i4", "<i8", "|u1", "<u8", "<f4", "<f8", "|b1", "|S7", "<U7", ">f8",
];

/// Takes a file unchanged, then its bytes as elements behind a header of any shape.
pub fn run(data: &[u8]) {
    check(data);
    let mut input = Input(data);
    let descr = TYPES[input.below(TYPES.len())];
    let axes = input.below(4);
    let shape: Vec<usize> = (0..axes)
        .map(|_| match input.byte() {
            few @ 0..=239 => usize::from(few),
            // Huge axes whose product does not fit.
            _ => input.word() as usize * input.word() as usize,
        })
        .collect();
    check(&encode(descr, &shape, input.0));
}

fn check(bytes: &[u8]) {
    let Ok(array) = parse(bytes) else { return };
    let elements = match &array.values {
        Values::Numbers(values) => values.len(),
        Values::Text(values) => values.len(),
    };
    let product = array
        .shape
        .iter()
        .try_fold(1_usize, |product, &axis| product.checked_mul(axis));
    // An array without elements may have any other axes.
    assert!(
        product.is_none_or(|product| product == elements),
        "{}",
        array.describe()
    );
    assert!(elements <= bytes.len(), "no more elements than bytes");
    let rows = array.shape.first().copied().unwrap_or(1);
    if elements > 0 {
        assert!(
            array.byte_of_row(rows - 1) < bytes.len() as u64,
            "the last row is in the file"
        );
    }
}
