"""The parts that need no radio."""

import asyncio
import io
import unittest

from commands import CommandError, Settings
from misbehaviour import CUT, GARBAGE, Packet, Script, ScriptError, Impairer
from stream import CATCH_UP, GrowingRecording, Recording, Schedule


class ScheduleTest(unittest.TestCase):
    def test_on_time_every_wait_ends_on_the_grid(self):
        schedule = Schedule.starting(0.0, pace=1.0)
        now, due = 0.0, []
        for _ in range(100):
            now += schedule.next(now)
            due.append(round(now, 6))
            now += 0.003  # work
        self.assertEqual(due, [round(0.01 * (k + 1), 6) for k in range(100)])

    def test_after_a_stall_no_more_than_the_limit_come_at_once(self):
        schedule = Schedule.starting(0.0, pace=1.0)
        schedule.next(0.0)
        burst = 0
        while schedule.next(5.0) == 0.0:
            burst += 1
        self.assertEqual(burst, CATCH_UP)

    def test_after_a_delay_by_script_all_that_is_due_comes_at_once(self):
        schedule = Schedule.starting(0.0, pace=1.0)
        self.assertAlmostEqual(schedule.next(0.0), 0.01)
        schedule.delay(0.5)
        burst = 0
        while schedule.next(0.51) == 0.0:
            burst += 1
        self.assertIn(burst, (49, 50, 51))


class RecordingTest(unittest.TestCase):
    def test_two_samples_are_a_notification_and_an_odd_one_is_left_out(self):
        recording = Recording(bytes(range(40)))
        self.assertEqual(len(recording), 2)
        self.assertEqual(recording.notification(1), bytes(range(16, 32)))

    def test_what_is_appended_is_waited_for(self):
        file = io.BytesIO()
        recording = GrowingRecording(file)

        async def stream() -> bytes:
            waiting = asyncio.ensure_future(recording.has(1))
            for part in (bytes(range(20)), bytes(range(20, 32))):
                await asyncio.sleep(0.01)
                self.assertFalse(waiting.done())
                place = file.tell()
                file.seek(0, io.SEEK_END)
                file.write(part)
                file.seek(place)
            self.assertTrue(await asyncio.wait_for(waiting, 5))
            return recording.notification(1)

        self.assertEqual(asyncio.run(stream()), bytes(range(16, 32)))


class ScriptTest(unittest.TestCase):
    def test_an_action_is_taken_once(self):
        script = Script([{"do": "vanish", "at": 3, "for_ms": 1}, {"do": "delay", "at": 3, "ms": 2}])
        self.assertEqual([script.take_action(3).do, script.take_action(3).do], ["vanish", "delay"])
        self.assertIsNone(script.take_action(3))

    def test_an_invalid_script_is_refused(self):
        for entry in (
            "drop",
            {"do": "dance", "at": 1},
            {"do": "drop"},
            {"do": "drop", "at": -1},
            {"do": "drop", "at": 1.5},
            {"do": "drop", "at": 1, "often": 2},
            {"do": "corrupt", "at": 1, "kind": "slightly"},
        ):
            with self.assertRaises(ScriptError, msg=entry):
                Script([entry])
        with self.assertRaises(ScriptError):
            Script({"do": "drop", "at": 1})

    def test_refusals_add_up(self):
        script = Script([{"do": "refuse", "count": 2}, {"do": "refuse", "count": 1}])
        self.assertEqual(script.refusals, 3)

    def test_chatter_has_a_period_and_is_no_action_of_the_stream(self):
        script = Script([{"do": "chatter", "ms": 5}])
        self.assertEqual(script.chatter_ms, 5)
        self.assertIsNone(script.take_action(0))
        self.assertIsNone(Script([]).chatter_ms)
        with self.assertRaises(ScriptError):
            Script([{"do": "chatter"}])


class ImpairerTest(unittest.TestCase):
    def test_a_swap_does_not_outlast_the_link(self):
        impairer = Impairer(Script([{"do": "swap", "at": 0}]))
        self.assertEqual(impairer.packets(0, 0, b"a"), [])
        impairer.reset()
        self.assertEqual(impairer.packets(1, 1, b"b"), [Packet(0x0205, b"b")])

    def test_garbage_has_the_flag_of_a_command_that_may_be_ignored(self):
        impairer = Impairer(Script([{"do": "corrupt", "at": 0, "kind": "garbage"}]))
        self.assertEqual(impairer.packets(0, 0, b"a"), [GARBAGE])
        self.assertTrue(GARBAGE.value[0] & 0x40)

    def test_what_ends_too_early_is_of_every_kind_in_turn(self):
        script = [{"do": "corrupt", "at": n, "kind": "cut"} for n in range(28)]
        impairer = Impairer(Script(script))
        sent = [packet for n in range(28) for packet in impairer.packets(n, 0, b"a")]
        self.assertEqual(sent, [Packet(None, pdu, channel=4) for pdu in 2 * CUT])


class SettingsTest(unittest.TestCase):
    def test_only_modes_2_and_3_stream(self):
        for mode, streams in ((0, False), (1, False), (2, True), (3, True)):
            settings = Settings()
            settings.apply(bytes([1, 3, mode, 0, 0]))
            self.assertEqual(settings.streams, streams)

    def test_a_wrong_length_changes_nothing(self):
        settings = Settings()
        for command in (b"", b"\x09", b"\x09\x01", b"\x09\x02\x01", b"\x09\x01\x01\x00"):
            with self.assertRaises(CommandError):
                settings.apply(command)
        self.assertEqual(settings, Settings())


if __name__ == "__main__":
    unittest.main()
