//! Files of labels, true and predicted: csv, text and npy.

use recordings::readers::label_file::{Purpose, parse};

/// Takes a file.
pub fn run(data: &[u8]) {
    let [truth, prediction] =
        [Purpose::Truth, Purpose::Prediction].map(|purpose| parse(data, purpose));
    let Ok(labels) = truth else { return };
    assert!(!labels.is_empty(), "at least one label");
    // A csv may name both kinds of label; a file that names neither reads the same for either purpose.
    if let Ok(prediction) = prediction {
        assert_eq!(prediction.len(), labels.len());
    }
    let text: String = labels
        .iter()
        .map(|label| label.name().to_owned() + "\n")
        .collect();
    let again = parse(text.as_bytes(), Purpose::Truth);
    assert_eq!(again.ok(), Some(labels), "written and read again");
}
