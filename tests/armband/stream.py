"""The recording as notifications, and the time at which each is due."""

import asyncio
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

# A notification carries two samples of eight channels, one signed byte each.
NOTIFICATION_BYTES = 16
# 200 Hz in pairs.
INTERVAL = 0.01
# After a stall of the host at most this many are sent at once; the rest of the recording is late. A
# longer burst would overrun queues, which a real armband with its few buffers cannot do.
CATCH_UP = 12
# Seconds between two looks at a recording that grows.
GROWTH_POLL = 0.002


class Recording:
    """Raw samples, 8 bytes each, two to a notification; an odd last sample is left out."""

    def __init__(self, samples: bytes) -> None:
        self._samples = samples

    @classmethod
    def read(cls, path: Path) -> "Recording":
        return cls(path.read_bytes())

    async def has(self, n: int) -> bool:
        """Whether there is such a notification."""
        return (n + 1) * NOTIFICATION_BYTES <= len(self._samples)

    def notification(self, n: int) -> bytes:
        return self._samples[n * NOTIFICATION_BYTES : (n + 1) * NOTIFICATION_BYTES]


class GrowingRecording(Recording):
    """A file that somebody appends to while it is streamed. It has no end."""

    def __init__(self, file: BinaryIO) -> None:
        super().__init__(b"")
        self._file = file

    @classmethod
    def read(cls, path: Path) -> "GrowingRecording":
        return cls(path.open("rb"))

    async def has(self, n: int) -> bool:
        """Waits for it."""
        while True:
            self._samples += self._file.read()
            if await super().has(n):
                return True
            await asyncio.sleep(GROWTH_POLL)


@dataclass
class Schedule:
    """Due times of notifications. Time is an argument, in seconds."""

    interval: float
    due: float

    @classmethod
    def starting(cls, now: float, pace: float) -> "Schedule":
        return cls(INTERVAL / pace, now + INTERVAL / pace)

    def next(self, now: float) -> float:
        """Seconds to wait for the next notification, 0 or more; it counts as sent then."""
        self.due = max(self.due, now - (CATCH_UP - 1) * self.interval)
        wait = max(0.0, self.due - now)
        self.due += self.interval
        return wait
