//! Names within errors: of a tensor, or as found in a file.

use core::fmt;

/// The tensor of an error, displayed as `layers[1].qkv.scales`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TensorName {
    /// Index of the layer; none for tensors outside the layers.
    pub layer: Option<usize>,
    /// Group, such as `qkv`.
    pub group: &'static str,
    /// Tensor of the group, such as `scales`. Empty if the group is a single tensor.
    pub part: &'static str,
}

impl fmt::Display for TensorName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(layer) = self.layer {
            write!(out, "layers[{layer}].")?;
        }
        out.write_str(self.group)?;
        if self.part.is_empty() {
            return Ok(());
        }
        write!(out, ".{}", self.part)
    }
}

/// The first 16 bytes of a text: a copy, so that an error has no lifetime.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Excerpt {
    bytes: [u8; 16],
    length: u8,
}

impl Excerpt {
    pub(super) fn of(text: &str) -> Self {
        let mut bytes = [0; 16];
        let mut end = text.len().min(bytes.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        bytes[..end].copy_from_slice(&text.as_bytes()[..end]);
        Self {
            bytes,
            length: end as u8,
        }
    }
}

impl fmt::Display for Excerpt {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = &self.bytes[..usize::from(self.length)];
        out.write_str(core::str::from_utf8(text).unwrap_or_default())
    }
}
