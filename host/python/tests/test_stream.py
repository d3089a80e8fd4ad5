"""The stream against the program's `replay`, the labels against its `predict`."""

import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
from support import MODEL, data, program, synthetic

import myointent

SETS = ["roshambo", "ss-stm", "epn", "myoup"]


def lines(stream, pieces):
    return "".join(event.line for samples in pieces for event in stream.push(samples)).encode()


def pieces(emg, size):
    return [emg[at : at + size] for at in range(0, len(emg), size)]


class StreamTest(unittest.TestCase):
    def setUp(self):
        self.model = myointent.Model(MODEL)

    def assert_equals_replay(self, recording, *options, **alike):
        name = f"{recording.person}/{recording.name}"
        expected = program("replay", MODEL, recording.path, "--name", name, *options)
        self.assertGreater(expected.count(b"$LABEL"), 10)
        for size in [len(recording.emg), 2, 7]:
            stream = myointent.Stream(self.model, **alike)
            found = lines(stream, pieces(recording.emg, size))
            self.assertEqual(found, expected, f"{name}, pieces of {size}")

    def test_lines_are_those_of_replay_byte_for_byte_in_pieces_of_any_size(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = myointent.read(synthetic(folder))[0]
            self.assert_equals_replay(recording)
            self.assert_equals_replay(recording, "--align", align=True)
            self.assert_equals_replay(recording, "--align", "--mirrored", 1, align=True, mirrored=True)

    def test_lines_of_published_sets_are_those_of_replay(self):
        folder = data(self.id())
        for name in SETS:
            recordings = myointent.read(folder / name)
            long = [own for own in recordings if 2000 < len(own.emg) < 40000]
            self.assert_equals_replay((long or recordings)[0])

    def test_labels_and_logits_are_those_of_predict(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = myointent.read(synthetic(folder))[0]
            emg = recording.emg[:3007]
            numbers = "\n".join(",".join(map(str, row)) for row in emg.tolist())
            source, table = Path(folder, "own.csv"), Path(folder, "labels.csv")
            source.write_text(numbers + "\n")
            program("predict", "--model", MODEL, "--recording", source, "--out", table)
            expected = np.genfromtxt(table, delimiter=",", names=True)
            labels, logits = self.model.predict(emg)
            np.testing.assert_array_equal(labels, expected["label"])
            np.testing.assert_array_equal(
                self.model.predict(emg, emitted=True)[0], expected["emitted"]
            )
            columns = [expected[f"logit_{name}"] for name in self.model.classes]
            first = np.stack(columns, axis=1)[: 10 * len(logits) : 10]
            np.testing.assert_array_equal(logits, first.astype(np.float32))
            self.assertEqual((logits.shape, labels.dtype), ((300, 3), np.int8))

    def test_an_array_is_taken_in_any_layout_and_type(self):
        loud = np.random.default_rng(1).integers(-60, 60, (1500, 8))
        emg = (loud // [1, 1, 1, 1, 9, 9, 9, 9]).astype(np.int8)
        expected = self.model.predict(emg)[1]
        turned, wide = np.asfortranarray(emg), np.repeat(emg, 2, axis=1)[:, ::2]
        for same in [turned, wide, emg[:, ::-1][:, ::-1], emg.astype(float), emg.tolist()]:
            np.testing.assert_array_equal(self.model.predict(same)[1], expected)
            stream = myointent.Stream(self.model)
            self.assertEqual(lines(stream, [same]), lines(myointent.Stream(self.model), [emg]))
        self.assertTrue((self.model.predict(emg[:, ::-1])[1] != expected).any())
        self.assertEqual(lines(myointent.Stream(self.model), []), b"")

    def test_events_have_the_fields_of_their_lines(self):
        emg = np.random.default_rng(1).integers(-60, 60, (1500, 8)).astype(np.int8)
        start, *events = myointent.Stream(self.model).push(emg)
        self.assertEqual((start.kind, start.label, start.cause), ("state", "relax", "boot"))
        label = next(event for event in events if event.kind == "label")
        fields = label.line.split(",")
        self.assertEqual([label.instant, label.emitted], [int(fields[2]), int(fields[3])])
        self.assertEqual((label.label, label.valid, label.cause), (fields[4], True, None))
        self.assertIsNone(label.alignment)
        self.assertEqual(start.strength, 0)
        for event in events:
            self.assertTrue(0 <= event.strength <= 100 and (event.strength == 0 or event.label != "relax"))
        waiting = myointent.Stream(self.model, align=True).push(emg)[1]
        self.assertEqual((waiting.kind, waiting.alignment), ("alignment", "waiting"))

    def test_speed_is_told(self):
        emg = np.random.default_rng(1).integers(-60, 60, (100_000, 8)).astype(np.int8)
        stream, start = myointent.Stream(self.model), time.process_time()
        events = stream.push(emg)
        taken = time.process_time() - start
        self.assertEqual(events[-1].emitted, 99_990)
        print(f"\nStream.push: {len(emg) / taken:,.0f} samples a second on one core")
