"""A virtual Myo armband behind a virtual Bluetooth controller: python tests/armband --help"""

import argparse
import asyncio
import json
from pathlib import Path

from bumble.transport import open_transport

from armband import Armband, Options
from event_log import EventLog
from misbehaviour import Script
from radio import Radio
from stream import GrowingRecording, Recording

# A public address, as an armband has.
ADDRESS = "FA:12:34:56:78:9A"


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
    parser.add_argument("--pace", type=float, default=1.0, help="times real time (default 1)")
    parser.add_argument("--stranger", type=stranger, metavar="ADDRESS,DBM",
                        help="another armband with this signal strength; the armband's own is -50. "
                             "Its events have names that begin with `stranger-`")
    parser.add_argument("--disconnect", action="store_true",
                        help="after the recording's last sample it ends the connection and is gone; "
                             "otherwise it stays silent")
    return parser.parse_args()


def stranger(text: str) -> tuple[str, int]:
    address, dbm = text.split(",")
    return address, int(dbm)


async def run(chosen: argparse.Namespace) -> None:
    script = Script(json.loads(chosen.script.read_text())) if chosen.script else Script()
    options = Options(pace=chosen.pace, disconnects=chosen.disconnect, script=script)
    with chosen.log.open("w") as file:
        log = EventLog(file)
        radio = Radio(ADDRESS)
        kind = GrowingRecording if chosen.follow else Recording
        await Armband(radio, kind.read(chosen.recording), options, log).start()
        if chosen.stranger:
            beside = radio.beside(*chosen.stranger)
            recording = Recording.read(chosen.recording)
            others = log.beside("stranger-")
            await Armband(beside, recording, Options(pace=chosen.pace), others).start()
        async with await open_transport(chosen.hci) as transport:
            radio.serve(transport)
            log.write("ready")
            # Until it is killed.
            await asyncio.Event().wait()


if __name__ == "__main__":
    asyncio.run(run(arguments()))
