//! What a model is tuned towards besides the labels: its own old outputs, where they are right.

use shared::intent::Intent;
use shared::model::LookBackLogits;

/// Logits of the old model at every patch of a stream, those of the label and of the highest class exchanged where the two
/// are not the same: as sure as the model was, but never of what is wrong.
///
/// Source: probability shift, Wen, Lai, Qian, arXiv 1911.07471.
pub(super) fn corrected(
    mut outputs: Vec<LookBackLogits>,
    labels: &[Option<Intent>],
    classes: usize,
) -> Vec<LookBackLogits> {
    for (patch, rows) in outputs.iter_mut().enumerate() {
        // A row refers to the patch so many back.
        for (back, row) in rows.iter_mut().enumerate().take(patch + 1) {
            let Some(Some(label)) = labels.get(patch - back) else {
                continue;
            };
            let logits = &mut row[..classes];
            let (label, before) = (label.class(), logits.to_vec());
            let highest = (0..classes).max_by(|&a, &b| before[a].total_cmp(&before[b]));
            if let Some(highest) = highest.filter(|_| label < classes) {
                logits.swap(label, highest);
            }
        }
    }
    outputs
}

#[cfg(test)]
mod tests {
    use shared::units::LOOK_BACK;

    use super::*;

    #[test]
    fn a_wrong_output_is_exchanged_with_the_label_it_refers_to() {
        let row = [1.0, 3.0, 2.0, 9.0, 9.0, 9.0];
        let labels = [Intent::Open, Intent::Close].map(Some);
        let two = corrected(vec![[row; LOOK_BACK]; 2], &labels, 3);
        let close = [1.0, 2.0, 3.0, 9.0, 9.0, 9.0];
        // Open is right; what refers to before the stream stays.
        assert_eq!(two[0], [row; LOOK_BACK]);
        assert_eq!(two[1][0], close);
        assert_eq!(two[1][1], row);
        let unknown = corrected(vec![[row; LOOK_BACK]], &[None], 3);
        assert_eq!(unknown, [[row; LOOK_BACK]]);
    }
}
