"""The virtual armband against a central of Bumble's own: its rules, and what a board would not show if it were missing.

python -m unittest discover -s tests/armband
"""

import asyncio
import unittest

from bumble import att

from armband import Armband, Options, advertisement
from central import EMG_FILTERED, NEVER_SLEEP, Central, until
from event_log import EventLog
from gatt_table import BATTERY_LEVEL, COMMAND, EMG_DATA
from misbehaviour import Script
from radio import Radio
from stream import Recording

ADDRESS = "FA:12:34:56:78:9A"


def value(n: int) -> bytes:
    """The samples of notification `n`, which contain its number."""
    return n.to_bytes(4, "little") * 4


def samples(count: int) -> Recording:
    return Recording(b"".join(value(n) for n in range(count)))


class ArmbandTest(unittest.IsolatedAsyncioTestCase):
    async def start_armband(self, count: int = 100, script=()) -> Central:
        """Starts an armband with `count` notifications at 20 times 200 Hz; returns a central."""
        radio = Radio(ADDRESS)
        self.log = EventLog()
        self.errors = []
        options = Options(pace=20.0, script=Script(script))
        await Armband(radio, samples(count), options, self.log).start()
        return Central.of(radio)

    async def found(self) -> Central:
        """A central that has found the armband's characteristics."""
        central = await self.start_armband()
        await central.connect(ADDRESS)
        await central.discover()
        return central

    async def until(self, event: str, times: int = 1) -> None:
        await until(lambda: len(self.log.named(event)) >= times, f"{event} number {times}")

    async def asyncTearDown(self) -> None:
        self.assertEqual(self.log.named("error"), self.errors)


class RulesOfTheProtocol(ArmbandTest):
    async def test_handles_and_advertisement_are_those_of_a_real_armband(self):
        uuid = "42 48 12 4a 7f 2c 48 47 b9 de 04 a9 01 00 06 d5"
        captured = "09 08 4d 79 6f 00 00 00 00 00 02 01 06 11 06" + uuid
        self.assertEqual(advertisement(), bytes.fromhex(captured))
        central = await self.found()
        self.assertEqual(central.find(COMMAND).handle, 0x19)
        self.assertEqual(central.find(BATTERY_LEVEL).handle, 0x11)
        handles = [central.find(short).handle for short in EMG_DATA]
        self.assertEqual(handles, [0x2B, 0x2E, 0x31, 0x34])
        self.assertEqual(central.connection.att_mtu, 23)

    async def test_nothing_comes_before_the_mode_is_set_nor_on_a_lane_without_subscription(self):
        central = await self.found()
        await central.subscribe(lanes=(0, 2))
        await central.command(NEVER_SLEEP)
        await asyncio.sleep(0.1)
        self.assertEqual(central.received, [])
        await central.command(EMG_FILTERED)
        await self.until("end")
        await until(lambda: len(central.received) == 50, "half of the data")
        self.assertEqual({lane for lane, _ in central.received}, {0, 2})

    async def test_a_write_command_does_nothing_and_is_an_error(self):
        central = await self.found()
        await central.subscribe()
        await central.command(EMG_FILTERED, with_response=False)
        await self.until("error")
        await asyncio.sleep(0.05)
        self.assertEqual((central.received, self.log.named("mode")), ([], []))
        self.errors = self.log.named("error")
        self.assertIn("0x0019", self.errors[0]["reason"])

    async def test_a_command_that_is_refused_is_an_error(self):
        central = await self.found()
        await central.command(bytes.fromhex("0400"))
        self.errors = self.log.named("error")
        self.assertEqual(len(self.errors), 1)

    async def test_the_recording_goes_on_where_a_connection_ended_and_subscriptions_are_made_anew(self):
        central = await self.start_armband(1000)
        await central.start(ADDRESS)
        await until(lambda: len(central.received) > 10, "a stream")
        await central.connection.disconnect()
        await self.until("advertising", 2)
        before = len(central.received)
        await central.connect(ADDRESS)
        await central.discover()
        await asyncio.sleep(0.1)
        self.assertEqual(len(central.received), before)
        await central.subscribe()
        await central.command(EMG_FILTERED)
        await until(lambda: len(central.received) > before, "a stream")
        got = [int.from_bytes(value[:4], "little") for _, value in central.received]
        self.assertEqual(got, sorted(set(got)))


class Habits(ArmbandTest):
    async def test_it_ends_a_connection_in_which_it_asked_in_vain(self):
        ask = {"do": "ask-parameters", "first_ms": 20, "every_ms": 20}
        central = await self.start_armband(script=[ask])
        central.device.l2cap_channel_manager.on_control_frame = lambda *_: None
        await central.connect(ADDRESS)
        await self.until("unanswered")
        self.assertEqual(len(self.log.named("asked")), 3)
        await until(lambda: central.disconnections, "the end")

    async def test_it_begins_late(self):
        central = await self.start_armband(script=[{"do": "begin-late", "ms": 300}])
        await central.start(ADDRESS)
        await asyncio.sleep(0.15)
        self.assertEqual(central.received, [])
        await self.until("end")

    async def test_its_subscriptions_can_be_written_and_not_read(self):
        central = await self.start_armband(script=[{"do": "hide-subscriptions"}])
        await central.connect(ADDRESS)
        client = central.connection.gatt_client
        with self.assertRaises(att.ATT_Error):
            await client.read_value(0x2C)
        await client.write_value(0x2C, b"\1\0", with_response=True)
        self.assertEqual(len(self.log.named("subscribed")), 1)


class AnotherArmband(ArmbandTest):
    async def test_each_armband_is_heard_with_its_own_strength_and_logged_by_its_own_name(self):
        radio = Radio(ADDRESS)
        self.log, self.errors = EventLog(), []
        another = "FA:00:00:00:00:01"
        beside = radio.beside(another, -70)
        await Armband(radio, samples(1), Options(), self.log).start()
        others = self.log.beside("stranger-")
        await Armband(beside, samples(1), Options(), others).start()
        central = Central.of(radio)
        heard = {}
        await central.device.power_on()
        central.device.on(
            "advertisement",
            lambda report: heard.update({report.address.to_string(False): report.rssi}),
        )
        await central.device.start_scanning(legacy=True, active=False)
        await until(lambda: len(heard) == 2, "two armbands")
        self.assertEqual(heard, {ADDRESS: -50, another: -70})
        await central.device.stop_scanning(legacy=True)
        await central.connect(another)
        await self.until("stranger-connected")
        self.assertEqual(self.log.named("connected"), [])

if __name__ == "__main__":
    unittest.main()
