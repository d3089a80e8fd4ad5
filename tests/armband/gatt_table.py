"""The armband's GATT table: its services, in an order that gives every attribute the handle that it
has in logs of real armbands with firmware 1.x (command 0x19, EMG 0x2B, 0x2E, 0x31, 0x34)."""

import struct
from collections.abc import Callable

from bumble.core import UUID
from bumble.gatt import Characteristic, CharacteristicValue, Service

CONTROL_SERVICE = 0x0001
COMMAND = 0x0401
FV_DATA = 0x0104
EMG_DATA = (0x0105, 0x0205, 0x0305, 0x0405)
BATTERY_LEVEL = 0x2A19

Properties = Characteristic.Properties
_READ, _WRITE = Properties.READ, Properties.WRITE
_NOTIFY, _INDICATE = Properties.NOTIFY, Properties.INDICATE


def vendor_uuid(short: int) -> UUID:
    """The 128-bit UUID of a vendor attribute from its 16-bit id."""
    return UUID(f"d506{short:04x}-a904-deb9-4748-2c7f4a124842")


class GattTable:
    """All services; `characteristic` finds one by its 16-bit id."""

    def __init__(self, on_command: Callable[[bytes], None]) -> None:
        self._by_id: dict[int, Characteristic] = {}
        vendor, sig = self._vendor, self._sig
        command = CharacteristicValue(write=lambda _, value: on_command(value))
        # Serial number, unlock pose, classifier and SKU, which this project does not read.
        info = bytes(20)
        # Major, minor, patch, hardware.
        firmware = struct.pack("<HHHH", 1, 5, 1970, 2)
        # Interval 7.5 to 25 ms, latency 0, timeout 2 s.
        preferred = struct.pack("<HHHH", 6, 20, 0, 200)
        self.services = [
            Service(UUID.from_16_bits(0x1800), [
                sig(0x2A00, _READ | _WRITE, b"Myo"),
                sig(0x2A01, _READ, bytes(2)),
                sig(0x2A04, _READ, preferred),
            ]),
            Service(UUID.from_16_bits(0x1801), [sig(0x2A05, _INDICATE)]),
            Service(UUID.from_16_bits(0x180A), [sig(0x2A29, _READ, b"Thalmic Labs")]),
            Service(UUID.from_16_bits(0x180F), [sig(BATTERY_LEVEL, _READ | _NOTIFY, bytes([80]))]),
            Service(vendor_uuid(CONTROL_SERVICE), [
                vendor(0x0101, _READ, info),
                vendor(0x0201, _READ, firmware),
                vendor(COMMAND, _WRITE, command),
            ]),
            Service(vendor_uuid(0x0002), [vendor(0x0402, _NOTIFY), vendor(0x0502, _INDICATE)]),
            Service(vendor_uuid(0x0003), [vendor(0x0103, _INDICATE)]),
            Service(vendor_uuid(0x0004), [vendor(FV_DATA, _NOTIFY)]),
            Service(vendor_uuid(0x0005), [vendor(short, _NOTIFY) for short in EMG_DATA]),
            Service(vendor_uuid(0x0006), [vendor(0x0602, _INDICATE)]),
        ]

    def characteristic(self, short: int) -> Characteristic:
        return self._by_id[short]

    def _vendor(self, short: int, properties: Properties, value=b"") -> Characteristic:
        return self._add(short, vendor_uuid(short), properties, value)

    def _sig(self, short: int, properties: Properties, value=b"") -> Characteristic:
        return self._add(short, UUID.from_16_bits(short), properties, value)

    def _add(self, short: int, uuid: UUID, properties: Properties, value) -> Characteristic:
        permissions = Characteristic.Permissions(0)
        if properties & _READ:
            permissions |= Characteristic.Permissions.READABLE
        if properties & _WRITE:
            permissions |= Characteristic.Permissions.WRITEABLE
        self._by_id[short] = Characteristic(uuid, properties, permissions, value)
        return self._by_id[short]
