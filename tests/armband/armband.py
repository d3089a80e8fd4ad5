"""The virtual armband: what connects, obeys, streams and, if told so, misbehaves.

It streams only to a central that keeps the rules of the protocol, and logs what breaks them as
`error`: stricter than the part it stands for.
"""

import asyncio
from dataclasses import dataclass, field

from bumble import att, hci
from bumble.core import AdvertisingData
from bumble.device import Connection, Device, DeviceConfiguration
from bumble.host import Host
from bumble.transport.common import AsyncPipeSink

from commands import CommandError, Settings
from event_log import EventLog
from gatt_table import BATTERY_LEVEL, CONTROL_SERVICE, EMG_DATA, GattTable, Values, vendor_uuid
from misbehaviour import Packet, Script, Shaper, Step
from radio import Radio
from stream import Recording, Schedule

# ATT MTU of a Bluetooth 4.0 device: 20 bytes of value.
MTU = 23
ADVERTISING_INTERVAL_MS = 100
# How often to look whether a slow reader has caught up.
CONGESTION_POLL = 0.002
# What the central's host has read takes it no longer to digest: a script that says 100 is next
# means that 99 came. A host that hears of the end of a link forgets what it has not digested.
DIGESTION = 0.1

LOST = hci.HCI_ErrorCode.CONNECTION_TIMEOUT_ERROR
HUNG_UP = hci.HCI_ErrorCode.REMOTE_USER_TERMINATED_CONNECTION_ERROR
REFUSED = hci.HCI_ErrorCode.CONNECTION_FAILED_TO_BE_ESTABLISHED_ERROR


@dataclass
class Options:
    """How this armband differs from the usual one."""

    pace: float = 1.0
    first_lane: int = 0
    battery: int = 80
    firmware: tuple[int, int, int, int] = (1, 5, 1970, 2)
    # Without the command "never sleep" the link is dropped after so long, and the arm wakes it.
    sleep_after: float = 30.0
    wake_after: float = 1.0
    end: str = "silence"
    script: Script = field(default_factory=Script)


class Armband:
    """One armband on one side of the radio. `done` is set when it is told to exit at the end."""

    def __init__(self, radio: Radio, recording: Recording, options: Options, log: EventLog) -> None:
        self._radio = radio
        self._recording = recording
        self._options = options
        self._log = log
        self._shaper = Shaper(options.script)
        self._refusals = options.script.refusals
        self._battery = options.battery
        # The next notification of the recording: a live arm does not rewind when it reconnects.
        self._next = 0
        self._ended = False
        self._settings = Settings()
        self._connection: Connection | None = None
        self._streaming: asyncio.Task | None = None
        self._falling_asleep: asyncio.TimerHandle | None = None
        self._away_for: float | None = 0.0
        self.done = asyncio.Event()

        self._table = GattTable(
            Values(lambda: self._battery, self._on_command, firmware=options.firmware)
        )
        config = DeviceConfiguration(
            name="Myo", gap_service_enabled=False, gatt_service_enabled=False
        )
        self._device = Device(config=config, host=Host(radio.armband, AsyncPipeSink(radio.armband)))
        self._device.add_services(self._table.services)
        self._server = self._device.gatt_server
        self._server.max_mtu = MTU
        # Bumble's carries out a Write Command on any attribute; an armband drops it unheard.
        self._server.on_att_write_command = self._on_write_command
        self._server.on("characteristic_subscription", self._on_subscription)
        self._device.on("connection", self._on_connection)

    async def start(self) -> None:
        await self._device.power_on()
        await self._advertise()

    # Connections

    async def _advertise(self) -> None:
        await self._device.start_advertising(
            own_address_type=hci.OwnAddressType.PUBLIC,
            advertising_data=advertisement(),
            scan_response_data=b"",
            advertising_interval_min=ADVERTISING_INTERVAL_MS,
            advertising_interval_max=ADVERTISING_INTERVAL_MS,
        )
        self._log.write("advertising")

    def _on_connection(self, connection: Connection) -> None:
        connection.on("disconnection", self._on_disconnection)
        if self._refusals > 0:
            self._refusals -= 1
            self._log.write("refused")
            self._radio.lose_link(REFUSED)
            return
        self._log.write("connected")
        self._connection = connection
        self._away_for = 0.0
        self._plan_sleep()

    def _on_disconnection(self, reason: int) -> None:
        self._log.write("disconnected", reason=reason, next=self._next)
        self._connection = None
        self._settings = Settings()
        self._shaper.forget()
        self._stop_streaming()
        self._plan_sleep()
        if self._away_for is not None:
            self._spawn(self._come_back(self._away_for))

    async def _come_back(self, seconds: float) -> None:
        await asyncio.sleep(seconds)
        await self._advertise()

    def _leave(self, reason: int, away_for: float | None) -> None:
        """Ends the connection; advertises again after so many seconds, or never."""
        self._away_for = away_for
        self._radio.lose_link(reason)

    def _plan_sleep(self) -> None:
        if self._falling_asleep:
            self._falling_asleep.cancel()
            self._falling_asleep = None
        if self._connection and not self._settings.never_sleep:
            loop = asyncio.get_running_loop()
            self._falling_asleep = loop.call_later(self._options.sleep_after, self._fall_asleep)

    def _fall_asleep(self) -> None:
        self._log.write("asleep")
        self._leave(HUNG_UP, self._options.wake_after)

    # What the central writes

    def _on_command(self, command: bytes) -> None:
        self._log.write("write", value=command.hex())
        before = self._settings.never_sleep
        try:
            self._settings.obey(command)
        except CommandError as error:
            self._log.write("error", reason=str(error), value=command.hex())
            return
        if self._settings.never_sleep != before:
            self._plan_sleep()
        if not self._settings.streams:
            self._stop_streaming()
        elif self._streaming is None and not self._ended:
            self._log.write("mode", emg=self._settings.emg_mode)
            self._streaming = self._spawn(self._stream())

    def _on_write_command(self, _connection: Connection, request: att.ATT_Write_Command) -> None:
        reason = f"write command to handle {request.attribute_handle:#06x}: ignored"
        self._log.write("error", reason=reason, value=request.attribute_value.hex())

    def _on_subscription(self, _connection, characteristic, notify: bool, indicate: bool) -> None:
        self._log.write(
            "subscribed", uuid=str(characteristic.uuid), notify=notify, indicate=indicate
        )

    # The stream

    async def _stream(self) -> None:
        clock = asyncio.get_running_loop().time
        schedule = Schedule.starting(clock(), self._options.pace)
        lane = self._options.first_lane
        while self._next < len(self._recording):
            await asyncio.sleep(schedule.next(clock()))
            while self._radio.congested():
                await asyncio.sleep(CONGESTION_POLL)
            n = self._next
            while step := self._options.script.take_act(n):
                self._log.write(step.do, n=n, **step.fields)
                if not await self._act(step, schedule):
                    return
            self._next = n + 1
            shape = self._options.script.shape(n)
            if shape:
                self._log.write(shape.do, n=n, **shape.fields)
            for packet in self._shaper.packets(n, lane, self._recording.notification(n)):
                self._send(packet)
            self._log.write("sent", n=n, lane=lane)
            lane = (lane + 1) % len(EMG_DATA)
        await self._landed()
        self._end()

    async def _act(self, step: Step, schedule: Schedule) -> bool:
        """Does what the script says; whether the stream goes on."""
        match step.do:
            case "delay":
                seconds = step.fields["ms"] / 1000
                schedule.hold_back(seconds)
                await asyncio.sleep(seconds)
            case "vanish":
                await self._landed()
                self._leave(LOST, step.fields["for_ms"] / 1000)
                return False
            case "sleep":
                await self._landed()
                self._leave(HUNG_UP, step.fields["for_ms"] / 1000)
                return False
            case "battery":
                self._battery = step.fields["percent"]
                self._send(Packet(BATTERY_LEVEL, bytes([self._battery])))
        return True

    def _send(self, packet: Packet) -> None:
        if self._connection is None:
            return
        if packet.characteristic is None:
            self._server.send_gatt_pdu(self._connection, packet.value)
            return
        handle = self._table.characteristic(packet.characteristic).handle
        wanted = self._server.subscribers.get(self._connection, {}).get(handle, bytes(2))[0] & 1
        # What nobody subscribed to is not sent, but for the packets that are there to disturb.
        if wanted or packet.characteristic not in (*EMG_DATA, BATTERY_LEVEL):
            pdu = att.ATT_Handle_Value_Notification(
                attribute_handle=handle, attribute_value=packet.value
            )
            self._server.send_gatt_pdu(self._connection, bytes(pdu))

    async def _landed(self) -> None:
        """Waits until all that was sent has arrived."""
        while self._radio.waiting() > 0:
            await asyncio.sleep(CONGESTION_POLL)
        await asyncio.sleep(DIGESTION)

    def _end(self) -> None:
        self._ended = True
        self._log.write("end")
        match self._options.end:
            case "disconnect":
                self._leave(HUNG_UP, None)
            case "exit":
                self.done.set()

    def _stop_streaming(self) -> None:
        if self._streaming:
            self._streaming.cancel()
            self._streaming = None

    def _spawn(self, work) -> asyncio.Task:
        task = asyncio.get_running_loop().create_task(work)
        task.add_done_callback(self._on_task_done)
        return task

    def _on_task_done(self, task: asyncio.Task) -> None:
        # A bug here must not pass for an armband that fell silent.
        if not task.cancelled() and (error := task.exception()):
            self._log.write("error", reason=f"{type(error).__name__}: {error}")


def advertisement() -> bytes:
    """The 31 bytes of one captured advertisement: padded short name, flags, Control Service."""
    return bytes(
        AdvertisingData([
            (AdvertisingData.SHORTENED_LOCAL_NAME, b"Myo" + bytes(5)),
            (AdvertisingData.FLAGS, b"\x06"),
            (
                AdvertisingData.INCOMPLETE_LIST_OF_128_BIT_SERVICE_CLASS_UUIDS,
                bytes(vendor_uuid(CONTROL_SERVICE)),
            ),
        ])
    )
