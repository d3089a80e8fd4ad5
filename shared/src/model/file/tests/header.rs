//! Refusals of the header.

use super::*;

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
        header_refusal(|header| header.aggregation = WireAggregation::of_mode(6)),
        ModelError::AggregationMode { found: 6 }
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
