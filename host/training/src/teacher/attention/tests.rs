use burn::tensor::{Device, Distribution, Tensor};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{attend, in_groups, plain};
use crate::optimization::dropout::{Dropout, Mask};
use crate::optimization::read_back;

const HEADS: usize = 2;
const D: usize = 12;

fn random(dims: [usize; 3], device: &Device) -> Tensor<3> {
    Tensor::random(dims, Distribution::Normal(0.0, 1.5), device)
}

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

/// Compares both implementations, and groups of two windows, on the same numbers, forward and backward.
fn both_agree(tokens: usize, blocked: Option<&[f32]>, mask: Option<Mask>) {
    let device = Device::flex().autodiff();
    let batch = 3;
    let values = random([batch, tokens, 3 * D], &device);
    let weights = random([batch, tokens, D], &device);
    let blocked = blocked.map(|flags| Tensor::<1>::from_floats(flags, &device));
    let run =
        |implementation: fn(Tensor<3>, usize, Option<&Tensor<1>>, Option<Mask>) -> Tensor<3>| {
            let qkv = values.clone().detach().require_grad();
            let output = implementation(qkv.clone(), HEADS, blocked.as_ref(), mask);
            let gradients = (output.clone() * weights.clone()).sum().backward();
            let gradient = qkv.grad(&gradients).expect("a gradient of the input");
            (output.inner(), gradient)
        };
    let (expected, gradient) = run(plain);
    for (name, (found, found_gradient)) in [
        ("blocks", run(attend)),
        (
            "groups",
            run(|qkv, heads, blocked, mask| in_groups(qkv, heads, blocked, mask, 2)),
        ),
    ] {
        assert_close(found, expected.clone(), &format!("output, {name}"));
        assert_close(
            found_gradient,
            gradient.clone(),
            &format!("gradient, {name}"),
        );
    }
}

#[test]
fn blocks_give_the_same_as_the_whole() {
    both_agree(22, None, None);
}

#[test]
fn dropout_is_the_same_in_blocks() {
    both_agree(22, None, Some(mask()));
}

#[test]
fn the_second_half_of_a_blocked_window_is_ignored() {
    both_agree(22, Some(&[0.0, 1.0, 0.0]), None);
    both_agree(22, Some(&[1.0, 1.0, 0.0]), Some(mask()));
}

#[test]
fn several_blocks_give_the_same_as_the_whole() {
    // Queries of 600 keys: 600 of them take three blocks, the last one short.
    both_agree(600, Some(&[0.0, 0.0, 1.0]), Some(mask()));
}

#[test]
fn without_gradients_the_output_is_the_same() {
    let device = Device::flex();
    let values = random([2, 30, 3 * D], &device);
    assert_close(
        attend(values.clone(), HEADS, None, None),
        plain(values, HEADS, None, None),
        "output",
    );
}
