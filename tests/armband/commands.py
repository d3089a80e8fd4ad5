"""Commands that a central writes to the armband."""

STREAMING_MODES = (2, 3)


class CommandError(ValueError):
    """A command that a real armband does not know, or that must never be sent."""


def emg_mode(command: bytes) -> int | None:
    """The EMG mode that a command sets; none where it sets something else.

    Raises CommandError if code, length or values are not those of the protocol.
    """
    if len(command) < 2 or command[1] != len(command) - 2:
        raise CommandError("byte 1 is not the number of bytes after it")
    code, payload = command[0], command[2:]
    match code, len(payload):
        case 0x01, 3:
            emg, imu, classifier = payload
            if emg > 3 or imu > 4 or classifier > 1:
                raise CommandError("set mode: a value is out of its range")
            return emg
        case 0x09, 1:
            if payload[0] > 1:
                raise CommandError("set sleep mode: neither 0 nor 1")
        case (0x03, 1) | (0x06, 6) | (0x07, 18) | (0x0A, 1) | (0x0B, 1):
            # Vibration, LED, unlocking: without effect on a stream.
            pass
        case 0x04, 0:
            raise CommandError("deep sleep: only USB power ends it")
        case _:
            raise CommandError("unknown command, or of a wrong length")
    return None
