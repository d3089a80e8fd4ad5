//! Every refusal, and parsing of written files.

use alloc::{string::ToString, vec, vec::Vec};

use proptest::prelude::*;

use super::{
    random::random_model,
    wire_aggregation::WireAggregation,
    wire_header::WireHeader,
    writer::{append, list, prefix, quantize_rows, seal},
    *,
};
use crate::intent::Vocabulary;
use crate::kernels::packing::packed;
use crate::model::dimensions::Dimensions;
use crate::stream::alignment::{TEMPLATE_BYTES, TemplateError};

const SMALL: Dimensions = Dimensions {
    width: 16,
    layers: 1,
    span: 5,
    vocabulary: Vocabulary::Three,
    other: false,
};

fn small() -> ModelParts {
    random_model(SMALL, 11)
}

/// The refusal of a model after a change.
fn refusal(change: impl FnOnce(&mut ModelParts)) -> ModelError {
    let mut parts = small();
    change(&mut parts);
    let refused = Model::parse(&parts.emit()).unwrap_err();
    assert_eq!(
        parts.to_bytes().unwrap_err().to_string(),
        refused.to_string()
    );
    refused
}

/// The refusal of the small model with a changed header under a right checksum.
fn header_refusal<'n>(change: impl FnOnce(&mut WireHeader<'n>)) -> ModelError {
    // Leaked, so that the header's lists may be borrowed from the file or from the test.
    let whole: &'static [u8] = small().emit().leak();
    let body = &whole[PREFIX_BYTES..whole.len() - CHECKSUM_BYTES];
    let (mut header, tensors) = postcard::take_from_bytes::<WireHeader<'n>>(body).unwrap();
    change(&mut header);
    let mut file = prefix();
    append(&mut file, &header);
    file.extend(tensors);
    seal(&mut file);
    Model::parse(&file).unwrap_err()
}

/// A file of this content with a right checksum.
fn sealed(content: &[u8]) -> Vec<u8> {
    let mut file = content.to_vec();
    seal(&mut file);
    file
}

#[test]
fn everything_written_is_read_back() {
    let parts = small();
    let bytes = parts.to_bytes().unwrap();
    let model = Model::parse(&bytes).unwrap();
    assert_eq!(model.length, bytes.len());
    let Header {
        dimensions,
        companding,
        preprocessing,
        smoother,
        template,
        provenance,
    } = model.header;
    assert_eq!(
        (dimensions, companding, preprocessing, smoother, template),
        (
            parts.dimensions,
            parts.companding,
            parts.preprocessing,
            parts.smoother,
            parts.template
        )
    );
    assert_eq!(
        provenance.data_sets.iter().collect::<Vec<_>>(),
        ["noise", "more noise"]
    );
    assert_eq!(
        provenance.subjects_seen.iter().collect::<Vec<_>>(),
        ["noise/1", "noise/2"]
    );
    assert_eq!(
        provenance.subjects_left_out.iter().collect::<Vec<_>>(),
        ["noise/3"]
    );
    assert_eq!(
        provenance.metrics.iter().collect::<Vec<_>>(),
        [("raw accuracy", 0.75)]
    );
    assert_eq!((provenance.git_revision, provenance.seed), ("0123abc", 11));

    let same_linear = |read: LinearWeights<'_>, written: &LinearParts| {
        let columns = written.weights.len() / written.bias.len();
        assert_eq!(read.weights, packed(&written.weights, columns));
        assert_eq!(read.scales, written.scales);
        assert_eq!(read.bias, written.bias);
    };
    let same_norm = |read: NormWeights<'_>, written: &NormParts| {
        assert_eq!(read.gain, written.gain);
        assert_eq!(read.bias, written.bias);
    };
    same_linear(model.weights.embed, &parts.embed);
    let (read, written) = (&model.weights.layers[0], &parts.layers[0]);
    same_norm(read.norm1, &written.norm1);
    same_linear(read.qkv, &written.qkv);
    assert_eq!(read.relative_bias, written.relative_bias);
    same_linear(read.out, &written.out);
    same_norm(read.norm2, &written.norm2);
    same_linear(read.ff1, &written.ff1);
    same_linear(read.ff2, &written.ff2);
    same_norm(model.weights.final_norm, &parts.final_norm);
    same_linear(model.weights.head, &parts.head);
}

#[test]
fn a_template_may_be_missing_and_is_checked() {
    let mut parts = small();
    parts.template = None;
    let bytes = parts.to_bytes().unwrap();
    assert_eq!(Model::parse(&bytes).unwrap().header.template, None);
    let short = header_refusal(|header| header.template = &[0; TEMPLATE_BYTES - 1]);
    assert_eq!(
        short,
        ModelError::Template(TemplateError::Length {
            found: TEMPLATE_BYTES - 1
        })
    );
    let flat = header_refusal(|header| header.template = &[0; TEMPLATE_BYTES]);
    assert_eq!(
        flat,
        ModelError::Template(TemplateError::Precision {
            electrode: 0,
            found: 0
        })
    );
}

#[test]
fn a_template_can_be_exchanged_without_touching_anything_else() {
    let parts = small();
    let with = parts.to_bytes().unwrap();
    let mut bare = parts.clone();
    // Lengths of the header modulo four, so that the tensors move by every number of zeros.
    for revision in ["", "a", "ab", "abc"] {
        bare.provenance.git_revision = revision.into();
        bare.template = None;
        let without = bare.to_bytes().unwrap();
        bare.template = parts.template;
        let added = Model::with_template(&without, parts.template.as_ref()).unwrap();
        assert_eq!(added, bare.to_bytes().unwrap());
        assert_eq!(Model::with_template(&added, None).unwrap(), without);
    }
    assert!(Model::with_template(&with[1..], None).is_err());
}

#[test]
fn a_gate_can_be_exchanged_without_touching_anything_else() {
    let dimensions = Dimensions {
        other: true,
        ..SMALL
    };
    let mut parts = random_model(dimensions, 11);
    let bytes = parts.to_bytes().unwrap();
    parts.smoother.entry_margins[1..].fill(1.5);
    let entry = Model::with_gate(&bytes, Some(1.5), None, None).unwrap();
    assert_eq!(entry, parts.to_bytes().unwrap());
    parts.smoother.other_margin = Some(-2.0);
    let both = Model::with_gate(&entry, None, Some(-2.0), None).unwrap();
    assert_eq!(both, parts.to_bytes().unwrap());
    let refused = |entry, other| Model::with_gate(&bytes, entry, other, None).unwrap_err();
    assert_eq!(
        refused(Some(-1.0), None),
        ModelError::EntryMargin { found: -1.0 }
    );
    assert_eq!(
        refused(None, Some(51.0)),
        ModelError::OtherMargin { found: 51.0 }
    );
    let small = small().to_bytes().unwrap();
    assert_eq!(
        Model::with_gate(&small, None, Some(1.0), None).unwrap_err(),
        ModelError::NoOther
    );
}

#[test]
fn a_region_longer_than_the_file_is_read_at_a_multiple_of_four_alone() {
    let bytes = small().to_bytes().unwrap();
    for offset in 0..8 {
        // Allocated at once: a buffer that grows may move.
        let mut region = vec![0xff; ALIGNMENT + 8 + bytes.len() + 100];
        let start = region.as_ptr().align_offset(ALIGNMENT) + offset;
        region[start..start + bytes.len()].copy_from_slice(&bytes);
        let read = Model::parse(&region[start..]).map(|model| model.length);
        let expected = match offset % ALIGNMENT {
            0 => Ok(bytes.len()),
            found => Err(ModelError::Misaligned { found }),
        };
        assert_eq!(read, expected);
    }
}

#[test]
fn an_erased_region_and_another_file_have_no_magic() {
    assert_eq!(
        Model::parse(&[0xff; 4096]).unwrap_err(),
        ModelError::Magic { found: [0xff; 8] }
    );
    assert_eq!(
        Model::parse(b"gt,emg_0,emg_1,emg_2\n").unwrap_err(),
        ModelError::Magic {
            found: *b"gt,emg_0"
        }
    );
}

#[test]
fn a_byte_short_or_a_byte_long_is_refused() {
    let bytes = small().to_bytes().unwrap();
    let [declared, available] = [bytes.len(), bytes.len() - 1];
    assert_eq!(
        Model::parse(&bytes[..available]).unwrap_err(),
        ModelError::Length {
            declared,
            available
        }
    );
    for length in 0..PREFIX_BYTES + CHECKSUM_BYTES {
        assert_eq!(
            Model::parse(&bytes[..length]).unwrap_err(),
            ModelError::TooShort {
                expected: 17,
                found: length
            }
        );
    }
    let mut longer = bytes;
    longer.push(0);
    longer[9..13].copy_from_slice(&(declared as u32 + 1).to_le_bytes());
    assert!(matches!(
        Model::parse(&longer).unwrap_err(),
        ModelError::Checksum { .. }
    ));
    longer[9..13].copy_from_slice(&3_u32.to_le_bytes());
    assert_eq!(
        Model::parse(&longer).unwrap_err(),
        ModelError::Length {
            declared: 3,
            available: longer.len()
        }
    );
}

#[test]
fn every_single_bit_and_byte_flip_is_refused() {
    let mut bytes = small().to_bytes().unwrap();
    for position in 0..bytes.len() {
        for flip in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
            bytes[position] ^= flip;
            assert!(
                Model::parse(&bytes).is_err(),
                "byte {position}, flip {flip:02x}"
            );
            bytes[position] ^= flip;
        }
    }
    assert!(Model::parse(&bytes).is_ok());
}

#[test]
fn another_format_is_named() {
    let mut bytes = small().to_bytes().unwrap();
    bytes[8] = 4;
    let refused = Model::parse(&bytes).unwrap_err();
    assert_eq!(refused, ModelError::Version { found: 4 });
    assert_eq!(
        refused.to_string(),
        "model format 4, this build reads 7: export the model again"
    );
}

#[test]
fn a_wrong_checksum_shows_both() {
    let mut bytes = small().to_bytes().unwrap();
    let last = bytes.len() - 1;
    let expected = u32::from_le_bytes(bytes[last - 3..].try_into().unwrap());
    bytes[last] ^= 0x80;
    assert_eq!(
        Model::parse(&bytes).unwrap_err(),
        ModelError::Checksum {
            expected,
            found: expected ^ 0x8000_0000
        }
    );
}

#[test]
fn every_dimension_has_its_refusal() {
    for width in [0, 8, 20, 136, 65_528] {
        assert_eq!(
            header_refusal(|header| header.width = width),
            ModelError::Width {
                found: width.into()
            }
        );
    }
    assert_eq!(
        header_refusal(|header| header.heads = 8),
        ModelError::Heads { found: 8 }
    );
    for layers in [0, 4] {
        assert_eq!(
            header_refusal(|header| header.layers = layers),
            ModelError::Layers {
                found: layers.into()
            }
        );
    }
    for span in [0, 33] {
        assert_eq!(
            header_refusal(|header| header.span = span),
            ModelError::Span { found: span.into() }
        );
    }
    assert_eq!(
        header_refusal(|header| header.patch = 20),
        ModelError::Patch { found: 20 }
    );
    assert_eq!(
        header_refusal(|header| header.look_back = 5),
        ModelError::LookBack { found: 5 }
    );
    for classes in [0, 2, 4, 7] {
        assert_eq!(
            header_refusal(|header| header.classes = classes),
            ModelError::Classes {
                found: classes.into()
            }
        );
    }
}

#[test]
fn a_receptive_field_longer_than_the_window_is_refused() {
    // 2 x 28 + 1 patches and five more of look-back are 62.
    let refused = header_refusal(|header| (header.layers, header.span) = (2, 29));
    assert_eq!(refused, ModelError::ReceptiveField { found: 62 });
    // 60 fit; what fails then is the first tensor of the layer that the file does not have.
    let refused = header_refusal(|header| (header.layers, header.span) = (2, 28));
    assert!(
        matches!(refused, ModelError::WeightLength { .. }),
        "{refused}"
    );
}

#[test]
fn every_other_header_field_has_its_refusal() {
    assert_eq!(
        header_refusal(|header| header.companding = 2),
        ModelError::Companding { found: 2 }
    );
    assert_eq!(
        header_refusal(|header| header.sample_rate_hz = 2000),
        ModelError::SampleRate { found: 2000 }
    );
    for found in [0, 2, 5] {
        assert_eq!(
            header_refusal(|header| header.median_width = found),
            ModelError::MedianWidth { found }
        );
    }
    assert_eq!(
        header_refusal(|header| header.divisor = 127),
        ModelError::Divisor { found: 127 }
    );
    assert_eq!(
        header_refusal(|header| header.aggregation = WireAggregation::of_mode(4)),
        ModelError::AggregationMode { found: 4 }
    );
    assert_eq!(
        header_refusal(|header| header.entry_margins[2] = 50.5),
        ModelError::EntryMargin { found: 50.5 }
    );
    for found in [-50.5, 50.5, f32::INFINITY] {
        assert_eq!(
            header_refusal(|header| header.other_margin = Some(found)),
            ModelError::OtherMargin { found }
        );
    }
    for look_ahead in [45, 60] {
        assert_eq!(
            header_refusal(|header| header.look_ahead = look_ahead),
            ModelError::LookAhead {
                most: 50,
                found: look_ahead.into()
            }
        );
    }
    for hold in [0, 15, 210, 65_530] {
        assert_eq!(
            header_refusal(|header| header.hold = hold),
            ModelError::Hold { found: hold.into() }
        );
    }
}

#[test]
fn class_names_must_be_the_vocabulary_in_order() {
    let two = list(["relax", "open"]);
    assert_eq!(
        header_refusal(|header| header.class_names = &two),
        ModelError::ClassCount {
            expected: 3,
            found: 2
        }
    );
    let swapped = list(["relax", "close", "open"]);
    assert_eq!(
        header_refusal(|header| header.class_names = &swapped).to_string(),
        "class 1 is named `close`, expected `open`: train the vocabulary's order"
    );
    // Cut at 16 bytes, never within a character.
    let long = list(["relax", "fünfzehn Buchstäben und mehr", "close"]);
    assert_eq!(
        header_refusal(|header| header.class_names = &long).to_string(),
        "class 1 is named `fünfzehn Buchst`, expected `open`: train the vocabulary's order"
    );
}

#[test]
fn malformed_lists_and_texts_are_named() {
    // A text of five bytes of which one is there.
    for field in [
        "class_names",
        "data_sets",
        "subjects_seen",
        "subjects_left_out",
        "metrics",
    ] {
        let refused = header_refusal(|header| {
            let place = match field {
                "class_names" => &mut header.class_names,
                "data_sets" => &mut header.data_sets,
                "subjects_seen" => &mut header.subjects_seen,
                "subjects_left_out" => &mut header.subjects_left_out,
                _ => &mut header.metrics,
            };
            *place = &[5, b'x'];
        });
        assert_eq!(refused, ModelError::Header { field });
    }
    let whole = small().emit();
    let cut = sealed(&whole[..PREFIX_BYTES + 20]);
    assert_eq!(
        Model::parse(&cut).unwrap_err(),
        ModelError::Header { field: "header" }
    );
}

#[test]
fn a_metric_that_is_no_number_is_refused() {
    for value in [f32::NAN, f32::INFINITY] {
        let refused = refusal(|parts| parts.provenance.metrics[0].1 = value).to_string();
        assert!(refused.starts_with("a metric is"), "{refused}");
    }
}

/// Numbers of this size in every scale of the head make logits overflow to infinity, and a difference of two of
/// them NaN.
#[test]
fn numbers_that_could_overflow_an_output_are_refused() {
    for value in [1e30, 3e38, 101.0] {
        let refused = refusal(|parts| parts.head.scales.fill(value)).to_string();
        assert!(refused.starts_with("head.scales holds"), "{refused}");
    }
    let refused = refusal(|parts| parts.final_norm.bias[1] = -1e9).to_string();
    assert!(refused.starts_with("final_norm.bias holds"), "{refused}");
}

#[test]
fn tensors_of_a_wrong_length_are_named() {
    let name = |layer, group, part| TensorName { layer, group, part };
    assert_eq!(
        refusal(|parts| parts.embed.weights.truncate(1279)),
        ModelError::WeightLength {
            tensor: name(None, "embed", "weights"),
            expected: 1280,
            found: 1279
        }
    );
    assert_eq!(
        refusal(|parts| parts.layers[0].qkv.scales.push(1.0)),
        ModelError::WeightLength {
            tensor: name(Some(0), "qkv", "scales"),
            expected: 192,
            found: 196
        }
    );
    assert_eq!(
        refusal(|parts| parts.layers[0].relative_bias.truncate(19)).to_string(),
        "layers[0].relative_bias has 76 bytes, expected 80: export the model again"
    );
    assert_eq!(
        refusal(|parts| parts.final_norm.gain.clear()),
        ModelError::WeightLength {
            tensor: name(None, "final_norm", "gain"),
            expected: 64,
            found: 0
        }
    );
}

#[test]
fn missing_and_surplus_tensors_are_refused() {
    let whole = small().emit();
    let content = &whole[..whole.len() - CHECKSUM_BYTES];
    assert_eq!(
        Model::parse(&sealed(&content[..content.len() - 1])).unwrap_err(),
        ModelError::WeightsEnd {
            tensor: TensorName {
                layer: None,
                group: "head",
                part: "bias"
            }
        }
    );
    assert_eq!(
        Model::parse(&sealed(&[content, &[0, 0]].concat())).unwrap_err(),
        ModelError::Trailing { found: 2 }
    );
}

#[test]
fn a_scale_of_zero_is_refused_unless_its_row_is_zero() {
    let message = refusal(|parts| parts.layers[0].qkv.scales[7] = 0.0).to_string();
    assert!(
        message.starts_with("layers[0].qkv.scales holds 0 at 7"),
        "{message}"
    );
    // As the quantizer writes a row of zeros.
    let mut parts = small();
    let columns = parts.dimensions.width;
    parts.layers[0].qkv.scales[7] = 0.0;
    parts.layers[0].qkv.weights[7 * columns..][..columns].fill(0);
    assert!(parts.to_bytes().is_ok());
    // One weight that is none, in the row's last column.
    parts.layers[0].qkv.weights[8 * columns - 1] = 1;
    assert!(parts.to_bytes().is_err());
}

#[test]
fn numbers_that_would_break_the_arithmetic_are_refused() {
    let tensor = |layer, group, part| TensorName { layer, group, part };
    assert_eq!(
        refusal(|parts| parts.head.scales[2] = -0.5),
        ModelError::Scale {
            tensor: tensor(None, "head", "scales"),
            index: 2,
            found: -0.5
        }
    );
    assert_eq!(
        refusal(|parts| parts.embed.scales[1] = f32::INFINITY),
        ModelError::Number {
            tensor: tensor(None, "embed", "scales"),
            index: 1,
            found: f32::INFINITY
        }
    );
    assert_eq!(
        refusal(|parts| parts.layers[0].relative_bias[3] = f32::NAN).to_string(),
        "layers[0].relative_bias holds NaN at 3, expected a number from -100 to 100: train the model again"
    );
    assert_eq!(
        refusal(|parts| parts.layers[0].norm2.gain[0] = f32::NEG_INFINITY),
        ModelError::Number {
            tensor: tensor(Some(0), "norm2", "gain"),
            index: 0,
            found: f32::NEG_INFINITY
        }
    );
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

proptest! {
    #[test]
    fn quantized_rows_are_within_half_a_step(row in prop::collection::vec(-9.0_f32..9.0, 1..40)) {
        let parts = LinearParts::quantized(&row, vec![0.0]);
        for (weight, found) in row.iter().zip(parts.dequantized()) {
            let error = f64::from(*weight) - f64::from(found);
            prop_assert!(error.abs() <= 0.500_1 * f64::from(parts.scales[0]));
        }
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(Model::parse(&bytes).is_err());
        let mut file = prefix();
        file.extend(&bytes);
        seal(&mut file);
        prop_assert!(Model::parse(&file).is_err());
    }
}
