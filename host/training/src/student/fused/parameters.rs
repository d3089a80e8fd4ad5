//! Sizes of the network, and its parameters as parts of one row of values.

use std::mem;

use crate::optimization::kernels::matmul::padded;

/// Sizes of the network. Widths of heads and the number of outputs are padded with zeros to whole vectors.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Number of values of a patch.
    pub inputs: usize,
    /// Width of a token, whole vectors.
    pub d: usize,
    /// Number of attention heads.
    pub heads: usize,
    /// Number of encoder layers.
    pub layers: usize,
    /// Number of patches that a patch attends to.
    pub span: usize,
    /// Number of logits of a patch.
    pub outputs: usize,
    /// Whether the square root of the input is taken first.
    pub square_root: bool,
}

impl Sizes {
    /// Width of a head.
    pub(super) const fn head(self) -> usize {
        self.d / self.heads
    }

    /// Width of a token's queries, keys or values.
    pub(super) const fn attended(self) -> usize {
        self.heads * padded(self.head())
    }

    /// Width between the matrices of the feed-forward block.
    pub(super) const fn hidden(self) -> usize {
        2 * self.d
    }

    /// Number of all parameters.
    pub(super) const fn parameters(self) -> usize {
        let (d, hidden, attended) = (self.d, self.hidden(), self.attended());
        let attention = (d + 1) * 3 * attended + self.heads * self.span + (attended + 1) * d;
        let feed_forward = (d + 1) * hidden + (hidden + 1) * d;
        (self.inputs + 1) * d
            + self.layers * (4 * d + attention + feed_forward)
            + 2 * d
            + (d + 1) * padded(self.outputs)
    }
}

/// Linear layer: weight, inputs by outputs, and bias.
pub(super) struct Linear<T> {
    pub weight: T,
    pub bias: T,
}

/// Gain and bias of a layer norm.
pub(super) struct Norm<T> {
    pub gain: T,
    pub bias: T,
}

/// Parameters of a layer.
pub(super) struct Layer<T> {
    pub norm1: Norm<T>,
    pub qkv: Linear<T>,
    /// Relative-position bias, `[heads, span]`.
    pub relative_bias: T,
    pub out: Linear<T>,
    pub norm2: Norm<T>,
    pub ff1: Linear<T>,
    pub ff2: Linear<T>,
}

/// Parameters of the network, or their gradients.
pub(super) struct Parameters<T> {
    pub embed: Linear<T>,
    pub layers: Vec<Layer<T>>,
    pub final_norm: Norm<T>,
    pub head: Linear<T>,
}

impl<T: Row> Parameters<T> {
    /// Splits a row of [`Sizes::parameters`] values into parts, in the order of the network.
    pub(super) fn parts_of(row: T, sizes: Sizes) -> Self {
        let Sizes { d, .. } = sizes;
        let mut rest = Rest(row);
        let embed = rest.linear(sizes.inputs, d);
        let layers = (0..sizes.layers)
            .map(|_| Layer {
                norm1: rest.norm(d),
                qkv: rest.linear(d, 3 * sizes.attended()),
                relative_bias: rest.take(sizes.heads * sizes.span),
                out: rest.linear(sizes.attended(), d),
                norm2: rest.norm(d),
                ff1: rest.linear(d, sizes.hidden()),
                ff2: rest.linear(sizes.hidden(), d),
            })
            .collect();
        Self {
            embed,
            layers,
            final_norm: rest.norm(d),
            head: rest.linear(d, padded(sizes.outputs)),
        }
    }
}

/// Row of values that can be split.
pub(super) trait Row: Default {
    /// Splits the row into the first `at` values and the others.
    fn split(self, at: usize) -> (Self, Self);
}

impl Row for &[f32] {
    fn split(self, at: usize) -> (Self, Self) {
        self.split_at(at)
    }
}

impl Row for &mut [f32] {
    fn split(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

/// Values of the row not yet assigned to a part.
struct Rest<T>(T);

impl<T: Row> Rest<T> {
    fn take(&mut self, values: usize) -> T {
        let (first, rest) = mem::take(&mut self.0).split(values);
        self.0 = rest;
        first
    }

    fn linear(&mut self, inputs: usize, outputs: usize) -> Linear<T> {
        Linear {
            weight: self.take(inputs * outputs),
            bias: self.take(outputs),
        }
    }

    fn norm(&mut self, d: usize) -> Norm<T> {
        Norm {
            gain: self.take(d),
            bias: self.take(d),
        }
    }
}

/// Transposed weights of each linear layer, outputs by inputs, for the backward pass.
pub(super) struct Transposes {
    pub layers: Vec<LayerTransposes>,
    pub head: Vec<f32>,
}

/// Transposed weights of a layer.
pub(super) struct LayerTransposes {
    pub qkv: Vec<f32>,
    pub out: Vec<f32>,
    pub ff1: Vec<f32>,
    pub ff2: Vec<f32>,
}

impl Transposes {
    pub(super) fn of(parameters: &Parameters<&[f32]>) -> Self {
        let layers = parameters.layers.iter();
        Self {
            layers: layers
                .map(|layer| LayerTransposes {
                    qkv: transpose(&layer.qkv),
                    out: transpose(&layer.out),
                    ff1: transpose(&layer.ff1),
                    ff2: transpose(&layer.ff2),
                })
                .collect(),
            head: transpose(&parameters.head),
        }
    }
}

fn transpose(of: &Linear<&[f32]>) -> Vec<f32> {
    let outputs = of.bias.len();
    let inputs = of.weight.len() / outputs;
    let column = |output| of.weight.iter().skip(output).step_by(outputs).take(inputs);
    (0..outputs).flat_map(column).copied().collect()
}
