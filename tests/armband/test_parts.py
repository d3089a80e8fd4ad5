"""The parts that need no radio."""

import asyncio
import io
import unittest

from commands import CommandError, emg_mode
from misbehaviour import Script, ScriptError
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


class RecordingTest(unittest.TestCase):
    def test_two_samples_are_a_notification_and_an_odd_one_is_left_out(self):
        recording = Recording(bytes(range(40)))
        self.assertEqual(recording.notification(1), bytes(range(16, 32)))
        self.assertEqual([asyncio.run(recording.has(n)) for n in (1, 2)], [True, False])

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
    def test_a_step_is_taken_once(self):
        script = Script([{"do": "vanish", "at": 3, "for_ms": 1}])
        self.assertEqual([script.take(n) is None for n in (2, 3, 3)], [True, False, True])

    def test_an_invalid_script_is_refused(self):
        for step in (
            {"do": "dance", "at": 1},
            {"do": "vanish", "at": 1},
            {"do": "chatter", "ms": 1, "often": 2},
            {"do": "corrupt", "at": 1, "kind": "slightly"},
        ):
            with self.assertRaises(ScriptError, msg=step):
                Script([step])


class CommandTest(unittest.TestCase):
    def test_a_mode_is_set_by_its_command_alone(self):
        self.assertEqual(emg_mode(bytes.fromhex("0103020100")), 2)
        self.assertIsNone(emg_mode(bytes.fromhex("090101")))

    def test_unknown_and_dangerous_commands_and_wrong_lengths_are_refused(self):
        for command in ("", "09", "0901", "090201", "09010100", "0400", "0103020000ff", "ff00", "0103040000"):
            with self.assertRaises(CommandError, msg=command):
                emg_mode(bytes.fromhex(command))


if __name__ == "__main__":
    unittest.main()
