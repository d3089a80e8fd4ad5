"""The recording as notifications, and when each of them is due."""

from dataclasses import dataclass
from pathlib import Path

# A notification carries two samples of eight channels, one signed byte each.
NOTIFICATION_BYTES = 16
# 200 Hz in pairs.
INTERVAL = 0.01
# After the machine stalled, no more than this many come at once; the rest of the recording is late
# instead. A burst beyond it would overrun queues that a real armband, with its few buffers, cannot.
CATCH_UP = 12


class Recording:
    """Raw samples, 8 bytes each, two to a notification; an odd last sample is left out."""

    def __init__(self, samples: bytes) -> None:
        self._samples = samples

    @classmethod
    def read(cls, path: Path) -> "Recording":
        return cls(path.read_bytes())

    def __len__(self) -> int:
        """Notifications in it."""
        return len(self._samples) // NOTIFICATION_BYTES

    def notification(self, n: int) -> bytes:
        return self._samples[n * NOTIFICATION_BYTES : (n + 1) * NOTIFICATION_BYTES]


@dataclass
class Schedule:
    """Due times of notifications. Time is an argument, in seconds."""

    interval: float
    due: float
    # Delay that the script asked for: what it holds back is owed, however much it is.
    owed: float = 0.0

    @classmethod
    def starting(cls, now: float, pace: float) -> "Schedule":
        return cls(INTERVAL / pace, now + INTERVAL / pace)

    def hold_back(self, seconds: float) -> None:
        self.owed += seconds

    def next(self, now: float) -> float:
        """How long to wait for the next notification, 0 or more; counts it as sent then."""
        late = now - self.due
        if late <= 0:
            self.owed = 0.0
        allowed = (CATCH_UP - 1) * self.interval + self.owed
        if late > allowed:
            self.due = now - allowed
        wait = max(0.0, self.due - now)
        self.due += self.interval
        return wait
