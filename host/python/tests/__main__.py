"""All tests; the last line is in the form of `cargo test`."""

import signal
import sys
import unittest
from pathlib import Path

LIMIT_S = 300


class Limited(unittest.TextTestResult):
    """Ends a test that hangs, as a failure with its name; its clean-up and the other tests still run."""

    def startTest(self, test):
        def end(*_):
            raise TimeoutError(f"{test.id()}: no end after {LIMIT_S} s")

        signal.signal(signal.SIGALRM, end)
        signal.alarm(LIMIT_S)
        super().startTest(test)

    def stopTest(self, test):
        signal.alarm(0)
        super().stopTest(test)


folder = Path(__file__).resolve().parent
sys.path.insert(0, str(folder))
result = unittest.TextTestRunner(verbosity=2, resultclass=Limited).run(
    unittest.defaultTestLoader.discover(str(folder))
)
failed, skipped = len(result.failures) + len(result.errors), len(result.skipped)
passed = result.testsRun - failed - skipped
verdict = "FAILED" if failed else "ok"
print(f"test result: {verdict}. {passed} passed; {failed} failed; 0 ignored")
sys.exit(failed > 0)
