"""Time of training steps and of inference in this project and in PyTorch, measured alternately.

    python host/training/benches/torch/compare.py [--rounds 9]

Needs `pip install torch numpy safetensors`; builds the bench `training_step` itself. Each round measures
a step and a window of either program, so that other load on the machine affects both. Processor time
is the time that the threads ran, without waiting for a core.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tomllib
from pathlib import Path

import torch

from network import CHANNELS, PATCH, Student

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
RUNS = [("paper", 8, ("step", "window")), ("cpu", 128, ("step", "window", "student"))]


def ours():
    """Builds the bench `training_step` and returns its path."""
    command = "cargo bench --locked --no-run --message-format=json".split()
    output = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout
    for line in output.splitlines():
        message = json.loads(line)
        if message.get("executable") and message["target"]["name"] == "training_step":
            return message["executable"]
    sys.exit("cargo bench made no `training_step`: is it in host/Cargo.toml?")

WHAT = {"step": "step of {}", "window": "one window", "student": "step of the student"}


def check_student(program):
    """Checks that PyTorch's student computes what ours computes with the same weights."""
    run = subprocess.run([program, "cpu", "128"], input="student-case\n", text=True, check=True,
                         stdout=subprocess.PIPE)
    case = json.loads(run.stdout)
    preset = tomllib.loads((ROOT / "host/presets/cpu.toml").read_text())
    model = Student(preset)
    model.load_parameters(case["parameters"])
    with torch.no_grad():
        logits = model(torch.tensor(case["emg"]).view(1, -1, CHANNELS * PATCH))
    torch.testing.assert_close(logits.flatten(), torch.tensor(case["logits"]), atol=1e-5, rtol=0)


class Side:
    """One of the programs: it prints a line with a measurement for each line of input."""

    def __init__(self, name, command):
        self.name, self.peak = name, 0.0
        self.seconds, self.processor = {}, {}
        threads = {"OMP_NUM_THREADS": "2", "MKL_NUM_THREADS": "2"}
        self.process = subprocess.Popen(
            command, env=os.environ | threads, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )

    def measure(self, kind, warm_up):
        busy = self.processor_seconds()
        print(kind, file=self.process.stdin, flush=True)
        result = json.loads(self.process.stdout.readline())
        busy = self.processor_seconds() - busy
        self.peak = result["peak_mib"]
        if not warm_up:
            self.seconds.setdefault(kind, []).append(result["seconds"])
            self.processor.setdefault(kind, []).append(busy)

    def processor_seconds(self):
        """Processor time of the threads so far; 0 on systems other than Linux."""
        threads = Path(f"/proc/{self.process.pid}/task").glob("*/schedstat")
        return sum(int(thread.read_text().split()[0]) for thread in threads) * 1e-9

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--ours", help="path of `training_step`, already built")
    parser.add_argument("--also", help="path of an older build of it, to measure a change")
    arguments = parser.parse_args()
    program = arguments.ours or ours()
    torch = [sys.executable, str(HERE / "step.py")]
    print("| what | side | median s | min s | processor s | ours / side: median, min, processor "
          "| peak MiB |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    check_student(program)
    for name, batch, kinds in RUNS:
        of = [name, str(batch)]
        sides = [Side("ours", [program, *of]), Side("torch", [*torch, *of])]
        if name == "paper":
            sides.append(Side("torch, attention kept", [*torch, *of, "--no-attention-dropout"]))
        if arguments.also:
            sides.append(Side("ours before", [arguments.also, *of]))
        for round in range(-2, arguments.rounds):
            for kind in kinds:
                for side in sides:
                    side.measure(kind, warm_up=round < 0)
        for kind in kinds:
            what = f"{name}, {WHAT[kind].format(batch)}"
            rows = [
                [statistics.median(side.seconds[kind]), min(side.seconds[kind]),
                 statistics.median(side.processor[kind])]
                for side in sides
            ]
            for side, row in zip(sides, rows):
                times = " | ".join(f"{value:.4f}" for value in row)
                ratios = ", ".join(f"{our / their:.2f}" for our, their in zip(rows[0], row))
                print(f"| {what} | {side.name} | {times} | {ratios} | {side.peak:.0f} |", flush=True)
        for side in sides:
            side.close()


main()
