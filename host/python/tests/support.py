"""Models, recordings and the program for the tests."""

import os
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
MODEL = ROOT / "models/three-class.intent"
EXAMPLES = ROOT / "host/python/examples"


def skip(name, reason):
    """Books a test as skipped; with MYOINTENT_REQUIRE=all it fails."""
    if os.environ.get("MYOINTENT_REQUIRE") == "all":
        raise AssertionError(f"{name} needs what is missing, and MYOINTENT_REQUIRE=all: {reason}")
    print(f"\nSKIPPED {name}: {reason}", file=sys.stderr)
    raise unittest.SkipTest(reason)


def data(name):
    """Folder of recordings."""
    folder = Path(os.environ.get("MYOINTENT_DATA", ROOT.parent / "shared/data"))
    return folder if folder.is_dir() else skip(name, f"no folder {folder} (MYOINTENT_DATA)")


def ended(code, arguments):
    """Run of the program `myointent` that ends with this exit code."""
    command = [os.environ["MYOINTENT"], *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, check=False)
    assert done.returncode == code, f"{done.returncode}: {done.stderr.decode()}"
    return done


def program(*arguments):
    """Output of the program, byte for byte."""
    return ended(0, arguments).stdout


def refused(line, code=1):
    """Error of a command line that ends with this exit code."""
    return ended(code, line.split()).stderr.decode()


def synthetic(folder):
    """Writes synthetic recordings of three people to a folder."""
    program("data", "synth", "--out", folder, "--subjects", 3, "--recordings", 1, "--seconds", 30)
    return folder
