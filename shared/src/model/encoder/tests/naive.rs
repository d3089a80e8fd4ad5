//! The formulas of the module's first lines in f64, over all patches at once, with no
//! quantization but of the weights.

use super::*;
use crate::model::dimensions::HEADS;
use crate::model::file::{LayerParts, LinearParts, NormParts};

type Vector = Vec<f64>;

fn linear(map: &LinearParts, x: &[f64]) -> Vector {
    let weights = map.dequantized();
    let row = |row: usize| {
        let weights = &weights[row * x.len()..(row + 1) * x.len()];
        let sum: f64 = weights.iter().zip(x).map(|(&w, x)| f64::from(w) * x).sum();
        sum + f64::from(map.bias[row])
    };
    (0..map.bias.len()).map(row).collect()
}

fn norm(norm: &NormParts, h: &[f64]) -> Vector {
    let mean = h.iter().sum::<f64>() / h.len() as f64;
    let variance = h.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / h.len() as f64;
    let normalised = h.iter().map(|x| (x - mean) / libm::sqrt(variance + 1e-5));
    let constants = norm.gain.iter().zip(&norm.bias);
    normalised
        .zip(constants)
        .map(|(x, (&g, &b))| x * f64::from(g) + f64::from(b))
        .collect()
}

fn attend(layer: &LayerParts, tokens: &[Vector], span: usize) -> Vec<Vector> {
    let width = tokens[0].len();
    let size = width / HEADS;
    let qkv: Vec<Vector> = tokens
        .iter()
        .map(|token| linear(&layer.qkv, token))
        .collect();
    let attend_one = |p: usize| {
        let mut attended = Vector::new();
        for head in 0..HEADS {
            let part = |t: usize, which: usize| {
                let start = which * width + head * size;
                &qkv[t][start..start + size]
            };
            let seen = (p + 1).saturating_sub(span)..p + 1;
            let weights: Vec<f64> = seen
                .clone()
                .map(|t| {
                    let product: f64 = part(p, 0).iter().zip(part(t, 1)).map(|(q, k)| q * k).sum();
                    let bias = f64::from(layer.relative_bias[head * span + p - t]);
                    libm::exp(product / libm::sqrt(size as f64) + bias)
                })
                .collect();
            let sum: f64 = weights.iter().sum();
            attended.extend((0..size).map(|channel| {
                let values = seen.clone().map(|t| part(t, 2)[channel]);
                values
                    .zip(&weights)
                    .map(|(value, weight)| value * weight / sum)
                    .sum::<f64>()
            }));
        }
        linear(&layer.out, &attended)
    };
    (0..tokens.len()).map(attend_one).collect()
}

pub fn outputs(model: &ModelParts, patches: &[Patch]) -> Vec<Vector> {
    let value = |x: &u8| libm::sqrt(f64::from(*x) / 128.0);
    let embed = |patch: &Patch| {
        linear(
            &model.embed,
            &patch.as_flattened().iter().map(value).collect::<Vector>(),
        )
    };
    let mut h: Vec<Vector> = patches.iter().map(embed).collect();
    for layer in &model.layers {
        let tokens: Vec<Vector> = h.iter().map(|h| norm(&layer.norm1, h)).collect();
        let updates = attend(layer, &tokens, model.dimensions.span);
        for (h, update) in h.iter_mut().zip(&updates) {
            h.iter_mut().zip(update).for_each(|(h, x)| *h += x);
            let hidden = linear(&layer.ff1, &norm(&layer.norm2, h));
            let hidden: Vector = hidden
                .iter()
                .map(|x| x / (1.0 + libm::exp(-1.702 * x)))
                .collect();
            let update = linear(&layer.ff2, &hidden);
            h.iter_mut().zip(&update).for_each(|(h, x)| *h += x);
        }
    }
    h.iter()
        .map(|h| linear(&model.head, &norm(&model.final_norm, h)))
        .collect()
}
