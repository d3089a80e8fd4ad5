//! Marks of models that are evaluated on people whom they were trained or tuned on.

use crate::model_evaluation::{ALIGNED, EvaluatedSubject, ModelResults};

/// Results with each model named as on a page: the name says if the model has seen some of the people.
pub(super) fn marked(results: &ModelResults) -> ModelResults {
    let mut marked = results.clone();
    for (at, model) in results.models.iter().enumerate() {
        let mark = mark(seen_by(results, &model.name).len(), results.subjects.len());
        marked.models[at].name += &mark;
        let scores = marked.scores.iter_mut().map(|score| &mut score.model);
        let alignments = marked.alignments.iter_mut().map(|own| &mut own.model);
        for name in scores.chain(alignments) {
            // The model itself, and the same model aligned.
            let rest = name.strip_prefix(&model.name);
            if rest.is_some_and(|rest| rest.is_empty() || rest == ALIGNED) {
                name.insert_str(model.name.len(), &mark);
            }
        }
    }
    marked
}

/// The evaluated people whom a model has seen.
pub(super) fn seen_by<'a>(results: &'a ModelResults, model: &str) -> Vec<&'a str> {
    let saw = |own: &&EvaluatedSubject| own.seen_by.iter().any(|name| name == model);
    let seen = results.subjects.iter().filter(saw);
    seen.map(|own| &own.subject[..]).collect()
}

/// Suffix of a model's name about the people whom it has seen; empty if it has seen nobody.
fn mark(seen: usize, people: usize) -> String {
    match seen {
        0 => String::new(),
        _ if seen == people => " (has seen them)".to_owned(),
        _ => format!(" (has seen {seen} of {people})"),
    }
}
