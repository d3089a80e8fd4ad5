use burn::tensor::{Device, Tensor};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{attend, in_groups};
use crate::optimization::dropout::{Dropout, Mask};
use crate::optimization::{random, read_back};

const HEADS: usize = 2;
const D: usize = 12;

fn mask() -> Mask {
    let mut dropout = Dropout::from(ChaCha8Rng::seed_from_u64(5));
    dropout.mask(0.15).expect("a probability above 0")
}

/// Asserts equality up to rounding, relative to the largest value.
fn assert_close(found: Tensor<3>, expected: Tensor<3>, what: &str) {
    let (found, expected) = (read_back(found), read_back(expected));
    let largest = expected.iter().fold(1.0_f32, |a, b| a.max(b.abs()));
    for (at, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found - expected).abs() < 1e-5 * largest,
            "{what}, value {at}: {found}, not {expected}"
        );
    }
}

/// Compares the whole with groups of two windows, forward and backward.
fn groups_agree(blocked: Option<&[f32]>, mask: Option<Mask>) {
    let device = Device::default().autodiff();
    let (batch, tokens) = (3, 22);
    let values = random(1, [batch, tokens, 3 * D], &device) * 1.5;
    let weights = random(2, [batch, tokens, D], &device);
    let blocked = blocked.map(|flags| Tensor::<1>::from_floats(flags, &device));
    let run = |windows: usize| {
        let qkv = values.clone().detach().require_grad();
        let output = in_groups(qkv.clone(), HEADS, blocked.as_ref(), mask, windows);
        let gradients = (output.clone() * weights.clone()).sum().backward();
        let gradient = qkv.grad(&gradients).expect("a gradient of the input");
        (output.inner(), gradient)
    };
    let [(expected, gradient), (found, found_gradient)] = [batch, 2].map(run);
    assert_close(found, expected, "output");
    assert_close(found_gradient, gradient, "gradient");
}

#[test]
fn groups_give_the_same_as_the_whole() {
    groups_agree(None, None);
    groups_agree(None, Some(mask()));
    groups_agree(Some(&[0.0, 1.0, 0.0]), None);
    groups_agree(Some(&[1.0, 1.0, 0.0]), Some(mask()));
}

#[test]
fn the_second_half_of_a_blocked_window_is_ignored() {
    let device = Device::default();
    let values = random(1, [1, 22, 3 * D], &device) * 1.5;
    let blocked = Tensor::<1>::from_floats([1.0], &device);
    let found = attend(values.clone(), HEADS, Some(&blocked), None);
    let half = attend(values.slice_dim(1, 0..11), HEADS, None, None);
    let zeros = Tensor::zeros([1, 11, D], &device);
    assert_close(found, Tensor::cat(vec![half, zeros], 1), "output");
}
