"""The teacher's network in PyTorch, with the dimensions of a preset, for compare.py.

Attention goes through `scaled_dot_product_attention` without a mask, so that PyTorch may choose a
fused kernel.
"""

import torch
from torch import nn
from torch.nn import functional as F

WINDOW, CHANNELS = 600, 8


class Layer(nn.Module):
    """One pre-norm encoder layer."""

    def __init__(self, d, heads, hidden, dropout, attention_dropout):
        super().__init__()
        self.heads, self.dropout, self.attention_dropout = heads, dropout, attention_dropout
        self.norm1, self.norm2 = nn.LayerNorm(d), nn.LayerNorm(d)
        self.qkv, self.out = nn.Linear(d, 3 * d), nn.Linear(d, d)
        self.linear1, self.linear2 = nn.Linear(d, hidden), nn.Linear(hidden, d)

    def forward(self, x):
        batch, tokens, d = x.shape
        qkv = self.qkv(self.norm1(x)).view(batch, tokens, 3, self.heads, d // self.heads)
        query, key, value = qkv.permute(2, 0, 3, 1, 4)
        probability = self.attention_dropout if self.training else 0.0
        attended = F.scaled_dot_product_attention(query, key, value, dropout_p=probability)
        attended = self.out(attended.transpose(1, 2).reshape(batch, tokens, d))
        x = x + self.drop(attended)
        return x + self.drop(self.linear2(self.drop(F.gelu(self.linear1(self.norm2(x))))))

    def drop(self, x):
        return F.dropout(x, self.dropout, self.training)


class Teacher(nn.Module):
    """Two token sequences of one window, concatenated and encoded together."""

    def __init__(self, preset):
        super().__init__()
        teacher, outputs = preset["teacher"], preset["classes"] + 1
        d, patch = teacher["d_model"], teacher["patch"]
        self.square_root = teacher["companding"] == "square-root"
        self.emg_embedding = nn.Linear(CHANNELS * patch, d)
        self.emg_norm = nn.LayerNorm(d)
        self.emg_mask = nn.Parameter(0.02 * torch.randn(d))
        self.emg_modality = nn.Parameter(0.02 * torch.randn(d))
        self.intent_modality = nn.Parameter(0.02 * torch.randn(d))
        self.position = nn.Parameter(torch.randn(WINDOW // patch, d))
        self.intent_embedding = nn.Parameter(torch.randn(outputs, d))
        self.layers = nn.ModuleList(
            Layer(d, teacher["heads"], teacher["feed_forward"], teacher["dropout"],
                  teacher["attention_dropout"])
            for _ in range(teacher["layers"])
        )
        self.emg_head = nn.Linear(d, CHANNELS * patch)
        self.intent_head = nn.Linear(d, outputs * patch)

    def forward(self, emg, emg_mask, intent):
        """EMG `[b, tokens, 8 patch]`, its mask `[b, tokens, 1]`, shares of classes
        `[b, tokens, outputs]` -> reconstruction and logits `[b, 600, outputs]`."""
        tokens, outputs = emg.shape[1], intent.shape[2]
        emg = self.emg_norm(self.emg_embedding(emg.sqrt() if self.square_root else emg))
        emg = torch.where(emg_mask > 0, self.emg_mask, emg) + self.emg_modality + self.position
        intent = intent @ self.intent_embedding + self.intent_modality + self.position
        x = torch.cat([emg, intent], dim=1)
        for layer in self.layers:
            x = layer(x)
        return (
            self.emg_head(x[:, :tokens]),
            self.intent_head(x[:, tokens:]).reshape(len(x), WINDOW, outputs),
        )


def reference_names(tensors):
    """The reference's parameters (golden/model/model.safetensors) under this network's names."""
    plain = {
        "emg_embedding.weight": tensors["emg_embedding.weight"].squeeze(-1),
        "emg_embedding.bias": tensors["emg_embedding.bias"],
        "emg_norm.weight": tensors["emg_in_layer_norm.weight"],
        "emg_norm.bias": tensors["emg_in_layer_norm.bias"],
        "emg_mask": tensors["linear_projection_learnable_mask"].flatten(),
        "emg_modality": tensors["emg_modality_specific_embedding.emg_id_embedding"].flatten(),
        "intent_modality": tensors["action_modality_specific_embedding"].flatten(),
        "position": tensors["emg_positional_encoding"][0],
        "intent_embedding": tensors["action_embedding.weight"],
        "emg_head.weight": tensors["emg_output_projection.weight"].squeeze(-1),
        "emg_head.bias": tensors["emg_output_projection.bias"],
        "intent_head.weight": tensors["action_output_projection.weight"],
        "intent_head.bias": tensors["action_output_projection.bias"],
    }
    for name, tensor in tensors.items():
        if name.startswith("transformer_encoder."):
            name = name.removeprefix("transformer_encoder.")
            name = name.replace("self_attn.in_proj_", "qkv.").replace("self_attn.out_proj", "out")
            plain[name] = tensor
    return plain
