"""The float student in ONNX Runtime, streamed as the page shows it, beside the integers of the stream."""

import os
import re
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np
from support import MODEL, ROOT, skip, synthetic

import myointent

# Written by `cargo test --test predict`, which compares it with our own float student.
EXPORTED = Path(sys.prefix).parent / "tmp/onnx/three-class.onnx"


class OnnxTest(unittest.TestCase):
    def test_the_lines_of_the_page_give_nearly_the_labels_of_the_stream(self):
        try:
            import onnxruntime  # noqa: F401
        except ImportError as error:
            skip(self.id(), str(error))
        if not EXPORTED.is_file():
            skip(self.id(), f"no {EXPORTED}: `cargo test --test predict` writes it")
        page = (ROOT / "docs/python.md").read_text()
        lines = re.findall(r"```python\n(.*?)```", page, re.DOTALL)[1]
        with tempfile.TemporaryDirectory() as folder:
            recording = myointent.read(synthetic(folder))[0]
            before = os.getcwd()
            os.symlink(ROOT / "models", Path(folder, "models"))
            os.symlink(EXPORTED, Path(folder, "three-class.onnx"))
            os.chdir(folder)
            self.addCleanup(os.chdir, before)
            names = {"samples": recording.emg}
            exec(lines, names)
            os.chdir(before)
        events = myointent.Stream(myointent.Model(MODEL)).push(recording.emg)
        expected = {own.instant: own.label for own in events if own.kind == "label"}
        found = dict(filter(None, names["labels"]))
        self.assertGreater(len(set(found.values())), 1)
        self.assertGreater(len(found), 100)
        equal = sum(expected.get(instant) == label for instant, label in found.items())
        print(f"\n{equal} of {len(found)} labels are those of the integers")
        self.assertGreater(equal, 0.95 * max(len(found), len(expected)))

    def test_patches_and_smoother_take_pieces_and_refuse_other_shapes(self):
        model, emg = myointent.Model(MODEL), np.random.default_rng(1).integers(-60, 60, (1234, 8))
        whole = myointent.Patches(model).push(emg)
        self.assertEqual((whole.shape, whole.dtype), ((123, 10, 8), np.float32))
        self.assertLessEqual(whole.max(), 1)
        patches = myointent.Patches(model)
        pieces = [patches.push(emg[at : at + 7]) for at in range(0, len(emg), 7)]
        np.testing.assert_array_equal(np.concatenate(pieces), whole)
        smoother, logits = myointent.Smoother(model), np.zeros((6, 4), np.float32)
        logits[:, 2] = 9
        due = [smoother.push(logits) for _ in range(100)]
        self.assertEqual(due[:59], [None] * 59)
        self.assertEqual({label for _, label in filter(None, due)}, {"close"})
        with self.assertRaisesRegex(myointent.Error, "expected an array of 6 x 4 logits, found 6 x 3"):
            smoother.push(logits[:, :3])
