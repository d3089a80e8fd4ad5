//! Local causal attention of one sequence, for each head in blocks of queries.
//!
//! Scores are computed for the keys that some query of the block attends to. A query reads a row of a table at its own
//! offset: it has the relative-position bias of each key and blocks the others.

use pulp::Simd;

use super::linear::{matrix, matrix_mut};
use super::parameters::Sizes;
use crate::optimization::kernels::dot;
use crate::optimization::kernels::exponential::exp_negative;
use crate::optimization::kernels::matmul::{RowsMut, Transposed, padded, product};
use crate::optimization::kernels::softmax::{RowStatistics, exponentials};

/// Number of queries in a block.
const BLOCK: usize = 16;

/// Buffers, and the table of the present head.
pub(super) struct Buffers {
    sizes: Sizes,
    tokens: usize,
    /// Transposed keys or values of a head, `[width, padded tokens + a vector]`; zeros at the end.
    keys: Vec<f32>,
    values: Vec<f32>,
    /// Weights, `[BLOCK, padded keys]`.
    weights: Vec<f32>,
    gradients: Vec<f32>,
    /// Bias by distance, the farthest first; minus infinity where a query does not attend to a key.
    table: Vec<f32>,
    /// Mask with 1 where a query attends to a key.
    inside: Vec<f32>,
    table_gradient: Vec<f32>,
}

/// Queries of a block and the keys that they attend to.
struct Block {
    /// Index of the first query.
    query: usize,
    queries: usize,
    /// Index of the first key.
    key: usize,
    keys: usize,
    /// Padded number of keys.
    columns: usize,
}

impl Buffers {
    pub(super) fn new(sizes: Sizes, tokens: usize) -> Self {
        let columns = padded(BLOCK + sizes.span);
        let transposed = sizes.head() * (padded(tokens) + padded(1));
        let table = sizes.span + BLOCK + columns;
        let mut inside = vec![0.0; table];
        inside[BLOCK + 1..][..sizes.span].fill(1.0);
        Self {
            sizes,
            tokens,
            keys: vec![0.0; transposed],
            values: vec![0.0; transposed],
            weights: vec![0.0; BLOCK * columns],
            gradients: vec![0.0; BLOCK * columns],
            table: vec![f32::NEG_INFINITY; table],
            inside,
            table_gradient: vec![0.0; table],
        }
    }

    /// Number of columns of the transposed matrices.
    fn stride(&self) -> usize {
        padded(self.tokens) + padded(1)
    }

    /// Index of a distance in the tables.
    fn place(&self, distance: usize) -> usize {
        self.sizes.span + BLOCK - distance
    }

    fn blocks(&self) -> impl Iterator<Item = Block> + use<> {
        let (tokens, span) = (self.tokens, self.sizes.span);
        (0..tokens).step_by(BLOCK).map(move |query| {
            let queries = BLOCK.min(tokens - query);
            let key = (query + 1).saturating_sub(span);
            let keys = query + queries - key;
            Block {
                query,
                queries,
                key,
                keys,
                columns: padded(keys),
            }
        })
    }

    /// Writes the table and the transposed keys of a head.
    #[inline(always)]
    fn load(&mut self, qkv: &[f32], bias: &[f32], head: usize) {
        let Sizes { span, heads, .. } = self.sizes;
        for (distance, &bias) in bias[head * span..][..span].iter().enumerate() {
            let place = self.place(distance);
            self.table[place] = bias;
        }
        let stride = self.stride();
        let column = (heads + head) * padded(self.sizes.head());
        transpose(
            &mut self.keys,
            qkv,
            3 * self.sizes.attended(),
            column,
            stride,
        );
    }

    /// Writes a block's scores to the weights.
    #[inline(always)]
    fn scores<S: Simd>(&mut self, simd: S, qkv: &[f32], head: usize, block: &Block) {
        let width = self.sizes.head();
        let scale = 1.0 / (width as f32).sqrt();
        let columns = block.columns;
        let stride = self.stride();
        let queries = matrix(qkv, 3 * self.sizes.attended());
        let queries = queries.from(block.query, head * padded(width));
        let keys = matrix(&self.keys, stride).from(0, block.key);
        let to = matrix_mut(&mut self.weights, columns);
        product::<S, false>(simd, to, queries, keys, [block.queries, width, columns]);
        for row in 0..block.queries {
            let place = self.place(block.query + row - block.key);
            let table = &self.table[place..][..columns];
            for (score, bias) in self.weights[row * columns..][..columns]
                .iter_mut()
                .zip(table)
            {
                *score = *score * scale + bias;
            }
        }
    }

    /// Writes attention, `[tokens, heads, padded width]`, and its softmax statistics, `[heads, tokens]`.
    #[inline(always)]
    pub(super) fn forward<S: Simd>(
        &mut self,
        simd: S,
        qkv: &[f32],
        bias: &[f32],
        attended: &mut [f32],
        statistics: &mut [RowStatistics],
    ) {
        let (heads, width) = (self.sizes.heads, padded(self.sizes.head()));
        let part = heads * width;
        for head in 0..heads {
            self.load(qkv, bias, head);
            for block in self.blocks() {
                self.scores(simd, qkv, head, &block);
                let columns = block.columns;
                for row in 0..block.queries {
                    let query = block.query + row;
                    let place = self.place(query - block.key);
                    let weights = &mut self.weights[row * columns..][..columns];
                    let found = exponentials(weights, 1.0);
                    let inside = &self.inside[place..][..columns];
                    for (weight, inside) in weights.iter_mut().zip(inside) {
                        // The order matters: the exponential of a blocked key times the inverse would be a subnormal
                        // number, which is slow.
                        *weight = *weight * inside * found.inverse_sum;
                    }
                    statistics[head * self.tokens + query] = found;
                }
                let weights = matrix(&self.weights, columns);
                let values = matrix(qkv, 3 * part).from(block.key, 2 * part + head * width);
                let mut to = matrix_mut(attended, part);
                let to = to.from(block.query, head * width);
                product::<S, false>(
                    simd,
                    to,
                    weights,
                    values,
                    [block.queries, block.keys, width],
                );
            }
        }
    }

    /// Writes the gradients of queries, keys and values, and adds the gradient of the bias.
    #[inline(always)]
    pub(super) fn backward<S: Simd>(
        &mut self,
        simd: S,
        [qkv, bias, gradient]: [&[f32]; 3],
        statistics: &[RowStatistics],
        qkv_gradient: &mut [f32],
        bias_gradient: &mut [f32],
    ) {
        let Sizes { heads, span, .. } = self.sizes;
        let width = padded(self.sizes.head());
        let part = heads * width;
        let stride = self.stride();
        let qkv_of = matrix(qkv, 3 * part);
        // Several blocks attend to a key and add to its gradients.
        qkv_gradient.fill(0.0);
        for head in 0..heads {
            self.load(qkv, bias, head);
            transpose(
                &mut self.values,
                qkv,
                3 * part,
                2 * part + head * width,
                stride,
            );
            self.table_gradient.fill(0.0);
            for block in self.blocks() {
                let Block { columns, .. } = block;
                self.scores(simd, qkv, head, &block);
                let outputs = matrix(gradient, part).from(block.query, head * width);
                let values = matrix(&self.values, stride).from(0, block.key);
                let to = matrix_mut(&mut self.gradients, columns);
                let sizes = [block.queries, self.sizes.head(), columns];
                product::<S, false>(simd, to, outputs, values, sizes);
                for row in 0..block.queries {
                    self.softmax_backward(
                        row,
                        &block,
                        statistics[head * self.tokens + block.query + row],
                    );
                }
                let (query, key) = (head * width, part + head * width);
                let mut to = matrix_mut(qkv_gradient, 3 * part);
                let scores = matrix(&self.gradients, columns);
                let sizes = [block.queries, block.keys, width];
                let keys = qkv_of.from(block.key, key);
                product::<S, false>(simd, to.from(block.query, query), scores, keys, sizes);
                let sizes = [block.keys, block.queries, width];
                let add = |to: RowsMut<'_>, left, right| {
                    product::<S, true>(simd, to, Transposed(left), right, sizes);
                };
                add(
                    to.from(block.key, key),
                    scores,
                    qkv_of.from(block.query, query),
                );
                add(
                    to.from(block.key, part + key),
                    matrix(&self.weights, columns),
                    outputs,
                );
            }
            for distance in 0..span {
                bias_gradient[head * span + distance] += self.table_gradient[self.place(distance)];
            }
        }
    }

    /// Replaces a row's scores by the weights, and the gradients of these weights by the gradients of the product of query
    /// and keys.
    #[inline(always)]
    fn softmax_backward(&mut self, row: usize, block: &Block, statistics: RowStatistics) {
        let scale = 1.0 / (self.sizes.head() as f32).sqrt();
        let columns = block.columns;
        let place = self.place(block.query + row - block.key);
        let weights = &mut self.weights[row * columns..][..columns];
        let gradients = &mut self.gradients[row * columns..][..columns];
        for (weight, inside) in weights.iter_mut().zip(&self.inside[place..][..columns]) {
            *weight = exp_negative(*weight - statistics.max) * inside * statistics.inverse_sum;
        }
        let mean = dot(weights, gradients);
        let table = &mut self.table_gradient[place..][..columns];
        for (at, gradient) in gradients.iter_mut().enumerate() {
            let score = weights[at] * (*gradient - mean);
            table[at] += score;
            *gradient = score * scale;
        }
    }
}

/// Writes columns of a matrix as the rows of another one.
#[inline(always)]
fn transpose(to: &mut [f32], from: &[f32], from_stride: usize, column: usize, stride: usize) {
    for (token, row) in from.chunks_exact(from_stride).enumerate() {
        for (to, value) in to.chunks_exact_mut(stride).zip(&row[column..]) {
            to[token] = *value;
        }
    }
}
