"""All tests; the last line is in the form of `cargo test`."""

import sys
import unittest
from pathlib import Path

folder = Path(__file__).resolve().parent
sys.path.insert(0, str(folder))
result = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.discover(str(folder)))
failed, skipped = len(result.failures) + len(result.errors), len(result.skipped)
passed = result.testsRun - failed - skipped
verdict = "FAILED" if failed else "ok"
print(f"test result: {verdict}. {passed} passed; {failed} failed; 0 ignored")
sys.exit(failed > 0)
