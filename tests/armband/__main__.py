"""A virtual Myo armband behind a virtual Bluetooth controller: python tests/armband --help"""

import argparse
import asyncio
from pathlib import Path

from bumble.transport import open_transport

from armband import Armband, Options
from event_log import EventLog
from misbehaviour import Script
from radio import Radio
from stream import GrowingRecording, Recording


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="armband", description=__doc__)
    parser.add_argument("--hci", required=True, metavar="TRANSPORT",
                        help="where the central's host finds its controller: unix-server:PATH")
    parser.add_argument("--recording", required=True, type=Path, metavar="FILE.i8",
                        help="raw samples, 8 signed bytes each, 200 a second")
    parser.add_argument("--follow", action="store_true",
                        help="the recording grows, and what is appended is streamed as it comes")
    parser.add_argument("--log", required=True, type=Path, metavar="FILE.jsonl",
                        help="log of events, a JSON object a line; the first is `ready`")
    parser.add_argument("--script", type=Path, metavar="FILE.json",
                        help="misbehaviour: see misbehaviour.py")
    parser.add_argument("--pace", type=positive, default=1.0,
                        help="times real time (default 1)")
    parser.add_argument("--battery", type=int, default=80, metavar="PERCENT")
    parser.add_argument("--firmware", type=version, default=(1, 5, 1970, 2), metavar="A.B.C.D")
    parser.add_argument("--address", default="FA:12:34:56:78:9A",
                        help="a public one, as an armband has")
    parser.add_argument("--stranger", type=stranger, metavar="ADDRESS,DBM",
                        help="another armband with this signal strength; the armband's own is -50. "
                             "Its events have names that begin with `stranger-`")
    parser.add_argument("--first-lane", type=int, choices=range(4), default=0,
                        help="EMG characteristic that starts a stream")
    parser.add_argument("--sleep-after", type=positive, default=30.0, metavar="SECONDS",
                        help="without the command never to sleep")
    parser.add_argument("--wake-after", type=positive, default=1.0, metavar="SECONDS")
    parser.add_argument("--end", choices=["silence", "disconnect", "exit"], default="silence",
                        help="what follows the recording's last sample")
    return parser.parse_args()


def positive(text: str) -> float:
    value = float(text)
    if value <= 0:
        raise argparse.ArgumentTypeError("expected more than 0")
    return value


def version(text: str) -> tuple[int, int, int, int]:
    parts = tuple(int(part) for part in text.split("."))
    if len(parts) != 4:
        raise argparse.ArgumentTypeError("expected four numbers, such as 1.5.1970.2")
    return parts


def stranger(text: str) -> tuple[str, int]:
    address, dbm = text.split(",")
    return address, int(dbm)


async def run(chosen: argparse.Namespace) -> None:
    options = Options(
        pace=chosen.pace,
        first_lane=chosen.first_lane,
        battery=chosen.battery,
        firmware=chosen.firmware,
        sleep_after=chosen.sleep_after,
        wake_after=chosen.wake_after,
        end=chosen.end,
        script=Script.read(chosen.script) if chosen.script else Script(),
    )
    with chosen.log.open("w") as file:
        log = EventLog(file)
        radio = Radio(chosen.address)
        kind = GrowingRecording if chosen.follow else Recording
        armband = Armband(radio, kind.read(chosen.recording), options, log)
        await armband.start()
        if chosen.stranger:
            address, rssi = chosen.stranger
            beside = radio.beside(address, rssi)
            others = Options(pace=chosen.pace, end="silence")
            recording = Recording.read(chosen.recording)
            other = Armband(beside, recording, others, log.beside("stranger-"))
            await other.start()
        async with await open_transport(chosen.hci) as transport:
            radio.serve(transport)
            log.write("ready")
            await armband.done.wait()


if __name__ == "__main__":
    asyncio.run(run(arguments()))
