//! Low-rank adaptation (LoRA, arXiv 2106.09685) of a trained teacher.

use burn::module::{Lora, Module as _, ParamGroup};
use serde::{Deserialize, Serialize};

use super::model::Teacher;

/// LoRA of the feed-forward blocks and of the intent head, the layers that the reference adapts.
///
/// The reference's defaults are rank 16, alpha 8 and a dropout of 0.05 in the adapters; there is no
/// dropout here.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoraConfig {
    /// Rank of an adapter.
    pub rank: usize,
    /// Adapters are scaled by `alpha / rank`.
    pub alpha: f64,
}

impl LoraConfig {
    /// The model with adapters, which alone are trained; at first they do not change its outputs.
    pub(super) fn adapt(self, model: Teacher) -> Teacher {
        let mut paths = vec!["intent_head.weight".to_owned()];
        for layer in 0..model.depth() {
            paths
                .extend(["linear1", "linear2"].map(|name| format!("layers.{layer}.{name}.weight")));
        }
        let lora = Lora::new(self.rank, self.alpha).set_param_group(ParamGroup::from_paths(paths));
        model.apply_lora(lora)
    }
}
