//! Shipped model files.

#![no_std]
#![deny(missing_docs)]
#![forbid(unsafe_code)]

/// Model of three classes: relax, open, close.
pub const THREE_CLASS: &[u8] = include_bytes!("three-class.intent");

/// File names and contents.
pub const SHIPPED: [(&str, &[u8]); 3] = [
    ("three-class.intent", THREE_CLASS),
    ("five-class.intent", include_bytes!("five-class.intent")),
    ("six-class.intent", include_bytes!("six-class.intent")),
];
