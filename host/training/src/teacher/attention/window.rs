//! Attention of one window, for each head in blocks of queries.
//!
//! The forward pass computes a block of scores and its softmax and uses them while they are in the
//! cache. It keeps two numbers per query, from which the backward pass computes the weights again.
//! Source of the backward pass: FlashAttention (arXiv 2205.14135), appendix B.

use pulp::{Simd, WithSimd};

use crate::optimization::dropout::Mask;
use crate::optimization::kernels::matmul::{Rows, RowsMut, Transposed, padded, product};
use crate::optimization::kernels::softmax::{self, RowStatistics};

/// Number of scores in a block: with their gradients, they take half of a 2 MiB cache.
const BLOCK: usize = 128 * 1024;

/// Queries, keys and values of one window.
#[derive(Clone, Copy)]
pub(super) struct Window<'a> {
    /// Queries, keys and values, `[tokens, 3 d]`.
    pub qkv: &'a [f32],
    /// Number of tokens, from the first, that attend and are attended to.
    pub attending: usize,
    /// Number of tokens.
    pub tokens: usize,
    /// Width of a token.
    pub d: usize,
    /// Number of heads; each is a contiguous part of a token.
    pub heads: usize,
    /// Dropout of the attention weights, and the mask's row of the first head's first query.
    pub mask: Option<(Mask, usize)>,
}

/// The forward pass of a window.
pub(super) struct Forward<'a> {
    pub window: Window<'a>,
    /// Output, `[tokens, d]`; must be zeros before.
    pub output: &'a mut [f32],
    /// Softmax statistics of each query, `[heads, tokens]`.
    pub statistics: &'a mut [RowStatistics],
}

/// The backward pass of a window.
pub(super) struct Backward<'a> {
    pub window: Window<'a>,
    /// Softmax statistics of the forward pass.
    pub statistics: &'a [RowStatistics],
    /// Gradient of the output, `[tokens, d]`.
    pub gradient: &'a [f32],
    /// Gradients of queries, keys and values, `[tokens, 3 d]`; must be zeros before.
    pub gradients: &'a mut [f32],
}

impl<'a> Window<'a> {
    fn width(&self) -> usize {
        self.d / self.heads
    }

    fn scale(&self) -> f32 {
        1.0 / (self.width() as f32).sqrt()
    }

    /// Number of queries in a block.
    fn block(&self) -> usize {
        (BLOCK / padded(self.attending).max(1)).clamp(1, self.attending.max(1))
    }

    /// View of a head's queries (part 0), keys (1) or values (2), not copied.
    #[inline(always)]
    fn part(&self, head: usize, part: usize) -> Rows<'a> {
        head_of(self.qkv, part * self.d + head * self.width(), 3 * self.d)
    }

    /// Sets the dropped weights of a query to 0.
    #[inline(always)]
    fn drop(&self, head: usize, query: usize, weights: &mut [f32]) {
        if let Some((mask, first)) = self.mask {
            mask.row(first + head * self.tokens + query).zero(weights);
        }
    }

    /// Factor of the weights that are not dropped.
    fn dropout_scale(&self) -> f32 {
        self.mask.map_or(1.0, |(mask, _)| mask.scale)
    }
}

#[inline(always)]
fn head_of(values: &[f32], first: usize, stride: usize) -> Rows<'_> {
    Rows {
        values: values.get(first..).unwrap_or_default(),
        stride,
    }
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            window,
            output,
            statistics,
        } = self;
        let (width, attending, scale) = (window.width(), window.attending, window.scale());
        let (columns, keys, block) = (padded(width), padded(attending), window.block());
        let mut scores = vec![0.0; block * keys];
        let mut attended = vec![0.0; block * columns];
        let mut factors = vec![0.0; block];
        for head in 0..window.heads {
            let transposed_keys = transposed(window.part(head, 1), attending, width);
            let values = padded_copy(window.part(head, 2), attending, width);
            for start in (0..attending).step_by(block) {
                let rows = block.min(attending - start);
                let queries = window.part(head, 0).from(start, 0);
                let sizes = [rows, width, keys];
                let to = matrix_mut(&mut scores, keys);
                product::<S, false>(simd, to, queries, matrix(&transposed_keys, keys), sizes);
                for row in 0..rows {
                    let (query, scores) = (start + row, &mut scores[row * keys..][..attending]);
                    let row_statistics = softmax::exponentials(scores, scale);
                    statistics[head * window.tokens + query] = row_statistics;
                    factors[row] = row_statistics.inverse_sum * window.dropout_scale();
                    window.drop(head, query, scores);
                }
                let weights = matrix(&scores, keys);
                let sizes = [rows, attending, columns];
                let to = matrix_mut(&mut attended, columns);
                product::<S, false>(simd, to, weights, matrix(&values, columns), sizes);
                for row in 0..rows {
                    let to = &mut output[(start + row) * window.d + head * width..][..width];
                    for (to, from) in to.iter_mut().zip(&attended[row * columns..]) {
                        *to = from * factors[row];
                    }
                }
            }
        }
    }
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { window, .. } = self;
        let (width, attending, scale) = (window.width(), window.attending, window.scale());
        let (columns, keys, block) = (padded(width), padded(attending), window.block());
        let mut weights = vec![0.0; block * keys];
        let mut scores = vec![0.0; block * keys];
        let mut factors = vec![0.0; attending];
        for head in 0..window.heads {
            let gradient = head_of(self.gradient, head * width, window.d);
            let transposed_keys = transposed(window.part(head, 1), attending, width);
            let transposed_values = transposed(window.part(head, 2), attending, width);
            let [query, key] =
                [0, 1].map(|part| padded_copy(window.part(head, part), attending, width));
            let padded_gradient = padded_copy(gradient, attending, width);
            let mut sums = [0, 1, 2].map(|_| vec![0.0; attending * columns]);
            for start in (0..attending).step_by(block) {
                let rows = block.min(attending - start);
                let queries = window.part(head, 0).from(start, 0);
                let sizes = [rows, width, keys];
                let to = matrix_mut(&mut weights, keys);
                product::<S, false>(simd, to, queries, matrix(&transposed_keys, keys), sizes);
                let gradients = gradient.from(start, 0);
                let to = matrix_mut(&mut scores, keys);
                let values = matrix(&transposed_values, keys);
                product::<S, false>(simd, to, gradients, values, sizes);
                for row in 0..rows {
                    let query = start + row;
                    factors.fill(window.dropout_scale());
                    window.drop(head, query, &mut factors);
                    softmax::backward(
                        &mut weights[row * keys..][..attending],
                        &mut scores[row * keys..][..attending],
                        &factors,
                        self.statistics[head * window.tokens + query],
                        scale,
                    );
                }
                let scores = matrix(&scores, keys);
                let weights = Transposed(matrix(&weights, keys));
                let [by_query, by_key, by_value] = &mut sums;
                let mut by_query = matrix_mut(by_query, columns);
                let to = by_query.from(start, 0);
                let sizes = [rows, attending, columns];
                product::<S, false>(simd, to, scores, matrix(&key, columns), sizes);
                let scores = Transposed(scores);
                let to = matrix_mut(by_key, columns);
                let sizes = [attending, rows, columns];
                let query = matrix(&query, columns).from(start, 0);
                product::<S, true>(simd, to, scores, query, sizes);
                let to = matrix_mut(by_value, columns);
                let gradient = matrix(&padded_gradient, columns).from(start, 0);
                product::<S, true>(simd, to, weights, gradient, sizes);
            }
            for (part, sums) in sums.iter().enumerate() {
                for (token, sums) in sums.chunks_exact(columns).enumerate() {
                    let first = (3 * token + part) * window.d + head * width;
                    self.gradients[first..][..width].copy_from_slice(&sums[..width]);
                }
            }
        }
    }
}

#[inline(always)]
fn matrix(values: &[f32], stride: usize) -> Rows<'_> {
    Rows { values, stride }
}

#[inline(always)]
fn matrix_mut(values: &mut [f32], stride: usize) -> RowsMut<'_> {
    RowsMut { values, stride }
}

/// A copy with padded rows, `[rows, padded width]`.
#[inline(always)]
fn padded_copy(of: Rows<'_>, rows: usize, width: usize) -> Vec<f32> {
    let columns = padded(width);
    let mut values = vec![0.0; rows * columns];
    for (row, to) in values.chunks_exact_mut(columns).enumerate() {
        to[..width].copy_from_slice(of.row(row, width));
    }
    values
}

/// A transposed copy with padded rows, `[width, padded rows]`.
#[inline(always)]
fn transposed(of: Rows<'_>, rows: usize, width: usize) -> Vec<f32> {
    let columns = padded(rows);
    let mut values = vec![0.0; width * columns];
    for row in 0..rows {
        for (column, value) in of.row(row, width).iter().enumerate() {
            values[column * columns + row] = *value;
        }
    }
    values
}
