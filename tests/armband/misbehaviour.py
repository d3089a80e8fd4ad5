"""What the armband does wrong, and when: a script, which is a JSON list of steps.

    {"do": "corrupt", "at": 100, "kind": KIND}   instead of notification 100 is sent
         "cut"      a PDU of the attribute protocol that ends too early: those of CUT in turn
         "signal"   a command on the channel of signals that nobody may obey: those of SIGNALS in turn
    {"do": "vanish", "at": 100, "for_ms": 500}   before 100 the link is lost (supervision timeout);
                                                 no advertising for 500 ms; then 100 is the next
    {"do": "sleep", "at": 100, "for_ms": 500}    the same, but the armband ends the connection
    {"do": "refuse", "count": 2}                 the first two connections are closed at once
    {"do": "chatter", "ms": 5}                   from every connection to its stream, a notification without
                                                 subscription every 5 ms
    {"do": "ask-parameters", "first_ms": 20, "every_ms": 30}
                                                 on every connection it asks for other connection parameters
         three times, and ends the connection, `every_ms` after the last, if one was not answered
    {"do": "begin-late", "ms": 3000}             EMG begins 3 s after the command that sets the mode
    {"do": "hide-subscriptions"}                 the descriptors that enable notifications cannot be read

`at` counts the notifications of the recording from 0, sent or not, over all connections.
Milliseconds are real time. Losses and other values: tests/virtual-armband.
"""

from dataclasses import dataclass
from typing import Any

from bumble.att import ATT_CID
from bumble.l2cap import L2CAP_LE_SIGNALING_CID

# Fields of each step, beside `do`.
_FIELDS: dict[str, set[str]] = {
    "corrupt": {"at", "kind"},
    "vanish": {"at", "for_ms"},
    "sleep": {"at", "for_ms"},
    "refuse": {"count"},
    "chatter": {"ms"},
    "ask-parameters": {"first_ms", "every_ms"},
    "begin-late": {"ms"},
    "hide-subscriptions": set(),
}

Step = dict[str, Any]


class ScriptError(ValueError):
    """A script that the armband cannot carry out."""


class Script:
    """The steps of one run."""

    def __init__(self, steps: list[Step] | tuple[Step, ...] = ()) -> None:
        for step in steps:
            fields = _FIELDS.get(step.get("do"))
            if fields is None or step.keys() != {"do"} | fields:
                raise ScriptError(f"{step!r}: expected `do` and its fields, of {_FIELDS}")
            if step.get("kind", "cut") not in ("cut", "signal"):
                raise ScriptError(f"{step!r}: expected the kind cut or signal")
        self._steps = list(steps)

    def habit(self, do: str) -> Step | None:
        """The step of this name, which holds for the whole run."""
        return next((step for step in self._steps if step["do"] == do), None)

    def take(self, n: int) -> Step | None:
        """The step for notification `n`, once."""
        found = next((step for step in self._steps if step.get("at") == n), None)
        if found:
            self._steps.remove(found)
        return found


@dataclass(frozen=True)
class Packet:
    """A value notified on a characteristic; with none, a bare PDU of an L2CAP channel."""

    characteristic: int | None
    value: bytes
    channel: int = ATT_CID


# Without the fields that they must have: no PDU at all, requests, a command, an error; and a group type of 16 bytes,
# which a host may take for longer than it is.
CUT = [
    b"",
    *(bytes([opcode]) for opcode in (0x02, 0x04, 0x06, 0x08, 0x0A, 0x0C, 0x10, 0x12, 0x16, 0x18, 0x52)),
    bytes.fromhex("01 0a 00 00"),
    bytes.fromhex("10 01 00 ff ff") + bytes(16),
]

# The request to disconnect channel 0, whose other end is channel 0, and another channel; for a channel of credits; a ping of
# the other kind of link; codes of no command; requests for connection parameters that are too short, too long, two at once.
SIGNALS = [
    bytes.fromhex(command)
    for command in (
        "06 01 04 00 00 00 00 00",
        "06 02 04 00 40 00 40 00",
        "14 03 0a 00 80 00 40 00 17 00 17 00 05 00",
        "08 04 00 00",
        "00 05 00 00",
        "ff 06 02 00 00 00",
        "12 07",
        "12 08 08 00 06 00",
        "12 09 09 00 06 00 0c 00 00 00 c8 00 00",
        "12 0a 08 00 06 00 0c 00 00 00 c8 00 12 0b 00 00",
    )
]


def corrupted(n: int, kind: str) -> Packet:
    """The packet that is sent instead of notification `n`."""
    if kind == "cut":
        return Packet(None, CUT[n % len(CUT)])
    return Packet(None, SIGNALS[n % len(SIGNALS)], L2CAP_LE_SIGNALING_CID)
