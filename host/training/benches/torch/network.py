"""The networks of teacher and student in PyTorch, with the dimensions of a preset, for compare.py.

The teacher's attention goes through `scaled_dot_product_attention` without a mask, so that PyTorch may choose a
fused kernel.
"""

import torch
from torch import nn
from torch.nn import functional as F

WINDOW, CHANNELS = 600, 8
PATCH, LOOK_BACK = 10, 6


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


class StudentLayer(nn.Module):
    """One pre-norm layer with causal local attention. Parameters in the order of ours."""

    def __init__(self, d, heads, span):
        super().__init__()
        self.heads, self.span = heads, span
        self.norm1 = nn.LayerNorm(d)
        self.qkv = nn.Linear(d, 3 * d)
        self.relative_bias = nn.Parameter(torch.zeros(heads, span))
        self.out = nn.Linear(d, d)
        self.norm2 = nn.LayerNorm(d)
        self.ff1, self.ff2 = nn.Linear(d, 2 * d), nn.Linear(2 * d, d)

    def forward(self, x, distance, outside):
        batch, patches, d = x.shape
        qkv = self.qkv(self.norm1(x)).view(batch, patches, 3, self.heads, d // self.heads)
        query, key, value = qkv.permute(2, 0, 3, 1, 4)
        band = self.relative_bias[:, distance] + outside
        attended = F.scaled_dot_product_attention(query, key, value, attn_mask=band[None])
        x = x + self.out(attended.transpose(1, 2).reshape(batch, patches, d))
        hidden = self.ff1(self.norm2(x))
        return x + self.ff2(hidden * torch.sigmoid(1.702 * hidden))


class Student(nn.Module):
    """The streaming student over whole sequences: patches in, six rows of logits out for each."""

    def __init__(self, preset):
        super().__init__()
        student = preset["student"]
        d, self.span = student["d_model"], student["span"]
        self.square_root = student["companding"] == "square-root"
        self.embed = nn.Linear(CHANNELS * PATCH, d)
        self.layers = nn.ModuleList(
            StudentLayer(d, student["heads"], self.span) for _ in range(student["layers"])
        )
        self.final_norm = nn.LayerNorm(d)
        self.head = nn.Linear(d, LOOK_BACK * preset["classes"])

    def load_parameters(self, values):
        """Takes all parameters in a row, in the order of our module; our matrices are inputs by outputs."""
        values, place = torch.tensor(values), 0

        def take(parameter):
            nonlocal place
            own = values[place:place + parameter.numel()]
            place += parameter.numel()
            shape = parameter.shape[::-1] if parameter in matrices else parameter.shape
            own = own.view(shape).T if parameter in matrices else own.view(shape)
            parameter.data.copy_(own)

        matrices = {part.weight for part in self.modules() if isinstance(part, nn.Linear)}
        layers = [
            (layer.norm1, layer.qkv, layer.relative_bias, layer.out, layer.norm2, layer.ff1, layer.ff2)
            for layer in self.layers
        ]
        for part in [self.embed, *sum(layers, ()), self.final_norm, self.head]:
            for parameter in [part] if isinstance(part, nn.Parameter) else [part.weight, part.bias]:
                take(parameter)
        assert place == len(values), f"{len(values)} parameters, {place} expected"

    def forward(self, emg):
        patches = torch.arange(emg.shape[1])
        age = patches[:, None] - patches
        inside = (age >= 0) & (age < self.span)
        distance = age.where(inside, 0)
        outside = torch.zeros(age.shape).masked_fill(~inside, -torch.inf)
        x = self.embed(emg.sqrt() if self.square_root else emg)
        for layer in self.layers:
            x = layer(x, distance, outside)
        return self.head(self.final_norm(x)).unflatten(-1, (LOOK_BACK, -1))
