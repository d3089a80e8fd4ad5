"""The examples, each where its package is installed."""

import contextlib
import importlib
import io
import json
import socket
import sys
import tempfile
import time
import unittest
import warnings
from multiprocessing import Lock
from pathlib import Path

import libemg_alone
import numpy as np
from support import EXAMPLES, MODEL, program, skip, synthetic

import myointent


def example(test, name):
    sys.path.insert(0, str(EXAMPLES))
    try:
        return importlib.import_module(name)
    except (ImportError, OSError, RuntimeError) as error:
        skip(test, f"{name}: {error}")


def printed(call, *arguments):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        call(*map(str, arguments))
    return out.getvalue().splitlines()


def labels_at_patches(emg):
    """Class of the newest label after each 10 samples."""
    model, label = myointent.Model(MODEL), 0
    stream, labels = myointent.Stream(model), []
    for at in range(0, len(emg) // 10 * 10, 10):
        for event in stream.push(emg[at : at + 10]):
            label = model.classes.index(event.label)
        labels.append(label)
    return labels


def network():
    """Names and shapes of the public network's arrays."""
    yield from {
        f"conv_layers.{layer}.{name}": shape
        for layer, inputs, width in [(0, 8, 16), (5, 16, 32), (10, 32, 64)]
        for name, shape in [("weight", (width, inputs, 3)), ("bias", width)]
    }.items()
    for layer, width in [(1, 16), (6, 32), (11, 64)]:
        for name in ["weight", "bias", "running_mean", "running_var"]:
            yield f"conv_layers.{layer}.{name}", width
    for layer, inputs in enumerate([64, 128, 128]):
        for name, width in [("ih", inputs), ("hh", 128)]:
            yield f"temporal.weight_{name}_l{layer}", (384, width)
            yield f"temporal.bias_{name}_l{layer}", 384
    for name, inputs, width in [("initial_layer", 128, 128), ("layer1", 128, 64), ("layer2", 64, 32)]:
        yield f"{name}.weight", (width, inputs)
        yield f"{name}.bias", width
    yield "output_layer.weight", (6, 32)
    yield "output_layer.bias", 6


class ExamplesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = synthetic(folder.name)
        warnings.simplefilter("ignore")
        libemg_alone.prepare()
        self.recording = myointent.read(self.folder)[0]

    def test_libemg_decides_as_the_stream(self):
        own = example(self.id(), "libemg_classifier")
        lines = printed(own.main, MODEL, self.recording.path)
        expected = labels_at_patches(self.recording.emg)
        changes = np.flatnonzero(np.diff(expected, prepend=-1))
        self.assertEqual([float(line.split()[0]) for line in lines], [at / 20 for at in changes])
        self.assertGreater(len(lines), 5)

    def test_libemg_decides_online_as_the_stream(self):
        own = example(self.id(), "libemg_classifier")
        from libemg.data_handler import OnlineDataHandler
        from libemg.emg_predictor import EMGClassifier, OnlineEMGClassifier
        from libemg.shared_memory_manager import SharedMemoryManager

        items = [["emg", (100, 8), np.double, Lock()], ["emg_count", (1, 1), np.int32, Lock()]]
        memory = SharedMemoryManager()
        for item in items:
            memory.create_variable(*item)
        self.addCleanup(memory.cleanup)
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(receiver.close)
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(60)
        online = OnlineEMGClassifier(
            EMGClassifier(own.DeviceModel(MODEL)),
            own.WINDOW,
            own.WINDOW,
            OnlineDataHandler(items),
            features=None,
            port=receiver.getsockname()[1],
        )
        # Its process empties the memory when it starts, and asks for more than a window before the first decision. The mark
        # stands before the process: set after it, the mark could come after the memory was emptied, and would stay for ever.
        memory.modify_variable("emg_count", lambda count: count * 0 + 1)
        online.run(block=False)
        self.addCleanup(online.stop_running)
        while memory.get_variable("emg_count")[0, 0] != 0:
            time.sleep(0.01)
        emg, found = self.recording.emg[:2000], []
        for at in range(0, len(emg), own.WINDOW):
            chunk = emg[at : at + own.WINDOW][::-1]
            memory.modify_variable("emg", lambda old: np.vstack([chunk, old])[:100])
            memory.modify_variable("emg_count", lambda count: count + own.WINDOW)
            if at > 0:
                found.append(int(receiver.recv(64)))
        self.assertEqual(found, labels_at_patches(emg[own.WINDOW :]))
        self.assertGreater(len(set(found)), 1)

    def test_a_classifier_of_scikit_learn_is_scored(self):
        own = example(self.id(), "sklearn_lda")
        lines = printed(own.main, self.folder)
        self.assertEqual(len(lines), 3)
        for line in lines:
            self.assertGreater(float(line.split("balanced accuracy ")[1].split(",")[0]), 0.5, line)
            self.assertRegex(line, r"median latency: (-?\d+ ms|more than half missed)$")

    def test_a_public_network_votes_and_its_labels_are_scored(self):
        own = example(self.id(), "gru_612")
        every = np.full((100, len(own.STEPS)), 4, np.int8)
        # Five windows after the first 29, and anew from the next window on.
        self.assertEqual(list(own.decisions(every)), [(32, 4), (65, 4), (98, 4)])
        # After two votes for a gesture, rest has the majority.
        every[:, 2:] = 0
        self.assertEqual(list(own.decisions(every)), [])
        random = np.random.default_rng(7)
        with tempfile.TemporaryDirectory() as folder:
            weights, out = Path(folder) / "weights.npz", Path(folder) / "labels"
            np.savez(weights, **{name: random.random(shape) / 9 for name, shape in network()})
            own.main([str(weights), self.folder, str(out)])
            results = json.loads(program("score", "--truth", self.folder, "--prediction", out, "--json"))
        self.assertEqual(results["scores"][0]["means"]["decided"]["n"], 3)

    def test_lab_streaming_layer_receives_samples_and_labels(self):
        own = example(self.id(), "lab_streaming_layer")
        from pylsl import StreamInlet, resolve_byprop

        source = f"test-{time.time_ns()}"
        emg_outlet, label_outlet = own.outlets(source)
        inlets = []
        for kind in ["emg", "labels"]:
            found = resolve_byprop("source_id", f"{source}-{kind}", timeout=10)
            if not found:
                skip(self.id(), "this machine's network shows no stream of Lab Streaming Layer")
            inlets.append(StreamInlet(found[0]))
            inlets[-1].open_stream(timeout=10)
        emg, stream, last = self.recording.emg[:2000], myointent.Stream(myointent.Model(MODEL)), None
        for at in range(0, len(emg), own.TOGETHER):
            last = own.send(
                stream, emg[at : at + own.TOGETHER], emg_outlet, label_outlet, 100 + at / own.RATE, last
            )
        received = []
        while len(received) < len(emg):
            chunk, _ = inlets[0].pull_chunk(timeout=10, max_samples=len(emg))
            self.assertTrue(chunk, len(received))
            received += chunk
        np.testing.assert_array_equal(received, emg)
        label, at = inlets[1].pull_sample(timeout=10)
        self.assertEqual((label, at), (["relax"], 100))
        self.assertIsNotNone(inlets[1].pull_sample(timeout=10)[0])
