//! Low-rank adaptation (LoRA, arXiv 2106.09685) of a trained teacher.

use burn::module::{Lora, Module as _, ParamGroup};

use super::model::Teacher;
use presets::teacher::LoraConfig;

/// Adds adapters to a model, which alone are trained; at first they do not change its outputs.
pub(super) fn adapt(lora: LoraConfig, model: Teacher) -> Teacher {
    let mut paths = vec!["intent_head.weight".to_owned()];
    for layer in 0..model.depth() {
        paths.extend(["linear1", "linear2"].map(|name| format!("layers.{layer}.{name}.weight")));
    }
    let lora = Lora::new(lora.rank, lora.alpha).set_param_group(ParamGroup::from_paths(paths));
    model.apply_lora(lora)
}
