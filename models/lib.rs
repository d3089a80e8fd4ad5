//! Shipped model files.

#![no_std]
#![deny(missing_docs)]
#![forbid(unsafe_code)]

/// File that begins at a multiple of four, as the reader of models requires.
#[repr(align(4))]
struct Aligned<const N: usize>([u8; N]);

macro_rules! model {
    ($name:literal) => {
        &Aligned(*include_bytes!($name)).0
    };
}

/// Model of three classes: relax, open, close.
pub const THREE_CLASS: &[u8] = model!("three-class.intent");

/// File names and contents.
pub const SHIPPED: [(&str, &[u8]); 3] = [
    ("three-class.intent", THREE_CLASS),
    ("five-class.intent", model!("five-class.intent")),
    ("six-class.intent", model!("six-class.intent")),
];
