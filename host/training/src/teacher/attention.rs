//! Multi-head attention of every token to every token of its window.
//!
//! It stores all scores of a head (1200 x 1200 for the paper's tokens), for a group of windows at a time.

use burn::tensor::Tensor;
use burn::tensor::activation::softmax;

use crate::optimization::dropout::Mask;

/// Greatest number of bytes of scores in one tensor: 128 MiB, the least that Vulkan lets an adapter bind. No adapter binds
/// more than 2 GiB, and a validation of the preset `paper` has 2.7 GiB.
const LARGEST: usize = 128 << 20;

/// Computes attention, from `[b, tokens, 3 d]` (queries, keys, values) to `[b, tokens, d]`, head after head along `d`.
///
/// `blocked`, `[b]`, is 1 for windows whose second half of tokens neither attends nor is attended to; the output of these
/// tokens is 0. `mask` is the dropout of the attention weights.
pub(super) fn attend(
    qkv: Tensor<3>,
    heads: usize,
    blocked: Option<&Tensor<1>>,
    mask: Option<Mask>,
) -> Tensor<3> {
    let [_, tokens, _] = qkv.dims();
    let scores = heads * tokens * tokens * size_of::<f32>();
    in_groups(qkv, heads, blocked, mask, (LARGEST / scores.max(1)).max(1))
}

/// Computes [`attend`] for groups of windows.
fn in_groups(
    qkv: Tensor<3>,
    heads: usize,
    blocked: Option<&Tensor<1>>,
    mask: Option<Mask>,
    windows: usize,
) -> Tensor<3> {
    let [batch, tokens, _] = qkv.dims();
    if batch <= windows {
        return one_group(qkv, heads, blocked, mask);
    }
    let groups = (0..batch).step_by(windows).map(|first| {
        let group = first..(first + windows).min(batch);
        let blocked = blocked.map(|flags| flags.clone().slice_dim(0, group.clone()));
        let mask = mask.map(|mask| mask.starting_at(first * heads * tokens));
        one_group(
            qkv.clone().slice_dim(0, group),
            heads,
            blocked.as_ref(),
            mask,
        )
    });
    Tensor::cat(groups.collect(), 0)
}

fn one_group(
    qkv: Tensor<3>,
    heads: usize,
    blocked: Option<&Tensor<1>>,
    mask: Option<Mask>,
) -> Tensor<3> {
    let [batch, tokens, d] = qkv.dims();
    let d = d / 3;
    let width = d / heads;
    let qkv = qkv
        .reshape([batch, tokens, 3, heads, width])
        .permute([2, 0, 3, 1, 4]);
    let part = |i: usize| qkv.clone().slice_dim(0, i..i + 1).squeeze_dim::<4>(0);
    // Scaling the queries takes d products per token instead of one per pair of tokens.
    let query = part(0) * (1.0 / (width as f32).sqrt());
    let mut scores = query.matmul(part(1).swap_dims(2, 3));
    let hidden = blocked.map(|blocked| hidden(blocked.clone(), tokens));
    if let Some(hidden) = &hidden {
        scores = scores + hidden.clone().reshape([batch, 1, 1, tokens]) * -1e9;
    }
    let mut weights = softmax(scores, 3);
    if let Some(mask) = mask {
        weights = mask.apply(weights);
    }
    let attended = weights
        .matmul(part(2))
        .swap_dims(1, 2)
        .reshape([batch, tokens, d]);
    match hidden {
        Some(hidden) => attended * (hidden * -1.0 + 1.0).reshape([batch, tokens, 1]),
        None => attended,
    }
}

/// Mask with 1 for the second half of the tokens of blocked windows, `[b, tokens]`.
fn hidden(blocked: Tensor<1>, tokens: usize) -> Tensor<2> {
    let device = blocked.device();
    let halves = Tensor::<1>::cat(
        vec![
            Tensor::zeros([tokens / 2], &device),
            Tensor::ones([tokens - tokens / 2], &device),
        ],
        0,
    );
    blocked.unsqueeze_dim::<2>(1) * halves.unsqueeze_dim::<2>(0)
}

#[cfg(test)]
mod tests;
