"""The program without training and downloads, as README's first command builds it: what is missing is said."""

import os
import subprocess
import unittest

from support import program


def refused(line):
    """What a command says that fails."""
    command = [os.environ["MYOINTENT"], *line.split()]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1, f"{line}: {done.returncode}\n{done.stderr}"
    return done.stderr


class ProgramTest(unittest.TestCase):
    def test_commands_of_training_say_what_to_build(self):
        for line in [
            "train --preset cpu --run runs/mine",
            "quickstart",
            "personalize --model a.intent --data mine --help",
            "evaluate --model a.intent",
        ]:
            with self.subTest(line):
                self.assertIn("built without training; `cargo run --release --", refused(line))

    def test_data_sets_are_listed_and_a_download_says_what_to_build(self):
        self.assertIn(b"ss-stm", program("data", "fetch"))
        for words in ["ss-stm", "ss-stm --to recordings", "--archive a.zip myoup"]:
            with self.subTest(words):
                self.assertIn(f"--features fetch -- data fetch {words}", refused(f"data fetch {words}"))
