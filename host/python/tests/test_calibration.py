"""Calibration against the program's `calibrate`."""

import tempfile
import unittest
from pathlib import Path

from support import MODEL, program, synthetic

import myointent


class CalibrationTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = synthetic(Path(folder.name, "data"))
        self.out = Path(folder.name, "own.intent")
        self.model = myointent.Model(MODEL)

    def test_the_file_is_that_of_the_program(self):
        person = myointent.read(self.folder)[0].person
        own = myointent.calibrate(self.model, self.folder, person=person)
        self.assertEqual(own.person, person)
        said = program(
            *["calibrate", "--model", MODEL, "--data", self.folder],
            *["--subject", person, "--out", self.out],
        ).decode()
        self.assertIn(f"{own.rounds} rounds", said)
        self.assertIn(f"{own.before:.3f} -> {own.after:.3f}", said)
        self.assertEqual(own.model.content, self.out.read_bytes())
        self.assertEqual(own.model.classes, self.model.classes)

    def test_it_must_be_clear_whose_holds_are_meant(self):
        for person in [None, "nobody"]:
            with self.assertRaisesRegex(myointent.Error, "name the person"):
                myointent.calibrate(self.model, self.folder, person=person)
