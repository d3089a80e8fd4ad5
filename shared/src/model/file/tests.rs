//! Every refusal, and parsing of written files.

use alloc::{string::ToString, vec, vec::Vec};

use super::{
    random::{SMALL, random_model},
    wire_header::WireHeader,
    writer::{append, list, prefix, quantize_rows, seal},
    *,
};
use crate::model::dimensions::Dimensions;
use crate::stream::alignment::{TEMPLATE_BYTES, TemplateError};
use crate::stream::smoother::Early;

mod header;
mod tensors;

fn small() -> ModelParts {
    random_model(SMALL, 11)
}

/// The refusal of a model after a change.
fn refusal(change: impl FnOnce(&mut ModelParts)) -> ModelError {
    let mut parts = small();
    change(&mut parts);
    let refused = parse_error(&parts.emit());
    assert_eq!(
        parts.to_bytes().unwrap_err().to_string(),
        refused.to_string()
    );
    refused
}

fn parse_error(file: &[u8]) -> ModelError {
    Model::parse(file).unwrap_err()
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
    parse_error(&file)
}

/// Asserts the refusal of the small model with a changed header.
#[track_caller]
fn refuses<'n>(expected: ModelError, change: impl FnOnce(&mut WireHeader<'n>)) {
    assert_eq!(header_refusal(change), expected);
}

/// A file of this content with a right checksum.
fn sealed(content: &[u8]) -> Vec<u8> {
    let mut file = content.to_vec();
    seal(&mut file);
    file
}

#[test]
fn a_template_may_be_missing_and_is_checked() {
    let mut parts = small();
    parts.template = None;
    let bytes = parts.to_bytes().unwrap();
    assert_eq!(Model::parse(&bytes).unwrap().header.template, None);
    let found = TEMPLATE_BYTES - 1;
    let short = ModelError::Template(TemplateError::Length { found });
    refuses(short, |header| header.template = &[0; TEMPLATE_BYTES - 1]);
    let (electrode, found) = (0, 0);
    let flat = ModelError::Template(TemplateError::Precision { electrode, found });
    refuses(flat, |header| header.template = &[0; TEMPLATE_BYTES]);
}

#[test]
fn a_template_can_be_exchanged_without_touching_anything_else() {
    // The tensors begin after a header of any length.
    for revision in ["", "a", "ab", "abc"] {
        let mut parts = small();
        parts.provenance.git_revision = revision.into();
        let with = parts.to_bytes().unwrap();
        let template = parts.template.take();
        let without = parts.to_bytes().unwrap();
        let added = Model::with_template(&without, template.as_ref());
        assert_eq!(added.as_ref(), Ok(&with));
        assert_eq!(Model::with_template(&with, None), Ok(without));
        assert!(Model::with_template(&with[1..], None).is_err());
    }
}

#[test]
fn a_gate_can_be_exchanged_without_touching_anything_else() {
    let dimensions = Dimensions {
        other: true,
        ..SMALL
    };
    let mut parts = random_model(dimensions, 11);
    let bytes = parts.to_bytes().unwrap();
    parts.smoother.margins.entry = 1.5;
    let entry = Model::with_gate(&bytes, Some(1.5), None, None).unwrap();
    assert_eq!(entry, parts.to_bytes().unwrap());
    parts.smoother.margins.other = Some(-2.0);
    let both = Model::with_gate(&entry, None, Some(-2.0), None).unwrap();
    assert_eq!(both, parts.to_bytes().unwrap());
    let small = small().to_bytes().unwrap();
    let refused = |file, entry, other| Model::with_gate(file, entry, other, None).unwrap_err();
    let entry = ModelError::EntryMargin { found: -1.0 };
    assert_eq!(refused(&bytes, Some(-1.0), None), entry);
    let other = ModelError::OtherMargin { found: 51.0 };
    assert_eq!(refused(&bytes, None, Some(51.0)), other);
    assert_eq!(refused(&small, None, Some(1.0)), ModelError::NoOther);
}

#[test]
fn caution_is_one_margin_more_and_without_it_a_file_is_as_it_was() {
    let mut parts = small();
    let mut bytes = |early| {
        parts.smoother.margins.early = early;
        parts.to_bytes().unwrap()
    };
    let [waits, early, caution] = [None, Some(0.0), Some(8.0)]
        .map(|caution| {
            caution.map(|caution| Early {
                entry: 0.5,
                other: 0.5,
                caution,
            })
        })
        .map(|margins| (margins, bytes(margins)));
    for (margins, bytes) in [&waits, &early, &caution] {
        assert_eq!(
            Model::parse(bytes).unwrap().header.smoother.margins.early,
            *margins
        );
    }
    let length = |(_, bytes): &(_, Vec<u8>)| bytes.len();
    assert_eq!(length(&early), length(&waits) + 4 * 4);
    assert_eq!(length(&caution), length(&early) + 4);
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
    for (file, found) in [
        (&[0xff; 4096][..], [0xff; 8]),
        (b"gt,emg_0,emg_1,emg_2\n", *b"gt,emg_0"),
    ] {
        assert_eq!(parse_error(file), ModelError::Magic { found });
    }
}

#[test]
fn a_byte_short_or_a_byte_long_is_refused() {
    let bytes = small().to_bytes().unwrap();
    let whole = bytes.len();
    let length = |declared, available| ModelError::Length {
        declared,
        available,
    };
    assert_eq!(parse_error(&bytes[..whole - 1]), length(whole, whole - 1));
    for found in 0..PREFIX_BYTES + CHECKSUM_BYTES {
        let expected = ModelError::TooShort {
            expected: 17,
            found,
        };
        assert_eq!(parse_error(&bytes[..found]), expected);
    }
    let mut longer = bytes;
    longer.push(0);
    longer[9..13].copy_from_slice(&(whole as u32 + 1).to_le_bytes());
    assert!(matches!(parse_error(&longer), ModelError::Checksum { .. }));
    longer[9..13].copy_from_slice(&3_u32.to_le_bytes());
    assert_eq!(parse_error(&longer), length(3, whole + 1));
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
    let refused = parse_error(&bytes);
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
    let found = expected ^ 0x8000_0000;
    assert_eq!(
        parse_error(&bytes),
        ModelError::Checksum { expected, found }
    );
}
