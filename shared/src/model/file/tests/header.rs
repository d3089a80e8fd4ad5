//! Refusals of the header.

use super::*;
use crate::model::file::wire_aggregation::WireAggregation;

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
        refuses(|header| header.width = width, ModelError::Width { found });
    }
    for classes in [0, 2, 4, 7] {
        let found = classes.into();
        refuses(
            |header| header.classes = classes,
            ModelError::Classes { found },
        );
    }
    for found in [0, 2, 5] {
        refuses(
            |header| header.median_width = found,
            ModelError::MedianWidth { found },
        );
    }
    let found = 50.5;
    refuses(
        |header| header.entry_margins[1..].fill(found),
        ModelError::EntryMargin { found },
    );
    let found = 1.0;
    refuses(
        |header| header.entry_margins[2] = found,
        ModelError::EntryMargin { found },
    );
    for (margins, found) in [
        ([50.5, 0.5, 1.0, 0.5], 50.5),
        ([0.5, -0.5, 1.0, 0.5], -0.5),
        ([0.5, 0.5, 0.9, 0.5], 0.9),
        ([0.5, 0.5, 1.0, 0.6], 0.6),
    ] {
        refuses(
            |header| header.aggregation = WireAggregation::SameInstantEarly(margins),
            ModelError::EarlyMargin { found },
        );
    }
    for found in [-50.5, 50.5, f32::INFINITY] {
        refuses(
            |header| header.other_margin = Some(found),
            ModelError::OtherMargin { found },
        );
    }
}

#[test]
fn a_receptive_field_longer_than_the_window_is_refused() {
    // 2 x 28 + 1 patches and five more of look-back are 62.
    refuses(
        |header| (header.layers, header.span) = (2, 29),
        ModelError::ReceptiveField { found: 62 },
    );
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
    refuses(
        |header| header.class_names = &two,
        ModelError::ClassCount {
            expected: 3,
            found: 2,
        },
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
    let field = "header";
    assert_eq!(parse_error(&cut), ModelError::Header { field });
}

#[test]
fn a_metric_that_is_no_number_is_refused() {
    for value in [f32::NAN, f32::INFINITY] {
        let refused = refusal(|parts| parts.provenance.metrics[0].1 = value).to_string();
        assert!(refused.starts_with("a metric is"), "{refused}");
    }
}
