"""The wheel: its size, its types, its documentation."""

import inspect
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import myointent


class PackageTest(unittest.TestCase):
    def test_the_wheel_is_small(self):
        wheel = Path(os.environ["MYOINTENT_WHEEL"])
        size = wheel.stat().st_size
        print(f"\n{wheel.name}: {size / 1e6:.2f} MB")
        self.assertLess(size, 5e6)

    def test_the_types_are_those_of_the_package(self):
        command = [sys.executable, "-m", "mypy.stubtest", "myointent"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_everything_public_is_documented(self):
        for name in myointent.__all__:
            own = getattr(myointent, name)
            members = vars(own).items() if inspect.isclass(own) else []
            public = [value for key, value in members if not key.startswith("_")]
            for value in [own, *public]:
                self.assertTrue(inspect.getdoc(value), f"{name}: {value}")

    def test_a_numpy_that_does_not_work_is_told_at_the_import(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "numpy.py").write_text("raise ImportError('libgfortran is missing')")
            command = [sys.executable, "-c", "import myointent"]
            environment = {**os.environ, "PYTHONPATH": folder}
            done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("ImportError: libgfortran is missing", done.stderr)
