"""Models, recordings and reports in other processes."""

import copy
import pickle
import tempfile
import unittest
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from support import MODEL, synthetic

import myointent


def labels(model, recording):
    return model.predict(recording.emg)[0]


class PickleTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = synthetic(folder.name)
        self.model = myointent.Model(MODEL)
        self.recording = myointent.read(self.folder)[0]

    def test_each_comes_back_as_it_was(self):
        for again in [lambda own: pickle.loads(pickle.dumps(own)), copy.deepcopy]:
            model, recording = again((self.model, self.recording))
            self.assertEqual((model.name, model.classes), (self.model.name, self.model.classes))
            self.assertEqual(repr(recording), repr(self.recording))
            for field in ["person", "name", "path", "other_movement", "notes"]:
                self.assertEqual(getattr(recording, field), getattr(self.recording, field))
            for field in ["emg", "labels"]:
                own, expected = getattr(recording, field), getattr(self.recording, field)
                np.testing.assert_array_equal(own, expected)
                self.assertEqual(own.dtype, expected.dtype)
            report = myointent.score(recording.labels, labels(model, recording))
            same = again(report)
            self.assertEqual((same.results, str(same)), (report.results, str(report)))

    def test_a_process_of_its_own_takes_a_model_and_a_recording(self):
        with get_context("spawn").Pool(1) as pool:
            found = pool.apply(labels, (self.model, self.recording))
        np.testing.assert_array_equal(found, labels(self.model, self.recording))

    def test_a_model_is_made_of_the_content_of_its_file(self):
        content = Path(MODEL).read_bytes()
        model = myointent.Model(content, "mine")
        self.assertEqual(model.name, "mine")
        np.testing.assert_array_equal(
            labels(model, self.recording), labels(self.model, self.recording)
        )
        with self.assertRaisesRegex(myointent.Error, "model is refused"):
            myointent.Model(content[:-1])
        report = myointent.evaluate(myointent.Model(content, "energy detector"), self.folder)
        names = {row["model"] for row in report.results["scores"]}
        self.assertEqual(names, {"energy detector.intent", "energy detector", "constant relax"})
