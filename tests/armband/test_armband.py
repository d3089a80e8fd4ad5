"""The virtual armband against a central of Bumble's own.

python -m unittest discover -s tests/armband
"""

import asyncio
import unittest

from bumble import att

from armband import Armband, Options, advertisement
from central import EMG_FILTERED, NEVER_SLEEP, Central, until
from event_log import EventLog
from gatt_table import BATTERY_LEVEL, COMMAND, EMG_DATA, IMU_DATA
from misbehaviour import Script
from radio import Radio
from stream import Recording, movement

ADDRESS = "FA:12:34:56:78:9A"


def value(n: int) -> bytes:
    """The samples of notification `n`, which contain its number."""
    return n.to_bytes(4, "little") * 4


def samples(count: int) -> Recording:
    return Recording(b"".join(value(n) for n in range(count)))


class ArmbandTest(unittest.IsolatedAsyncioTestCase):
    async def start_armband(self, count: int = 100, script=(), **options) -> Central:
        """Starts an armband with `count` notifications at 20 times 200 Hz; returns a central."""
        radio = Radio(ADDRESS)
        self.log = EventLog()
        options = {"pace": 20.0} | options
        self.armband = Armband(
            radio, samples(count), Options(script=Script(script), **options), self.log
        )
        await self.armband.start()
        return Central.of(radio)

    async def numbers(self, count: int = 100, script=(), **options) -> list[int]:
        """The notification numbers that a whole run delivers; -1 for other values."""
        central = await self.start_armband(count, script, **options)
        await central.start(ADDRESS)
        await self.until("end")
        await asyncio.sleep(0.02)
        return numbers(central)

    async def until(self, event: str, times: int = 1) -> None:
        await until(lambda: len(self.log.named(event)) >= times, f"{event} number {times}")

    async def asyncTearDown(self) -> None:
        self.assertEqual(self.log.named("error"), getattr(self, "errors", []))


def numbers(central: Central) -> list[int]:
    return [
        int.from_bytes(got[:4], "little") if got == value(int.from_bytes(got[:4], "little")) else -1
        for _, got in central.received
    ]


class RulesOfTheProtocol(ArmbandTest):
    async def test_a_thousand_notifications_arrive_in_order_on_four_lanes_in_turn(self):
        central = await self.start_armband(1000)
        await central.start(ADDRESS)
        await self.until("end")
        await until(lambda: len(central.received) == 1000, "1000 notifications")
        self.assertEqual(central.received, [(n % 4, value(n)) for n in range(1000)])

    async def test_handles_are_those_of_firmware_1(self):
        central = await self.start_armband()
        await central.connect(ADDRESS)
        await central.discover()
        self.assertEqual(central.find(COMMAND).handle, 0x19)
        self.assertEqual(central.find(BATTERY_LEVEL).handle, 0x11)
        handles = [central.find(short).handle for short in EMG_DATA]
        self.assertEqual(handles, [0x2B, 0x2E, 0x31, 0x34])
        self.assertEqual(central.connection.att_mtu, 23)

    async def test_battery_firmware_and_maker_can_be_read(self):
        central = await self.start_armband(battery=42)
        await central.connect(ADDRESS)
        await central.discover()
        self.assertEqual(await central.find(BATTERY_LEVEL).read_value(), b"\x2a")
        self.assertEqual(
            await central.find(0x0201).read_value(), bytes.fromhex("01000500b2070200")
        )
        self.assertEqual(await central.find(0x2A29).read_value(), b"Thalmic Labs")

    async def test_the_advertisement_is_the_captured_one(self):
        uuid = "42 48 12 4a 7f 2c 48 47 b9 de 04 a9 01 00 06 d5"
        captured = "09 08 4d 79 6f 00 00 00 00 00 02 01 06 11 06" + uuid
        self.assertEqual(advertisement(), bytes.fromhex(captured))
        self.log = EventLog()

    async def test_nothing_comes_before_the_mode_is_set(self):
        central = await self.start_armband()
        await central.connect(ADDRESS)
        await central.discover()
        await central.subscribe()
        await central.command(NEVER_SLEEP)
        await asyncio.sleep(0.1)
        self.assertEqual(central.received, [])
        await central.command(EMG_FILTERED)
        await until(lambda: central.received, "a notification")

    async def test_movement_comes_with_every_second_notification_where_the_mode_has_it_and_it_is_subscribed_to(self):
        for subscribes, mode in ((True, "0103020100"), (True, "0103020000"), (False, "0103020100")):
            central = await self.start_armband(100)
            await central.connect(ADDRESS)
            await central.discover()
            await central.subscribe()
            moved = []
            if subscribes:
                await central.find(IMU_DATA).subscribe(lambda value: moved.append(bytes(value)))
            await central.command(bytes.fromhex(mode))
            await self.until("end")
            await asyncio.sleep(0.02)
            self.assertEqual(len(central.received), 100)
            wanted = subscribes and mode == "0103020100"
            self.assertEqual(moved, [movement(n) for n in range(1, 100, 2)] if wanted else [])

    async def test_a_lane_without_subscription_is_silent(self):
        central = await self.start_armband()
        await central.connect(ADDRESS)
        await central.discover()
        await central.subscribe(lanes=(0, 2))
        await central.command(NEVER_SLEEP)
        await central.command(EMG_FILTERED)
        await self.until("end")
        await until(lambda: len(central.received) == 50, "half of the data")
        self.assertEqual({lane for lane, _ in central.received}, {0, 2})

    async def test_a_write_command_does_nothing_and_is_an_error(self):
        central = await self.start_armband()
        await central.connect(ADDRESS)
        await central.discover()
        await central.subscribe()
        await central.command(EMG_FILTERED, with_response=False)
        await self.until("error")
        await asyncio.sleep(0.05)
        self.assertEqual((central.received, self.log.named("mode")), ([], []))
        self.errors = self.log.named("error")
        self.assertIn("0x0019", self.errors[0]["reason"])

    async def test_a_stream_may_start_on_any_lane(self):
        central = await self.start_armband(8, first_lane=3)
        await central.start(ADDRESS)
        await until(lambda: len(central.received) == 8, "8 notifications")
        self.assertEqual([lane for lane, _ in central.received], [3, 0, 1, 2, 3, 0, 1, 2])

    async def test_unknown_and_dangerous_commands_are_errors(self):
        central = await self.start_armband()
        await central.connect(ADDRESS)
        await central.discover()
        for command in ("0400", "0103020000ff", "01020200", "ff00", "01", "0103040000"):
            await central.command(bytes.fromhex(command))
        self.errors = self.log.named("error")
        self.assertEqual(len(self.errors), 6)

    async def test_it_sleeps_unless_commanded_never_to(self):
        central = await self.start_armband(1000, sleep_after=0.5, wake_after=0.1)
        await central.connect(ADDRESS)
        await until(lambda: central.disconnections, "sleep")
        await self.until("advertising", 2)
        await central.start(ADDRESS)
        await asyncio.sleep(0.8)
        self.assertEqual(len(central.disconnections), 1)
        self.assertEqual(len(self.log.named("asleep")), 1)

    async def test_settings_and_subscriptions_do_not_survive_a_disconnection(self):
        central = await self.start_armband(1000)
        await central.start(ADDRESS)
        await until(lambda: len(central.received) > 10, "a stream")
        await central.connection.disconnect()
        await self.until("advertising", 2)
        before = len(central.received)
        await central.connect(ADDRESS)
        await central.discover()
        await central.command(EMG_FILTERED)
        await asyncio.sleep(0.1)
        self.assertEqual(len(central.received), before)

    async def test_the_recording_goes_on_where_a_connection_ended(self):
        central = await self.start_armband(200)
        await central.start(ADDRESS)
        await until(lambda: len(central.received) > 20, "a stream")
        await central.connection.disconnect()
        await self.until("advertising", 2)
        await central.start(ADDRESS)
        await self.until("end")
        await asyncio.sleep(0.05)
        got = numbers(central)
        self.assertEqual(got, sorted(set(got)))
        self.assertEqual((got[0], got[-1]), (0, 199))

    async def test_at_the_end_it_stays_connected_disconnects_or_exits(self):
        central = await self.start_armband(10)
        await central.start(ADDRESS)
        await self.until("end")
        await asyncio.sleep(0.1)
        self.assertEqual((central.disconnections, self.armband.done.is_set()), ([], False))

        central = await self.start_armband(10, end="disconnect")
        await central.start(ADDRESS)
        await until(lambda: central.disconnections == [0x13], "the end of the connection")
        await asyncio.sleep(0.1)
        self.assertEqual(len(self.log.named("advertising")), 1)

        central = await self.start_armband(10, end="exit")
        await central.start(ADDRESS)
        await asyncio.wait_for(self.armband.done.wait(), 5)


class Misbehaviour(ArmbandTest):
    async def test_dropped_notifications_never_come(self):
        got = await self.numbers(script=[{"do": "drop", "at": 10, "count": 3}])
        self.assertEqual(got, [n for n in range(100) if n not in (10, 11, 12)])

    async def test_a_duplicate_comes_twice(self):
        got = await self.numbers(script=[{"do": "duplicate", "at": 10}])
        self.assertEqual(got, sorted([*range(100), 10]))

    async def test_swapped_neighbours_change_places(self):
        got = await self.numbers(script=[{"do": "swap", "at": 10}])
        self.assertEqual(got, [*range(10), 11, 10, *range(12, 100)])

    async def test_a_short_and_a_long_one_keep_their_lane_and_their_first_bytes(self):
        central = await self.start_armband(script=[
            {"do": "corrupt", "at": 10, "kind": "short"},
            {"do": "corrupt", "at": 20, "kind": "long"},
        ])
        await central.start(ADDRESS)
        await until(lambda: len(central.received) == 100, "all notifications")
        self.assertEqual(central.received[10], (2, value(10)[:9]))
        lane, long = central.received[20]
        self.assertEqual((lane, long[:16], len(long)), (0, value(20), 20))

    async def test_foreign_and_garbage_are_no_emg_and_do_not_end_the_stream(self):
        central = await self.start_armband(script=[
            {"do": "corrupt", "at": 10, "kind": "foreign"},
            {"do": "corrupt", "at": 20, "kind": "garbage"},
        ])
        await central.connect(ADDRESS)
        await central.discover()
        seen = []
        client = central.connection.gatt_client
        receive = client.on_gatt_pdu
        client.on_gatt_pdu = lambda pdu: (seen.append(bytes(pdu)), receive(pdu))
        await central.subscribe()
        await central.command(NEVER_SLEEP)
        await central.command(EMG_FILTERED)
        await self.until("end")
        await until(lambda: len(central.received) == 98, "the others")
        self.assertEqual(numbers(central), [n for n in range(100) if n not in (10, 20)])
        foreign = bytes([0x1B, 0x27, 0]) + value(10)
        self.assertEqual([pdu for pdu in seen if pdu.endswith(value(10))], [foreign])
        self.assertTrue(any(pdu[0] == 0x7F for pdu in seen))

    async def test_what_is_delayed_comes_at_once_and_complete(self):
        central = await self.start_armband(script=[{"do": "delay", "at": 50, "ms": 200}], pace=5.0)
        await central.start(ADDRESS)
        await until(lambda: len(central.received) == 50, "the first half")
        before = asyncio.get_running_loop().time()
        await until(lambda: len(central.received) == 100, "the second half")
        # Undelayed they take 100 ms; after 200 ms of delay all are due at once.
        self.assertGreater(asyncio.get_running_loop().time() - before, 0.15)
        self.assertEqual(numbers(central), [*range(100)])
        sent = {line["n"]: line["t"] for line in self.log.named("sent")}
        self.assertLess(sent[90] - sent[50], 0.08)

    async def test_it_vanishes_and_comes_back(self):
        central = await self.start_armband(script=[{"do": "vanish", "at": 50, "for_ms": 200}])
        await central.start(ADDRESS)
        await until(lambda: central.disconnections == [0x08], "a lost link")
        await asyncio.sleep(0.1)
        self.assertEqual(len(self.log.named("advertising")), 1)
        await self.until("advertising", 2)
        await central.start(ADDRESS)
        await self.until("end")
        await asyncio.sleep(0.02)
        self.assertEqual(numbers(central), [*range(100)])

    async def test_it_disconnects_when_it_sleeps(self):
        central = await self.start_armband(script=[{"do": "sleep", "at": 50, "for_ms": 50}])
        await central.start(ADDRESS)
        await until(lambda: central.disconnections == [0x13], "sleep")
        await self.until("advertising", 2)

    async def test_it_refuses_as_many_connections_as_scripted(self):
        central = await self.start_armband(script=[{"do": "refuse", "count": 2}])
        for times in (1, 2):
            await central.connect(ADDRESS)
            await until(lambda times=times: central.disconnections == [0x3E] * times, "a refusal")
            await self.until("advertising", 1 + times)
        await central.start(ADDRESS)
        await self.until("end")

    async def test_after_it_has_vanished_it_refuses_as_many_connections_as_scripted(self):
        step = {"do": "vanish", "at": 50, "for_ms": 50, "refuse": 1}
        central = await self.start_armband(script=[step])
        await central.start(ADDRESS)
        await until(lambda: central.disconnections == [0x08], "a lost link")
        await self.until("advertising", 2)
        await central.connect(ADDRESS)
        await until(lambda: central.disconnections == [0x08, 0x3E], "a refusal")
        await self.until("advertising", 3)
        await central.start(ADDRESS)
        await self.until("end")
        self.assertEqual(len(self.log.named("refused")), 1)

    async def test_a_falling_battery_level_is_notified(self):
        central = await self.start_armband(script=[{"do": "battery", "at": 50, "percent": 5}])
        await central.connect(ADDRESS)
        await central.discover()
        levels = []
        await central.find(BATTERY_LEVEL).subscribe(lambda value: levels.append(value[0]))
        await central.subscribe()
        await central.command(EMG_FILTERED)
        await self.until("end")
        await until(lambda: levels == [5], "the new level")
        self.assertEqual(await central.find(BATTERY_LEVEL).read_value(), b"\x05")


class Habits(ArmbandTest):
    async def test_it_asks_for_parameters_and_stays_where_it_is_answered(self):
        ask = {"do": "ask-parameters", "first_ms": 20, "every_ms": 20, "times": 3}
        central = await self.start_armband(script=[ask])
        await central.connect(ADDRESS)
        await self.until("signal", 3)
        await asyncio.sleep(0.1)
        self.assertEqual(len(self.log.named("asked")), 3)
        # Code 0x13, and accepted: Bumble's central takes whatever is asked for.
        answers = [bytes.fromhex(entry["value"]) for entry in self.log.named("signal")]
        self.assertEqual([(answer[0], answer[2:]) for answer in answers], [(0x13, b"\2\0\0\0")] * 3)
        self.assertEqual(central.disconnections, [])

    async def test_it_ends_a_connection_in_which_it_asked_in_vain(self):
        ask = {"do": "ask-parameters", "first_ms": 20, "every_ms": 20, "times": 3}
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
        self.log = EventLog()
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
