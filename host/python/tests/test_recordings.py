"""Tests of the way from a folder of any layout to arrays and to the first table, and of the words of refusals."""

import contextlib
import io
import json
import os
import re
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np
from support import MODEL, ROOT, program, synthetic

import myointent

HEADER = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n"


def described(folder):
    """A folder of one's own layout: semicolons, words for labels, channels by letters."""
    with tempfile.TemporaryDirectory() as made:
        recordings = myointent.read(synthetic(made))
    for at, recording in enumerate(recordings):
        path = folder / f"P0{at}/take_1.txt"
        path.parent.mkdir(parents=True)
        rows = [
            ";".join([["rest", "paper", "fist"][label], *map(str, sample)])
            for label, sample in zip(recording.labels.tolist(), recording.emg.tolist())
        ]
        path.write_text("pose;a;b;c;d;e;f;g;h\n" + "\n".join(rows) + "\n")
    program("data", "describe", folder)
    return recordings


class RecordingsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_a_described_folder_gives_the_samples_labels_and_people(self):
        made = described(self.folder)
        with warnings.catch_warnings(record=True):
            read = myointent.read(self.folder)
        self.assertEqual([own.person for own in read], [f"own/P0{at}" for at in range(3)])
        for own, expected in zip(read, made):
            np.testing.assert_array_equal(own.emg, expected.emg)
            np.testing.assert_array_equal(own.labels, expected.labels)
            self.assertEqual((own.emg.dtype, own.labels.dtype), (np.int8, np.int8))
            self.assertTrue(own.emg.flags.c_contiguous)
        late = myointent.read(self.folder, label_lag="each-cue")
        self.assertTrue(any((a.labels != b.labels).any() for a, b in zip(read, late)))

    def test_movement_beside_a_recording_is_an_array_and_a_damaged_file_is_refused(self):
        for name in ("a", "b"):
            emg = np.random.default_rng(ord(name)).normal(size=(800, 8)) * 9
            rows = [",".join(str(value) for value in (0, *sample)) for sample in emg.astype(int).tolist()]
            (self.folder / f"{name}.csv").write_text(HEADER + "\n".join(rows) + "\n")
        head = "row,w,x,y,z,acceleration_x,acceleration_y,acceleration_z,turn_x,turn_y,turn_z\n"
        movement = self.folder / "b.imu"
        movement.write_text(head + "3,1,0,0,0,0,0,-1,2.5,0,0\n7,0.5,0,0,0,0,0,-1,0,0,0\n")
        with warnings.catch_warnings(record=True):
            still, moved = myointent.read(self.folder)
        self.assertIsNone(still.imu)
        self.assertEqual((moved.imu.shape, moved.imu.dtype), ((2, 11), np.float64))
        self.assertEqual(moved.imu[0].tolist(), [3, 1, 0, 0, 0, 0, 0, -1, 2.5, 0, 0])
        movement.write_text(head + "3,1\n")
        with self.assertRaisesRegex(myointent.Error, "b.imu, line 2"):
            moved.imu

    def test_the_five_lines_of_the_page_print_the_first_table(self):
        described(self.folder / "my-recordings")
        page = (ROOT / "docs/python.md").read_text()
        lines = re.search(r"```python\n(.*?)```", page, re.DOTALL)[1]
        self.assertLessEqual(len(lines.splitlines()), 5)
        os.symlink(ROOT / "models", self.folder / "models")
        printed, before = io.StringIO(), os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        with contextlib.redirect_stdout(printed), warnings.catch_warnings(record=True):
            exec(lines, {})
        for part in ["take_1: 30.0 s> 0.", "balanced", "all 3    three-class ", "own/P02 "]:
            self.assertIn(part, printed.getvalue())

    def test_other_movement_is_a_label_of_its_own(self):
        path = self.folder / "anna/anna_grasp.csv"
        path.parent.mkdir()
        row = ",1,-2,3,4,5,6,7,8\n"
        path.write_text(HEADER + f"0{row}" * 20 + f"-2{row}" * 10 + f"-1{row}" * 5)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            [own] = myointent.read(self.folder)
        self.assertEqual(own.labels.tolist(), [0] * 20 + [-2] * 10 + [-1] * 5)
        self.assertEqual(own.other_movement, [(20, 30, "other")])
        self.assertEqual(own.path, path.resolve())
        self.assertTrue(any("anna_grasp" in str(one.message) for one in told), told)

    def test_channels_of_a_published_set_are_those_of_the_program(self):
        path = self.folder / "EMG_S1/1_fist.npy"
        path.parent.mkdir()
        emg = np.random.default_rng(1).normal(size=(3000, 8)) * 9 * np.arange(1, 9)
        emg[1000:2000] *= 3
        np.save(path, emg.clip(-128, 127).astype(np.int8))
        turned, own = [myointent.read(path, as_recorded=flag)[0] for flag in [False, True]]
        np.testing.assert_array_equal(turned.emg, np.roll(own.emg, 2, axis=1))
        told = "channels turned by 2 places into the common frame of the models"
        self.assertEqual((told in turned.notes, told in own.notes), (True, False))
        for recording, flag in [(turned, []), (own, ["--as-recorded"])]:
            out = self.folder / f"labels{len(flag)}.npy"
            program("predict", "--model", MODEL, "--recording", path, "--out", out, *flag)
            labels = myointent.Model(MODEL).predict(recording.emg)[0]
            np.testing.assert_array_equal(np.load(out)[:, 0], labels)

    def test_refusals_have_the_programs_words(self):
        bad = self.folder / "12345-1/7.txt"
        bad.parent.mkdir()
        bad.write_text("1,2,3,4,5,6,7,8,0\n" * 30 + "1,2\n")
        text = self.folder / "model.intent"
        text.write_text("gt,emg_0\n0,1\n")
        model, emg = myointent.Model(MODEL), np.zeros((20, 8), np.int8)
        for call, words in [
            (lambda: myointent.read(bad, strict=True), r"7\.txt, line 31: expected 9"),
            (lambda: myointent.read(self.folder / "12345-1"), r"1 files are left out; the first:"),
            (lambda: myointent.read(self.folder / "nowhere"), r"cannot read .*nowhere: No such"),
            (lambda: myointent.Model(text), r"model\.intent: expected a model file .*found a table"),
            (lambda: myointent.read(self.folder, label_lag="some"), r"unknown variant `some`"),
            (lambda: model.predict(emg[:, :7]), r"expected an array of n x 8 .*found 20 x 7"),
            (lambda: model.predict(emg + 200.0), r"value 200 of row 0: expected a raw sample"),
            (lambda: myointent.Stream(model).push(emg[0]), r"found 8$"),
            (lambda: myointent.score([0, 9], [0, 0]), r"label 1: .*found .9."),
            (lambda: myointent.score([0, 0], ["relax", "fist"]), r"label 1: .*fist"),
            (lambda: myointent.score([0, 0], [0]), r"as many predicted labels as true ones"),
        ]:
            with self.assertRaisesRegex(myointent.Error, words):
                call()
        damaged = bytearray(MODEL.read_bytes())
        damaged[-40] ^= 1
        text.write_bytes(damaged)
        with self.assertRaisesRegex(myointent.Error, r"model\.intent is refused: .*checksum"):
            myointent.Model(text)

    def test_scores_are_those_of_the_program(self):
        rows = ["relax"] * 300 + ["open"] * 300 + ["point"] * 100 + ["relax"] * 300
        late = ["relax"] * 320 + ["open"] * 300 + ["relax"] * 380
        truth, prediction = self.folder / "truth.txt", self.folder / "prediction.txt"
        truth.write_text("\n".join(rows) + "\n")
        prediction.write_text("\n".join(late) + "\n")
        files = ["score", "--truth", truth, "--prediction", prediction, "--delay", 7]
        report = myointent.score(rows, late, delay=7)
        self.assertEqual(str(report).encode(), program(*files))
        self.assertEqual(report.results, json.loads(program(*files, "--json")))
        classes = np.array([{"relax": 0, "open": 1}[name] for name in late])
        again = myointent.score(rows, classes, delay=7)
        self.assertEqual(again.results, report.results)
        other = myointent.score(rows, late, emitted=late, buffer=60, strict=True)
        self.assertNotEqual(other.results["rule"], report.results["rule"])

    def test_an_evaluation_is_that_of_the_program(self):
        synthetic(self.folder / "data")
        page = self.folder / "page.html"
        report = myointent.evaluate(myointent.Model(MODEL), self.folder / "data", report=page)
        self.assertTrue(page.read_text().startswith("<!DOCTYPE html>"))
        files = ["evaluate", "--model", MODEL, "--data", self.folder / "data"]
        printed = program(*files, "--report", self.folder / "again.html").decode()
        for line in str(report).splitlines():
            self.assertIn(line, printed)
        self.assertEqual(report.results["models"][0]["name"], "three-class")
