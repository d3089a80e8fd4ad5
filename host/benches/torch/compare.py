"""Training steps and inference, ours and PyTorch's, in turn within one run.

    python host/benches/torch/compare.py [--rounds 9]

Needs `pip install torch numpy safetensors`; builds our half itself. Each round asks either side
for a step and a window, so that whatever else the machine does hits both; processor time is what
the threads ran, without the time they waited for a core.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
RUNS = [("paper", 8), ("cpu", 128)]


def ours():
    """Builds our half and finds it among what Cargo made."""
    command = "cargo bench --locked --no-run --message-format=json".split()
    output = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout
    for line in output.splitlines():
        message = json.loads(line)
        if message.get("executable") and message["target"]["name"] == "training_step":
            return message["executable"]
    sys.exit("cargo bench made no `training_step`: is it in host/Cargo.toml?")


class Side:
    """One of the programs, which answers a line with a line."""

    def __init__(self, name, command):
        self.name, self.peak = name, 0.0
        self.seconds, self.processor = {"step": [], "window": []}, {"step": [], "window": []}
        threads = {"OMP_NUM_THREADS": "2", "MKL_NUM_THREADS": "2"}
        self.process = subprocess.Popen(
            command, env=os.environ | threads, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )

    def ask(self, question, warm_up):
        busy = self.processor_seconds()
        print(question, file=self.process.stdin, flush=True)
        answer = json.loads(self.process.stdout.readline())
        busy = self.processor_seconds() - busy
        self.peak = answer["peak_mib"]
        if not warm_up:
            self.seconds[question].append(answer["seconds"])
            self.processor[question].append(busy)

    def processor_seconds(self):
        """What the process's threads ran so far; 0 where the system does not say."""
        threads = Path(f"/proc/{self.process.pid}/task").glob("*/schedstat")
        return sum(int(thread.read_text().split()[0]) for thread in threads) * 1e-9

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--ours", help="our half, already built")
    parser.add_argument("--also", help="an older build of our half, to see what a change bought")
    arguments = parser.parse_args()
    program = arguments.ours or ours()
    torch = [sys.executable, str(HERE / "step.py")]
    print("| what | side | median s | min s | processor s | ours / side: median, min, processor "
          "| peak MiB |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, batch in RUNS:
        of = [name, str(batch)]
        sides = [Side("ours", [program, *of]), Side("torch", [*torch, *of])]
        if name == "paper":
            sides.append(Side("torch, attention kept", [*torch, *of, "--no-attention-dropout"]))
        if arguments.also:
            sides.append(Side("ours before", [arguments.also, *of]))
        for round in range(-2, arguments.rounds):
            for question in ("step", "window"):
                for side in sides:
                    side.ask(question, warm_up=round < 0)
        for question in ("step", "window"):
            what = f"{name}, {f'step of {batch}' if question == 'step' else 'one window'}"
            rows = [
                [statistics.median(side.seconds[question]), min(side.seconds[question]),
                 statistics.median(side.processor[question])]
                for side in sides
            ]
            for side, row in zip(sides, rows):
                times = " | ".join(f"{value:.4f}" for value in row)
                ratios = ", ".join(f"{our / their:.2f}" for our, their in zip(rows[0], row))
                print(f"| {what} | {side.name} | {times} | {ratios} | {side.peak:.0f} |", flush=True)
        for side in sides:
            side.close()


main()
