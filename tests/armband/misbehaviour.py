"""What the armband does wrong, and when: a script, which is a JSON list of steps.

    {"do": "drop", "at": 100, "count": 3}        notifications 100, 101, 102 are never sent
    {"do": "duplicate", "at": 100}               100 is sent twice
    {"do": "swap", "at": 100}                    101 is sent before 100
    {"do": "corrupt", "at": 100, "kind": KIND}   instead of 100 is sent
         "short"    its first 9 bytes
         "long"     its 16 bytes and 4 more
         "foreign"  its bytes, on a characteristic without subscription
         "garbage"  bytes that are no PDU of the attribute protocol
         "cut"      a PDU of the attribute protocol that ends too early: those of CUT in turn
         "signal"   a command on the channel of signals that nobody may obey: those of SIGNALS in turn
    {"do": "delay", "at": 100, "ms": 80}         100 is sent 80 ms late, with all due by then
    {"do": "vanish", "at": 100, "for_ms": 500}   before 100 the link is lost (supervision timeout);
                                                 no advertising for 500 ms; then 100 is the next
    {"do": "sleep", "at": 100, "for_ms": 500}    the same, but the armband ends the connection
         with "refuse": 2 either closes the next two connections at once
    {"do": "battery", "at": 100, "percent": 5}   the battery level falls; subscribers are notified
    {"do": "refuse", "count": 2}                 the first two connections are closed at once
    {"do": "chatter", "ms": 5}                   from every connection to its stream, a notification without
                                                 subscription every 5 ms
    {"do": "ask-parameters"}                     on every connection it asks for other connection parameters
         with "first_ms": 5000, "every_ms": 30000 and "times": 3 unless others are given, and ends the
         connection, `every_ms` after the last, if one was not answered
    {"do": "begin-late", "ms": 3000}             EMG begins 3 s after the command that sets the mode
    {"do": "hide-subscriptions"}                 the descriptors that enable notifications cannot be read

`at` counts the notifications of the recording from 0, sent or not, over all connections.
Milliseconds are real time.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bumble.att import ATT_CID
from bumble.l2cap import L2CAP_LE_SIGNALING_CID

from gatt_table import EMG_DATA, FV_DATA

CORRUPTIONS = ("short", "long", "foreign", "garbage", "cut", "signal")

# Fields of each step and their defaults; None: the field is required.
_FIELDS: dict[str, dict[str, Any]] = {
    "drop": {"at": None, "count": 1},
    "duplicate": {"at": None},
    "swap": {"at": None},
    "corrupt": {"at": None, "kind": None},
    "delay": {"at": None, "ms": None},
    "vanish": {"at": None, "for_ms": None, "refuse": 0},
    "sleep": {"at": None, "for_ms": 1000, "refuse": 0},
    "battery": {"at": None, "percent": None},
    "refuse": {"count": None},
    "chatter": {"ms": None},
    "ask-parameters": {"first_ms": 5000, "every_ms": 30000, "times": 3},
    "begin-late": {"ms": None},
    "hide-subscriptions": {},
}
# Steps that change packets; the others are actions of the armband.
_IMPAIRMENTS = ("drop", "duplicate", "swap", "corrupt")
# Steps that hold for the whole run.
_HABITS = ("refuse", "chatter", "ask-parameters", "begin-late", "hide-subscriptions")


class ScriptError(ValueError):
    """A script that the armband cannot carry out."""


@dataclass(frozen=True)
class Step:
    do: str
    fields: dict[str, Any]

    @classmethod
    def parse(cls, entry: Any) -> "Step":
        if not isinstance(entry, dict) or entry.get("do") not in _FIELDS:
            known = ", ".join(_FIELDS)
            raise ScriptError(f"{entry!r}: expected an object with `do` one of {known}")
        do, known = entry["do"], _FIELDS[entry["do"]]
        given = {key: value for key, value in entry.items() if key != "do"}
        if unknown := given.keys() - known.keys():
            raise ScriptError(f"{entry!r}: `{do}` has no {', '.join(sorted(unknown))}")
        fields = known | given
        if missing := [key for key, value in fields.items() if value is None]:
            raise ScriptError(f"{entry!r}: `{do}` needs {', '.join(missing)}")
        for key, value in fields.items():
            if key == "kind":
                if value not in CORRUPTIONS:
                    raise ScriptError(f"{entry!r}: kind is one of {', '.join(CORRUPTIONS)}")
            elif type(value) is not int or value < 0:
                raise ScriptError(f"{entry!r}: {key} is a whole number, 0 or more")
        return cls(do, fields)


class Script:
    """The steps of one run. Each is carried out once."""

    def __init__(self, entries: Any = ()) -> None:
        if not isinstance(entries, (list, tuple)):
            raise ScriptError("expected a list of steps")
        steps = [Step.parse(entry) for entry in entries]
        self.refusals = sum(step.fields["count"] for step in steps if step.do == "refuse")
        habits = {step.do: step.fields for step in steps if step.do in _HABITS}
        self.chatter_ms = habits["chatter"]["ms"] if "chatter" in habits else None
        self.asks = habits.get("ask-parameters")
        self.begins_after_ms = habits["begin-late"]["ms"] if "begin-late" in habits else 0
        self.hides_subscriptions = "hide-subscriptions" in habits
        others = (*_IMPAIRMENTS, *_HABITS)
        self._actions = [step for step in steps if step.do not in others]
        self._impairments: dict[int, Step] = {}
        for step in (step for step in steps if step.do in _IMPAIRMENTS):
            first = step.fields["at"]
            for n in range(first, first + step.fields.get("count", 1)):
                self._impairments[n] = step

    @classmethod
    def read(cls, path: Path) -> "Script":
        return cls(json.loads(path.read_text()))

    def take_action(self, n: int) -> Step | None:
        """The next action before notification `n`."""
        for step in self._actions:
            if step.fields["at"] == n:
                self._actions.remove(step)
                return step
        return None

    def impairment(self, n: int) -> Step | None:
        """The step that changes notification `n`."""
        return self._impairments.get(n)


@dataclass(frozen=True)
class Packet:
    """A value notified on a characteristic; with none, a bare PDU of an L2CAP channel."""

    characteristic: int | None
    value: bytes
    channel: int = ATT_CID


# Opcode 0x7F with the command flag: a receiver must ignore it.
GARBAGE = Packet(None, bytes.fromhex("7fdeadbeef0123456789abcdef00ff55aa"))

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


@dataclass
class Impairer:
    """Turns each notification into the packets that are sent for it, by the script."""

    script: Script
    _held: list[Packet] = field(default_factory=list)

    def packets(self, n: int, lane: int, value: bytes) -> list[Packet]:
        packet = Packet(EMG_DATA[lane], value)
        step = self.script.impairment(n)
        match step.do if step else "send":
            case "drop":
                sent = []
            case "duplicate":
                sent = [packet, packet]
            case "swap":
                self._held.append(packet)
                return []
            case "corrupt":
                sent = [_corrupted(n, packet, step.fields["kind"])]
            case _:
                sent = [packet]
        held, self._held = self._held, []
        return sent + held

    def reset(self) -> None:
        """Discards what a swap holds back, at the end of a link."""
        self._held = []


def _corrupted(n: int, packet: Packet, kind: str) -> Packet:
    match kind:
        case "short":
            return Packet(packet.characteristic, packet.value[:9])
        case "long":
            return Packet(packet.characteristic, packet.value + bytes.fromhex("deadbeef"))
        case "foreign":
            return Packet(FV_DATA, packet.value)
        case "cut":
            return Packet(None, CUT[n % len(CUT)])
        case "signal":
            return Packet(None, SIGNALS[n % len(SIGNALS)], L2CAP_LE_SIGNALING_CID)
        case _:
            return GARBAGE
