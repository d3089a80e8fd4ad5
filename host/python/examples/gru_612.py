"""Labels of a public network, a GRU of 612 people (CHI 2026), to score beside a model file by the same metrics.

    python gru_612.py WEIGHTS.npz RECORDINGS OUT [--early SAMPLES]
    myointent score --truth RECORDINGS --prediction OUT
    myointent evaluate --model MODEL.intent --data RECORDINGS

WEIGHTS.npz: the arrays of the network's published state by their names, which is not part of this project
(github.com/eeddy/DiscreteMCI). The network decides once: every 5 samples it reads what has come since its last
decision, 150 to 250 samples, in windows of 10. The most frequent of its last five classes, if it is a gesture, is the
decision, and it starts anew. Here a decision is a label of 0.1 s. Fist is close; wrist and pinch are no label.
"""

import argparse
from pathlib import Path

import numpy as np

import myointent

WINDOW, STEP, FEWEST, MOST, VOTES, HOLD = 10, 5, 150, 250, 5, 20
# none, fist, wave-in, wave-out, open, pinch: the label of each class.
LABELS = np.array([0, 2, 0, 0, 1, 0], np.int8)
STEPS = range((FEWEST - WINDOW) // STEP + 1, (MOST - WINDOW) // STEP + 2)


def dense(weights, name, x):
    return x @ weights[f"{name}.weight"].T + weights[f"{name}.bias"]


def features(weights, windows):
    """Features of windows, shape (n, 8, 10): three convolutions of width 3, each normalized, rectified and halved."""
    x = windows.astype(np.float32)
    for at in (0, 5, 10):
        conv, norm = (f"conv_layers.{layer}" for layer in (at, at + 1))
        padded = np.pad(x, ((0, 0), (0, 0), (1, 1)))
        taps = np.lib.stride_tricks.sliding_window_view(padded, 3, axis=2)
        x = np.einsum("nctk,ock->not", taps, weights[f"{conv}.weight"], optimize=True)
        mean, scale = weights[f"{norm}.running_mean"], np.sqrt(weights[f"{norm}.running_var"] + 1e-5)
        x = x + (weights[f"{conv}.bias"] - mean)[:, None]
        x = x * (weights[f"{norm}.weight"] / scale)[:, None] + weights[f"{norm}.bias"][:, None]
        even = x.shape[2] // 2 * 2
        x = np.maximum(x[:, :, :even].reshape(*x.shape[:2], -1, 2).max(axis=3), 0)
    return x[:, :, 0]


def gru(weights, layer, inputs, state):
    """Next state of a GRU layer. `inputs` has the products of its input already."""
    of_state = state @ weights[f"temporal.weight_hh_l{layer}"].T + weights[f"temporal.bias_hh_l{layer}"]
    width = state.shape[1]
    reset, update = np.split(1 / (1 + np.exp(-(inputs + of_state)[:, : 2 * width])), 2, axis=1)
    new = np.tanh(inputs[:, 2 * width :] + reset * of_state[:, 2 * width :])
    return new + update * (state - new)


def classes(weights, emg, batch=1024):
    """Class after each number of windows in `STEPS`, from each window on: shape (windows, len(STEPS))."""
    windows = np.lib.stride_tricks.sliding_window_view(emg, WINDOW, axis=0)[::STEP]
    first = features(weights, windows) @ weights["temporal.weight_ih_l0"].T + weights["temporal.bias_ih_l0"]
    found = np.zeros((len(first), len(STEPS)), np.int8)
    for start in range(0, len(first), batch):
        rows = np.arange(start, min(start + batch, len(first)))
        states = [np.zeros((len(rows), 128), np.float32)] * 3
        for step in range(STEPS.stop - 1):
            # Behind the end nothing is read: the last window stands in.
            inputs = first[np.minimum(rows + step, len(first) - 1)]
            for layer, state in enumerate(states):
                if layer > 0:
                    name = f"temporal.{{}}_ih_l{layer}".format
                    inputs = states[layer - 1] @ weights[name("weight")].T + weights[name("bias")]
                states[layer] = gru(weights, layer, inputs, state)
            if step + 1 in STEPS:
                x = states[2]
                for name in ("initial_layer", "layer1", "layer2"):
                    x = np.maximum(dense(weights, name, x), 0)
                found[rows, step + 1 - STEPS.start] = dense(weights, "output_layer", x).argmax(axis=1)
    return found


def decisions(found):
    """Decisions in order: the window after which each is taken, and its class."""
    start, votes = 0, []
    for last in range(len(found)):
        count = min(last + 1 - start, STEPS.stop - 1)
        if count < STEPS.start:
            continue
        votes = [*votes, found[last + 1 - count, count - STEPS.start]][-VOTES:]
        mode = np.bincount(votes).argmax()
        if mode != 0 and len(votes) == VOTES:
            yield last, mode
            start, votes = last + 1, []


def labels(weights, emg, early):
    """Label of each sample, relax but for `HOLD` samples from each decision on, or from `early` samples before it."""
    emitted = np.zeros(len(emg), np.int8)
    if len(emg) >= FEWEST:
        for last, decided in decisions(classes(weights, emg)):
            at = max(last * STEP + WINDOW - 1 - early, 0)
            emitted[at : at + HOLD] = LABELS[decided]
    return emitted


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights")
    parser.add_argument("recordings")
    parser.add_argument("out", type=Path)
    parser.add_argument("--early", type=int, default=0, help="samples by which its decisions count as earlier")
    args = parser.parse_args(arguments)
    weights = {name: array.astype(np.float32) for name, array in np.load(args.weights).items()}
    for own in myointent.read(args.recordings):
        file = args.out / own.person / f"{own.name}.npy"
        file.parent.mkdir(parents=True, exist_ok=True)
        np.save(file, labels(weights, own.emg, args.early))


if __name__ == "__main__":
    main()
