"""The program itself, over the socket that the firmware on a PC uses."""

import asyncio
import json
import sys
import tempfile
import unittest
from pathlib import Path

from bumble.host import Host
from bumble.transport import open_transport

from central import Central, until

ADDRESS = "FA:12:34:56:78:9A"
NOTIFICATIONS = 600


class ProcessTest(unittest.IsolatedAsyncioTestCase):
    async def asyncSetUp(self) -> None:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        recording, self.log, path = folder / "r.i8", folder / "log.jsonl", folder / "hci"
        recording.write_bytes(b"".join(n.to_bytes(4, "little") * 4 for n in range(NOTIFICATIONS)))
        self.process = await asyncio.create_subprocess_exec(
            sys.executable, str(Path(__file__).parent), "--hci", f"unix-server:{path}",
            "--recording", str(recording), "--log", str(self.log), "--pace", "5",
        )
        await until(lambda: self.events("ready"), "the program to be ready")
        self.transport = await open_transport(f"unix-client:{path}")
        self.central = Central(Host(self.transport.source, self.transport.sink))

    async def asyncTearDown(self) -> None:
        await self.transport.close()
        self.process.kill()
        await self.process.wait()

    def events(self, name: str) -> list[dict]:
        if not self.log.exists():
            return []
        lines = [json.loads(line) for line in self.log.read_text().splitlines()]
        return [line for line in lines if line["event"] == name]

    async def test_a_reader_that_stalls_loses_nothing_and_is_not_flooded(self):
        await self.central.start(ADDRESS)
        await until(lambda: len(self.central.received) > 50, "a stream")
        self.transport.sink.transport.pause_reading()
        # Longer than the recording.
        await asyncio.sleep(2.0)
        self.assertEqual(self.events("end"), [])
        self.transport.sink.transport.resume_reading()
        await until(lambda: len(self.central.received) == NOTIFICATIONS, "the whole recording")
        got = [int.from_bytes(value[:4], "little") for _, value in self.central.received]
        self.assertEqual(got, [*range(NOTIFICATIONS)])
        self.assertEqual(self.events("error"), [])


if __name__ == "__main__":
    unittest.main()
