//! Bytes as words of flash, which aligns them as a model requires.

/// Makes words of flash, so many bytes, that begin with `bytes` and are erased behind them.
pub fn flashed(bytes: &[u8], length: usize) -> Vec<u32> {
    let mut words = vec![u32::MAX; length.div_ceil(4)];
    bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
    words
}
