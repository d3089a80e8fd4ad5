"""The program without training and downloads, as README's first command builds it: what is missing is said."""

import unittest

from support import refused

WITHOUT_TRAINING = (
    "this program was built without training; "
    "`cargo run --release -- COMMAND` builds and runs all of it"
)


class ProgramTest(unittest.TestCase):
    def test_commands_of_training_say_what_to_build(self):
        for line, code in [
            ("train --preset cpu --run runs/mine", 2),
            ("quickstart", 2),
            ("quantize", 2),
            ("export", 2),
            ("personalize --model a.intent --data mine --help", 2),
            ("evaluate --model a.intent", 1),
        ]:
            with self.subTest(line):
                self.assertIn(WITHOUT_TRAINING, refused(line, code))

    def test_a_download_says_what_to_build(self):
        for line in ["data fetch", "data fetch ss-stm --to recordings"]:
            with self.subTest(line):
                said = refused(line, 2).rstrip()
                self.assertTrue(said.endswith("--features fetch -- data fetch NAME"), said)
