//! Refusals of the tensors, and their rounding.

use super::*;

/// Asserts that a changed model is refused in words that begin like these.
#[track_caller]
fn refused(words: &str, change: impl FnOnce(&mut ModelParts)) {
    let found = refusal(change).to_string();
    assert!(found.starts_with(words), "{words}: {found}");
}

#[test]
fn tensors_of_a_wrong_length_are_named() {
    let words = "embed.weights has 1279 bytes, expected 1280: export the model again";
    refused(words, |own| own.embed.weights.truncate(1279));
    let words = "layers[0].qkv.scales has 196 bytes, expected 192";
    refused(words, |own| own.layers[0].qkv.scales.push(1.0));
    let words = "layers[0].relative_bias has 76 bytes, expected 80";
    refused(words, |own| own.layers[0].relative_bias.truncate(19));
    let words = "final_norm.gain has 0 bytes, expected 64";
    refused(words, |own| own.final_norm.gain.clear());
}

#[test]
fn numbers_that_would_break_the_arithmetic_are_refused() {
    let words = "layers[0].relative_bias holds NaN at 3, expected a number from -100 to 100: train the model again";
    refused(words, |own| own.layers[0].relative_bias[3] = f32::NAN);
    let words = "layers[0].norm2.gain holds -inf at 0, ";
    refused(words, |own| own.layers[0].norm2.gain[0] = f32::NEG_INFINITY);
    let words = "layers[0].qkv.scales holds 0 at 7";
    refused(words, |own| own.layers[0].qkv.scales[7] = 0.0);
    refused("head.scales holds -0.5 at 2, ", |own| {
        own.head.scales[2] = -0.5
    });
    refused("embed.scales holds inf at 1, ", |own| {
        own.embed.scales[1] = f32::INFINITY
    });
    refused("final_norm.bias holds -1000000000 at 1", |own| {
        own.final_norm.bias[1] = -1e9
    });
    // Numbers of this size in every scale of the head make logits overflow to infinity, and a difference of two of
    // them NaN.
    refused("head.scales holds 101 at 0", |own| {
        own.head.scales.fill(101.0)
    });
}

#[test]
fn missing_and_surplus_tensors_are_refused() {
    let whole = small().emit();
    let content = &whole[..whole.len() - CHECKSUM_BYTES];
    assert_eq!(
        parse_error(&sealed(&content[..content.len() - 1])),
        ModelError::WeightsEnd {
            tensor: TensorName {
                layer: None,
                group: "head",
                part: "bias"
            }
        }
    );
    assert_eq!(
        parse_error(&sealed(&[content, &[0, 0]].concat())),
        ModelError::Trailing { found: 2 }
    );
}

#[test]
fn a_scale_may_be_zero_if_its_row_is_zero() {
    // As the quantizer writes a row of zeros.
    let mut parts = small();
    let columns = parts.dimensions.width;
    parts.layers[0].qkv.scales[7] = 0.0;
    parts.layers[0].qkv.weights[7 * columns..][..columns].fill(0);
    assert!(parts.to_bytes().is_ok());
    // One weight other than zero, in the row's last column.
    parts.layers[0].qkv.weights[8 * columns - 1] = 1;
    assert!(parts.to_bytes().is_err());
}

#[test]
fn rows_are_quantized_to_the_nearest_of_their_steps() {
    let matrix = [
        0.5, -1.27, 0.0, 0.015, 0.0, 0.0, 0.0, 0.0, 1e-40, -1e-40, 0.0, 0.0,
    ];
    let (bytes, scales) = quantize_rows(&matrix, 3, 4);
    // Column 2 comes after column 0 in a word, then column 1, then column 3. The low byte of column 1's weight is that
    // of column 2, -0 or 255: -127 is -128 + 255 / 256.
    assert_eq!(bytes, [50, -127, 0, 1, 0, 0, 0, 0, 127, -127, 0, -1]);
    assert!((scales[0] - 0.01).abs() < 1e-9);
    assert_eq!(scales[1], 0.0);
    let (_, scales) = quantize_rows(&[f32::NAN, 1.0], 1, 2);
    assert!(scales[0].is_nan());
}
