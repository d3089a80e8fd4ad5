//! Forward pass of the student over whole sequences.
//!
//! Local causal attention is a band of the matrix of scores, where the device keeps a ring of keys and values. These are
//! Burn's operations, for any backend; `fused` computes the same on the CPU backend.

use burn::tensor::activation::{sigmoid, softmax};
use burn::tensor::{Int, Tensor, TensorData};
use shared::units::LOOK_BACK;

#[cfg(feature = "flex")]
use super::fused;
use super::model::{GELU_SCALE, Student, StudentLayer};

impl Student {
    /// Logits of the look-back head at every patch, `[b, patches, 6, classes]`, newest first.
    ///
    /// `emg` is cleaned EMG over 128, `[b, patches, 80]`, sample after sample.
    pub fn forward(&self, emg: Tensor<3>) -> Tensor<4> {
        #[cfg(feature = "flex")]
        if let Some(logits) = fused::forward(self, &emg) {
            return by_patch(logits);
        }
        self.portable(emg)
    }

    /// Computes [`forward`](Self::forward) by Burn's operations.
    pub(super) fn portable(&self, emg: Tensor<3>) -> Tensor<4> {
        // The root has no derivative at 0, but the input needs no gradient.
        let emg = if self.square_root { emg.sqrt() } else { emg };
        let mut x = self.embed.forward(emg);
        for layer in &self.layers {
            x = layer.forward(x);
        }
        by_patch(self.head.forward(self.final_norm.forward(x)))
    }
}

/// Reshapes `[b, patches, 6 * classes]` to `[b, patches, 6, classes]`.
fn by_patch(logits: Tensor<3>) -> Tensor<4> {
    let [batch, patches, outputs] = logits.dims();
    logits.reshape([batch, patches, LOOK_BACK, outputs / LOOK_BACK])
}

impl StudentLayer {
    fn forward(&self, x: Tensor<3>) -> Tensor<3> {
        let x = x.clone() + self.attention(self.norm1.forward(x));
        let hidden = self.ff1.forward(self.norm2.forward(x.clone()));
        // GELU in its sigmoid approximation: one exponential and one division on the device.
        let hidden = hidden.clone() * sigmoid(hidden * GELU_SCALE);
        x + self.ff2.forward(hidden)
    }

    fn attention(&self, x: Tensor<3>) -> Tensor<3> {
        let [batch, patches, d] = x.dims();
        let width = d / self.heads;
        let qkv = self
            .qkv
            .forward(x)
            .reshape([batch, patches, 3, self.heads, width])
            .permute([2, 0, 3, 1, 4]);
        let part = |i: usize| qkv.clone().slice_dim(0, i..i + 1).squeeze_dim::<4>(0);
        let query = part(0) * (1.0 / (width as f32).sqrt());
        let scores = query.matmul(part(1).swap_dims(2, 3)) + self.band(patches);
        let attended = softmax(scores, 3)
            .matmul(part(2))
            .swap_dims(1, 2)
            .reshape([batch, patches, d]);
        self.out.forward(attended)
    }

    /// Relative-position bias inside the band, -1e9 outside, `[1, heads, n, n]`.
    fn band(&self, patches: usize) -> Tensor<4> {
        let device = self.relative_bias.val().device();
        let mut distance = Vec::with_capacity(patches * patches);
        let mut outside = Vec::with_capacity(patches * patches);
        for query in 0..patches {
            for key in 0..patches {
                let inside = key <= query && query - key < self.span;
                distance.push(if inside { (query - key) as i32 } else { 0 });
                outside.push(if inside { 0.0_f32 } else { -1e9 });
            }
        }
        let cells = patches * patches;
        let distance = Tensor::<1, Int>::from_data(TensorData::new(distance, [cells]), &device);
        let outside =
            Tensor::<4>::from_data(TensorData::new(outside, [1, 1, patches, patches]), &device);
        self.relative_bias
            .val()
            .select(1, distance)
            .reshape([1, self.heads, patches, patches])
            + outside
    }
}
