//! Refusals of the header.

use super::*;
use crate::model::file::wire_aggregation::WireAggregation;
use alloc::format;

#[test]
fn every_number_has_its_range() {
    let refused = |what, found, least, most, change: &dyn Fn(&mut WireHeader<'_>)| {
        let expected = ModelError::OutOfRange {
            what,
            found,
            least,
            most,
        };
        assert_eq!(header_refusal(change), expected);
    };
    refused("attention heads", 8, 4, 4, &|header| header.heads = 8);
    refused("layers", 0, 1, 3, &|header| header.layers = 0);
    refused("layers", 4, 1, 3, &|header| header.layers = 4);
    refused("attention span", 0, 1, 32, &|header| header.span = 0);
    refused("attention span", 33, 1, 32, &|header| header.span = 33);
    refused("samples of a patch", 20, 10, 10, &|header| {
        header.patch = 20
    });
    refused("look-back rows", 5, 6, 6, &|header| header.look_back = 5);
    refused("companding", 2, 0, 1, &|header| header.companding = 2);
    refused("sample rate", 2000, 200, 200, &|header| {
        header.sample_rate_hz = 2000
    });
    refused("divisor", 127, 128, 128, &|header| header.divisor = 127);
    refused("look-ahead", 60, 0, 50, &|header| header.look_ahead = 60);
    refused("hold", 0, 10, 200, &|header| header.hold = 0);
    refused("hold", 210, 10, 200, &|header| header.hold = 210);
    let beyond = "samples beyond a patch";
    refused(beyond, 5, 0, 0, &|header| header.look_ahead = 45);
    refused(beyond, 5, 0, 0, &|header| header.hold = 15);
}

#[test]
fn every_other_field_has_its_refusal() {
    for width in [0, 8, 20, 136, 65_528] {
        let found = width.into();
        refuses(ModelError::Width { found }, |header| header.width = width);
    }
    for classes in [0, 2, 4, 7] {
        let found = classes.into();
        refuses(ModelError::Classes { found }, |header| {
            header.classes = classes
        });
    }
    for found in [0, 2, 5] {
        refuses(ModelError::MedianWidth { found }, |header| {
            header.median_width = found
        });
    }
    let margin = |found| ModelError::EntryMargin { found };
    refuses(margin(50.5), |header| header.entry_margins[1..].fill(50.5));
    refuses(margin(1.0), |header| header.entry_margins[2] = 1.0);
    for (margins, found) in [
        ([50.5, 0.5, 1.0, 0.5], 50.5),
        ([0.5, -0.5, 1.0, 0.5], -0.5),
        ([0.5, 0.5, 0.9, 0.5], 0.9),
        ([0.5, 0.5, 1.0, 0.6], 0.6),
    ] {
        let early = WireAggregation::SameInstantEarly(margins);
        refuses(ModelError::EarlyMargin { found }, |header| {
            header.aggregation = early
        });
    }
    for found in [-50.5, 50.5, f32::INFINITY] {
        refuses(ModelError::OtherMargin { found }, |header| {
            header.other_margin = Some(found)
        });
    }
}

#[test]
fn a_receptive_field_longer_than_the_window_is_refused() {
    // 2 x 28 + 1 patches, or 3 x 19 + 1, and five more of look-back.
    for (layers, span, found) in [(2, 29, 62), (3, 20, 63)] {
        let expected = ModelError::ReceptiveField { found };
        refuses(expected, |header| {
            (header.layers, header.span) = (layers, span)
        });
    }
    // 60 fit; what fails then is the first tensor of the layer that the file does not have.
    let refused = header_refusal(|header| (header.layers, header.span) = (2, 28));
    assert!(
        matches!(refused, ModelError::WeightLength { .. }),
        "{refused}"
    );
}

#[test]
fn class_names_must_be_the_vocabulary_in_order() {
    let two = list(["relax", "open"]);
    let (expected, found) = (3, 2);
    let count = ModelError::ClassCount { expected, found };
    refuses(count, |header| header.class_names = &two);
    // Cut at 16 bytes, never within a character.
    for (name, shown) in [
        ("close", "close"),
        ("fünfzehn Buchstäben und mehr", "fünfzehn Buchst"),
    ] {
        let names = list(["relax", name, "close"]);
        let refused = header_refusal(|header| header.class_names = &names);
        let words =
            format!("class 1 is named `{shown}`, expected `open`: train the vocabulary's order");
        assert_eq!(refused.to_string(), words);
    }
}

#[test]
fn malformed_lists_and_texts_are_named() {
    // A text of five bytes of which one is there.
    const TEXT: &[u8] = &[5, b'x'];
    let named = |field| ModelError::Header { field };
    refuses(named("class_names"), |header| header.class_names = TEXT);
    refuses(named("data_sets"), |header| header.data_sets = TEXT);
    refuses(named("subjects_seen"), |header| header.subjects_seen = TEXT);
    refuses(named("subjects_left_out"), |header| {
        header.subjects_left_out = TEXT
    });
    refuses(named("metrics"), |header| header.metrics = TEXT);
    let whole = small().emit();
    let cut = sealed(&whole[..PREFIX_BYTES + 20]);
    assert_eq!(parse_error(&cut), named("header"));
}

#[test]
fn a_metric_that_is_no_number_is_refused() {
    for value in [f32::NAN, f32::INFINITY] {
        let refused = refusal(|parts| parts.provenance.metrics[0].1 = value).to_string();
        assert!(refused.starts_with("a metric is"), "{refused}");
    }
}
