"""The program without training and downloads, as README's first command builds it: what is missing is said."""

import unittest

from support import program, refused

WITHOUT_TRAINING = (
    "this program was built without training; "
    "`cargo run --release -- COMMAND` builds and runs all of it"
)


class ProgramTest(unittest.TestCase):
    def test_commands_of_training_say_what_to_build(self):
        for line in [
            "train --preset cpu --run runs/mine",
            "quickstart",
            "personalize --model a.intent --data mine --help",
            "evaluate --model a.intent",
        ]:
            with self.subTest(line):
                self.assertIn(WITHOUT_TRAINING, refused(line))

    def test_data_sets_are_listed_and_a_download_says_what_to_build(self):
        self.assertIn(b"ss-stm", program("data", "fetch"))
        for words in ["ss-stm", "ss-stm --to recordings", "--archive a.zip myoup"]:
            with self.subTest(words):
                said = refused(f"data fetch {words}").rstrip()
                self.assertTrue(said.endswith(f"--features fetch -- data fetch {words}"), said)
