"""The log of events, one JSON object a line, flushed at once so that a test can follow it."""

import json
import time
from typing import Any, TextIO


class EventLog:
    """Lines `{"t": seconds since the start, "event": name, ...}`; also kept for tests."""

    def __init__(self, file: TextIO | None = None) -> None:
        self._file = file
        self._start = time.monotonic()
        self.lines: list[dict[str, Any]] = []

    def write(self, event: str, **fields: Any) -> None:
        line = {"t": round(time.monotonic() - self._start, 6), "event": event, **fields}
        self.lines.append(line)
        if self._file is not None:
            self._file.write(json.dumps(line) + "\n")
            self._file.flush()

    def beside(self, prefix: str) -> "EventLog":
        """A log in the same file, whose events have names with this prefix."""
        return _Prefixed(self, prefix)

    def named(self, event: str) -> list[dict[str, Any]]:
        """The lines of one event."""
        return [line for line in self.lines if line["event"] == event]


class _Prefixed(EventLog):
    def __init__(self, log: EventLog, prefix: str) -> None:
        super().__init__()
        self._log = log
        self._prefix = prefix

    def write(self, event: str, **fields: Any) -> None:
        self._log.write(self._prefix + event, **fields)
