"""A central that follows the protocol, for the tests of the armband."""

import asyncio

from bumble import hci
from bumble.core import UUID
from bumble.device import Connection, Device
from bumble.gatt_client import CharacteristicProxy
from bumble.host import Host
from bumble.transport.common import AsyncPipeSink

from gatt_table import BATTERY_LEVEL, COMMAND, EMG_DATA, vendor_uuid
from radio import Radio

NEVER_SLEEP = bytes.fromhex("090101")
EMG_FILTERED = bytes.fromhex("0103020000")
TIMEOUT = 5.0


class Central:
    """Connects, subscribes, collects `(lane, value)`."""

    def __init__(self, host: Host) -> None:
        self.device = Device(address=hci.Address("F0:F1:F2:F3:F4:F5"), host=host)
        self.received: list[tuple[int, bytes]] = []
        self.disconnections: list[int] = []
        self._by_uuid: dict[UUID, CharacteristicProxy] = {}
        self.connection: Connection | None = None
        self.device.on("connection", self._on_connection)

    def _on_connection(self, connection: Connection) -> None:
        connection.on("disconnection", self.disconnections.append)

    @classmethod
    def of(cls, radio: Radio) -> "Central":
        """A central in the process of the radio."""
        return cls(Host(radio.central, AsyncPipeSink(radio.central)))

    async def connect(self, address: str) -> None:
        self._by_uuid = {}
        if not self.device.powered_on:
            await self.device.power_on()
        peer = hci.Address(address, hci.Address.PUBLIC_DEVICE_ADDRESS)
        self.connection = await self.device.connect(peer, timeout=TIMEOUT)

    async def discover(self) -> None:
        client = self.connection.gatt_client
        await client.request_mtu(247)
        for service in await client.discover_services():
            for characteristic in await client.discover_characteristics([], service):
                self._by_uuid[characteristic.uuid] = characteristic

    def find(self, short: int) -> CharacteristicProxy:
        sig = short in (BATTERY_LEVEL, 0x2A29)
        return self._by_uuid[UUID.from_16_bits(short) if sig else vendor_uuid(short)]

    async def subscribe(self, lanes=(0, 1, 2, 3)) -> None:
        for lane in lanes:
            await self.find(EMG_DATA[lane]).subscribe(
                lambda value, lane=lane: self.received.append((lane, bytes(value)))
            )

    async def command(self, value: bytes, with_response: bool = True) -> None:
        await self.find(COMMAND).write_value(value, with_response)

    async def start(self, address: str) -> None:
        """Sets up a stream, in the usual order."""
        await self.connect(address)
        await self.discover()
        await self.subscribe()
        await self.command(NEVER_SLEEP)
        await self.command(EMG_FILTERED)


async def until(condition, what: str) -> None:
    """Waits for a condition; fails after TIMEOUT seconds."""
    deadline = asyncio.get_running_loop().time() + TIMEOUT
    while not condition():
        if asyncio.get_running_loop().time() > deadline:
            raise AssertionError(f"waited {TIMEOUT} s in vain for {what}")
        await asyncio.sleep(0.005)
