//! Attributes of a device that calls itself an armband: any values at any handles.

use shared::myo::{Attribute, Discovery};

use crate::input::Input;

/// Takes a value for each read, short and with its length in front; 255: the read is refused.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let mut discovery = Discovery::new();
    let (mut reads, mut last, mut found) = (0, 0, Vec::new());
    while let Some(handle) = discovery.handle() {
        reads += 1;
        assert!(
            handle > last && handle <= 128 && reads <= 128,
            "the search ends"
        );
        last = handle;
        let value = match input.byte() {
            u8::MAX => None,
            count => Some(input.take(usize::from(count % 32))),
        };
        let Some(attribute) = discovery.answered(value) else {
            continue;
        };
        let (Attribute::Value(_, place) | Attribute::Subscription(_, place)) = attribute;
        assert!((1..=128).contains(&place), "a handle that was looked at");
        assert!(!found.contains(&attribute), "named twice");
        found.push(attribute);
    }
}
