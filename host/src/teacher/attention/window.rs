//! Attention of one window, head by head, block of queries by block of queries.
//!
//! Forward, the scores of a block are made, weighed and used while they lie in the cache; what is
//! kept of them is two numbers a query. Backward, they are made once more.
//! Source of the rearranged backward pass: FlashAttention (arXiv 2205.14135), appendix B.

use pulp::{Simd, WithSimd};

use super::product::{Rows, Transposed, padded, product};
use super::rows::{Norm, unweigh, weigh};
use crate::training::dropout::Mask;

/// Scores of a block: with those of the backward pass, they fill half of a cache of 2 MiB.
const BLOCK: usize = 128 * 1024;

/// One window's queries, keys and values.
#[derive(Clone, Copy)]
pub struct Window<'a> {
    /// `[tokens, 3 d]`.
    pub qkv: &'a [f32],
    /// Tokens that look and are looked at, the first ones.
    pub seen: usize,
    /// Tokens.
    pub tokens: usize,
    /// Width of a token.
    pub d: usize,
    /// Heads, contiguous parts of a token.
    pub heads: usize,
    /// What is dropped of the weights, and the mask's row of the first head's first query.
    pub mask: Option<(Mask, usize)>,
}

/// The forward pass of a window.
pub struct Forward<'a> {
    pub window: Window<'a>,
    /// Attention, `[tokens, d]`; 0 before.
    pub output: &'a mut [f32],
    /// What makes weights of each query's scores, `[heads, tokens]`.
    pub norms: &'a mut [Norm],
}

/// The backward pass of a window.
pub struct Backward<'a> {
    pub window: Window<'a>,
    /// What the forward pass kept.
    pub norms: &'a [Norm],
    /// Gradient of the output, `[tokens, d]`.
    pub gradient: &'a [f32],
    /// Gradients of queries, keys and values, `[tokens, 3 d]`; 0 before.
    pub gradients: &'a mut [f32],
}

impl<'a> Window<'a> {
    fn width(&self) -> usize {
        self.d / self.heads
    }

    fn scale(&self) -> f32 {
        1.0 / (self.width() as f32).sqrt()
    }

    /// Queries of a block.
    fn block(&self) -> usize {
        (BLOCK / padded(self.seen).max(1)).clamp(1, self.seen.max(1))
    }

    /// A head's queries (part 0), keys (1) or values (2), where they are.
    #[inline(always)]
    fn part(&self, head: usize, part: usize) -> Rows<'a> {
        head_of(self.qkv, part * self.d + head * self.width(), 3 * self.d)
    }

    /// Sets what is dropped of a query's weights to 0.
    #[inline(always)]
    fn drop(&self, head: usize, query: usize, weights: &mut [f32]) {
        if let Some((mask, first)) = self.mask {
            mask.row(first + head * self.tokens + query).zero(weights);
        }
    }

    /// What weights that stay are multiplied by.
    fn kept(&self) -> f32 {
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
            norms,
        } = self;
        let (width, seen, scale) = (window.width(), window.seen, window.scale());
        let (columns, keys, block) = (padded(width), padded(seen), window.block());
        let mut scores = vec![0.0; block * keys];
        let mut attended = vec![0.0; block * columns];
        let mut factors = vec![0.0; block];
        for head in 0..window.heads {
            let turned_keys = turned(window.part(head, 1), seen, width);
            let values = packed(window.part(head, 2), seen, width);
            for start in (0..seen).step_by(block) {
                let rows = block.min(seen - start);
                let queries = from(window.part(head, 0), start);
                product::<S, false>(
                    simd,
                    &mut scores,
                    queries,
                    &turned_keys,
                    [rows, width, keys],
                );
                for row in 0..rows {
                    let (query, scores) = (start + row, &mut scores[row * keys..][..seen]);
                    let norm = weigh(scores, scale);
                    norms[head * window.tokens + query] = norm;
                    factors[row] = norm.inverse * window.kept();
                    window.drop(head, query, scores);
                }
                let weights = head_of(&scores, 0, keys);
                product::<S, false>(simd, &mut attended, weights, &values, [rows, seen, columns]);
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
        let (width, seen, scale) = (window.width(), window.seen, window.scale());
        let (columns, keys, block) = (padded(width), padded(seen), window.block());
        let mut weights = vec![0.0; block * keys];
        let mut scores = vec![0.0; block * keys];
        let mut factors = vec![0.0; seen];
        for head in 0..window.heads {
            let gradient = head_of(self.gradient, head * width, window.d);
            let turned_keys = turned(window.part(head, 1), seen, width);
            let turned_values = turned(window.part(head, 2), seen, width);
            let [query, key] = [0, 1].map(|part| packed(window.part(head, part), seen, width));
            let gradient_packed = packed(gradient, seen, width);
            let mut sums = [0, 1, 2].map(|_| vec![0.0; seen * columns]);
            for start in (0..seen).step_by(block) {
                let rows = block.min(seen - start);
                let queries = from(window.part(head, 0), start);
                product::<S, false>(
                    simd,
                    &mut weights,
                    queries,
                    &turned_keys,
                    [rows, width, keys],
                );
                let gradients = from(gradient, start);
                product::<S, false>(
                    simd,
                    &mut scores,
                    gradients,
                    &turned_values,
                    [rows, width, keys],
                );
                for row in 0..rows {
                    let query = start + row;
                    factors.fill(window.kept());
                    window.drop(head, query, &mut factors);
                    unweigh(
                        &mut weights[row * keys..][..seen],
                        &mut scores[row * keys..][..seen],
                        &factors,
                        self.norms[head * window.tokens + query],
                        scale,
                    );
                }
                let here = start * columns;
                let scores = head_of(&scores, 0, keys);
                let weights = Transposed(head_of(&weights, 0, keys));
                let [by_query, by_key, by_value] = &mut sums;
                let by_query = &mut by_query[here..];
                product::<S, false>(simd, by_query, scores, &key, [rows, seen, columns]);
                let scores = Transposed(scores);
                product::<S, true>(simd, by_key, scores, &query[here..], [seen, rows, columns]);
                let gradient = &gradient_packed[here..];
                product::<S, true>(simd, by_value, weights, gradient, [seen, rows, columns]);
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

/// The rows of a matrix from one on.
#[inline(always)]
fn from(rows: Rows<'_>, start: usize) -> Rows<'_> {
    head_of(rows.values, start * rows.stride, rows.stride)
}

/// A copy with padded rows, `[rows, padded width]`.
#[inline(always)]
fn packed(of: Rows<'_>, rows: usize, width: usize) -> Vec<f32> {
    let columns = padded(width);
    let mut values = vec![0.0; rows * columns];
    for (row, to) in values.chunks_exact_mut(columns).enumerate() {
        to[..width].copy_from_slice(of.row(row, width));
    }
    values
}

/// A transposed copy with padded rows, `[width, padded rows]`.
#[inline(always)]
fn turned(of: Rows<'_>, rows: usize, width: usize) -> Vec<f32> {
    let columns = padded(rows);
    let mut values = vec![0.0; width * columns];
    for row in 0..rows {
        for (column, value) in of.row(row, width).iter().enumerate() {
            values[column * columns + row] = *value;
        }
    }
    values
}
