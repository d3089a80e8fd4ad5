"""Seconds of a training step of teacher and student and of a window's inference in PyTorch, for compare.py.

    python host/training/benches/torch/step.py paper 8

Prints a line with a JSON object for each line of input: for `step` the seconds of a training step
(forward, backward, AdamW) on two threads, for `student` those of the student's, for `window` those of one window's inference on one thread.
"""

import json
import os
import resource
import sys
import time
import tomllib
from pathlib import Path

import torch
from torch.nn import functional as F

from network import CHANNELS, LOOK_BACK, PATCH, WINDOW, Student, Teacher, reference_names

HOST = Path(__file__).resolve().parents[2]
GOLDEN = Path(os.environ.get("MYOINTENT_GOLDEN", HOST.parent / "tests/golden/data"))


def check_against_the_reference(preset):
    """Checks that the network computes what the reference computes."""
    weights = GOLDEN / "model/model.safetensors"
    if not weights.exists():
        print(f"SKIPPED the check against the reference: no {weights}", file=sys.stderr)
        return
    from safetensors.torch import load_file

    model = Teacher(preset).eval()
    model.load_state_dict(reference_names(load_file(weights)))
    cases = load_file(GOLDEN / "model/cases.safetensors")
    for name in ("inference", "partly_masked", "end_masked", "emg_reconstruction"):
        case = {key: cases[f"{name}.{key}"] for key in ("emg", "emg_mask", "intent")}
        shares = F.one_hot(case["intent"], preset["classes"] + 1).float()
        with torch.no_grad():
            emg, logits = model(case["emg"][None], case["emg_mask"][None, :, None], shares[None])
        torch.testing.assert_close(emg[0], cases[f"{name}.emg_out"], atol=1e-5, rtol=0)
        torch.testing.assert_close(logits[0], cases[f"{name}.intent_logits"], atol=1e-5, rtol=0)


class Bench:
    """A model and a batch of random windows, a third of either modality masked."""

    def __init__(self, preset, batch):
        torch.manual_seed(preset["seed"])
        patch, outputs = preset["teacher"]["patch"], preset["classes"] + 1
        tokens = WINDOW // patch
        self.emg = torch.rand(batch, tokens, CHANNELS * patch)
        self.emg_mask = (torch.rand(batch, tokens, 1) < 1 / 3).float()
        self.target = torch.randint(outputs - 1, (batch, WINDOW))
        masked = torch.rand(batch, tokens) < 1 / 3
        self.masked = masked.repeat_interleave(patch, dim=1).float()
        seen = self.target[:, ::patch].masked_fill(masked, outputs - 1)
        self.intent = F.one_hot(seen, outputs).float()
        self.model = Teacher(preset)
        self.adam = torch.optim.AdamW(
            self.model.parameters(), lr=1e-4, weight_decay=0.01, fused=True
        )

    def step(self):
        torch.set_num_threads(2)
        self.model.train()
        start = time.perf_counter()
        self.adam.zero_grad()
        emg, logits = self.model(self.emg, self.emg_mask, self.intent)
        squares = (emg - self.emg).square() * self.emg_mask
        entropies = F.cross_entropy(logits.transpose(1, 2), self.target, reduction="none")
        cells = self.emg_mask.sum() * emg.shape[2]
        loss = squares.sum() / cells + (entropies * self.masked).sum() / self.masked.sum()
        loss.backward()
        self.adam.step()
        return time.perf_counter() - start

    def window(self):
        torch.set_num_threads(1)
        self.model.eval()
        with torch.inference_mode():
            start = time.perf_counter()
            self.model(self.emg[:1], self.emg_mask[:1], self.intent[:1])
            return time.perf_counter() - start


class StudentBench:
    """A student and a batch of random excerpts; every output after the first span has a label."""

    def __init__(self, preset):
        torch.manual_seed(preset["seed"])
        settings, span = preset["distillation"], preset["student"]["span"]
        shape = settings["batch"], settings["patches"]
        self.emg = torch.rand(*shape, CHANNELS * PATCH)
        self.target = torch.randint(preset["classes"], (*shape, LOOK_BACK))
        self.mask = torch.ones(*shape, LOOK_BACK)
        self.mask[:, :span] = 0
        self.model = Student(preset)
        self.adam = torch.optim.AdamW(
            self.model.parameters(), lr=1e-4, weight_decay=settings["weight_decay"], fused=True
        )

    def student(self):
        torch.set_num_threads(2)
        start = time.perf_counter()
        self.adam.zero_grad()
        logits = self.model(self.emg)
        entropies = F.cross_entropy(logits.movedim(-1, 1), self.target, reduction="none")
        loss = (entropies * self.mask).sum() / self.mask.sum()
        loss.backward()
        self.adam.step()
        return time.perf_counter() - start


def main():
    name, batch = sys.argv[1], int(sys.argv[2])
    preset = tomllib.loads((HOST / f"presets/{name}.toml").read_text())
    if name == "paper":
        check_against_the_reference(preset)
    if "--no-attention-dropout" in sys.argv:
        preset["teacher"]["attention_dropout"] = 0.0
    benches = {"step": Bench(preset, batch), "student": StudentBench(preset)}
    benches["window"] = benches["step"]
    for line in sys.stdin:
        busy = time.process_time()
        kind = line.strip()
        seconds = getattr(benches[kind], kind)()
        busy = time.process_time() - busy
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(json.dumps({"seconds": seconds, "processor": busy, "peak_mib": peak}), flush=True)


main()
