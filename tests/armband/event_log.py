"""The log of events, one JSON object a line, flushed at once so that a test can follow it."""

import copy
import json
import time
from typing import Any, TextIO


class EventLog:
    """Lines `{"t": seconds since the start, "event": name, ...}`; also kept for tests."""

    def __init__(self, file: TextIO | None = None) -> None:
        self._file = file
        self._prefix = ""
        self._start = time.monotonic()
        self.lines: list[dict[str, Any]] = []

    def write(self, event: str, **fields: Any) -> None:
        event = self._prefix + event
        line = {"t": round(time.monotonic() - self._start, 6), "event": event, **fields}
        self.lines.append(line)
        if self._file is not None:
            self._file.write(json.dumps(line) + "\n")
            self._file.flush()

    def beside(self, prefix: str) -> "EventLog":
        """A log of the same lines, whose events have names with this prefix."""
        other = copy.copy(self)
        other._prefix = prefix
        return other

    def named(self, event: str) -> list[dict[str, Any]]:
        """The lines of one event."""
        return [line for line in self.lines if line["event"] == event]
