"""What the armband does wrong, and when: a JSON list of steps.

    {"do": "drop", "at": 100, "count": 3}        notifications 100, 101, 102 are never sent
    {"do": "duplicate", "at": 100}               100 is sent twice
    {"do": "swap", "at": 100}                    101 is sent before 100
    {"do": "corrupt", "at": 100, "kind": KIND}   in place of 100 comes
         "short"    its first 9 bytes
         "long"     its 16 bytes and 4 more
         "foreign"  its bytes, on a characteristic that nobody subscribed to
         "garbage"  bytes that are no attribute protocol
    {"do": "delay", "at": 100, "ms": 80}         100 comes 80 ms late, all that fell due with it
    {"do": "vanish", "at": 100, "for_ms": 500}   before 100 the link is lost (supervision timeout);
                                                 no advertising for 500 ms; then 100 is next
    {"do": "sleep", "at": 100, "for_ms": 500}    the same, but the armband ends the connection
    {"do": "battery", "at": 100, "percent": 5}   the battery sinks; subscribers are notified
    {"do": "refuse", "count": 2}                 the first two connections are dropped at once

`at` counts the notifications of the recording from 0, sent or not, over all connections.
Milliseconds are the wall clock's.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gatt_table import EMG_DATA, FV_DATA

CORRUPTIONS = ("short", "long", "foreign", "garbage")

# Fields of each step and their defaults; None: it must be given.
_FIELDS: dict[str, dict[str, Any]] = {
    "drop": {"at": None, "count": 1},
    "duplicate": {"at": None},
    "swap": {"at": None},
    "corrupt": {"at": None, "kind": None},
    "delay": {"at": None, "ms": None},
    "vanish": {"at": None, "for_ms": None},
    "sleep": {"at": None, "for_ms": 1000},
    "battery": {"at": None, "percent": None},
    "refuse": {"count": None},
}
# Those that change the bytes; the others are acts of the armband.
_SHAPING = ("drop", "duplicate", "swap", "corrupt")


class ScriptError(ValueError):
    """A script that says nothing the armband can do."""


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
    """The steps of one run. Each is taken once."""

    def __init__(self, entries: Any = ()) -> None:
        if not isinstance(entries, (list, tuple)):
            raise ScriptError("expected a list of steps")
        steps = [Step.parse(entry) for entry in entries]
        self.refusals = sum(step.fields["count"] for step in steps if step.do == "refuse")
        self._acts = [step for step in steps if step.do not in (*_SHAPING, "refuse")]
        self._shapes: dict[int, Step] = {}
        for step in (step for step in steps if step.do in _SHAPING):
            first = step.fields["at"]
            for n in range(first, first + step.fields.get("count", 1)):
                self._shapes[n] = step

    @classmethod
    def read(cls, path: Path) -> "Script":
        return cls(json.loads(path.read_text()))

    def take_act(self, n: int) -> Step | None:
        """The next thing to do before notification `n`."""
        for step in self._acts:
            if step.fields["at"] == n:
                self._acts.remove(step)
                return step
        return None

    def shape(self, n: int) -> Step | None:
        """What becomes of notification `n`."""
        return self._shapes.get(n)


@dataclass(frozen=True)
class Packet:
    """A value notified on a characteristic; with none, a bare attribute PDU."""

    characteristic: int | None
    value: bytes


# Opcode 0x7F with the command flag: a receiver has to ignore it.
GARBAGE = Packet(None, bytes.fromhex("7fdeadbeef0123456789abcdef00ff55aa"))


@dataclass
class Shaper:
    """Turns each notification into what goes on the air for it, after the script."""

    script: Script
    _held: list[Packet] = field(default_factory=list)

    def packets(self, n: int, lane: int, value: bytes) -> list[Packet]:
        packet = Packet(EMG_DATA[lane], value)
        step = self.script.shape(n)
        match step.do if step else "send":
            case "drop":
                sent = []
            case "duplicate":
                sent = [packet, packet]
            case "swap":
                self._held.append(packet)
                return []
            case "corrupt":
                sent = [_corrupted(packet, step.fields["kind"])]
            case _:
                sent = [packet]
        held, self._held = self._held, []
        return sent + held

    def forget(self) -> None:
        """The link is gone, and what was held back with it."""
        self._held = []


def _corrupted(packet: Packet, kind: str) -> Packet:
    match kind:
        case "short":
            return Packet(packet.characteristic, packet.value[:9])
        case "long":
            return Packet(packet.characteristic, packet.value + bytes.fromhex("deadbeef"))
        case "foreign":
            return Packet(FV_DATA, packet.value)
        case _:
            return GARBAGE
