"""The virtual armband: it connects, obeys commands, streams, and misbehaves as its script says.

It streams only to a central that follows the protocol, and logs every violation as `error`: it is
stricter than the real armband.
"""

import asyncio
from dataclasses import dataclass, field

from bumble import att, hci, l2cap
from bumble.core import AdvertisingData
from bumble.device import Connection, Device, DeviceConfiguration
from bumble.gatt import GATT_CLIENT_CHARACTERISTIC_CONFIGURATION_DESCRIPTOR
from bumble.host import Host
from bumble.transport.common import AsyncPipeSink

from commands import CommandError, Settings
from event_log import EventLog
from gatt_table import BATTERY_LEVEL, CONTROL_SERVICE, EMG_DATA, FV_DATA, IMU_DATA, GattTable, Values, vendor_uuid
from misbehaviour import Impairer, Packet, Script, Step
from radio import Radio
from stream import Recording, Schedule, movement

# ATT MTU of a Bluetooth 4.0 device: 20 bytes of value.
MTU = 23
ADVERTISING_INTERVAL_MS = 100
# Seconds between two checks whether a slow reader has caught up.
CONGESTION_POLL = 0.002
# Seconds for the central's host to process what it has read. At the end of a link the host discards
# what it has not processed, but a script that ends the link before notification 100 means that the
# host has got 99.
HOST_DELAY = 0.1

LOST = hci.HCI_ErrorCode.CONNECTION_TIMEOUT_ERROR
HUNG_UP = hci.HCI_ErrorCode.REMOTE_USER_TERMINATED_CONNECTION_ERROR
REFUSED = hci.HCI_ErrorCode.CONNECTION_FAILED_TO_BE_ESTABLISHED_ERROR


@dataclass
class Options:
    """Settings of the armband; the defaults are those of a usual one."""

    pace: float = 1.0
    first_lane: int = 0
    battery: int = 80
    firmware: tuple[int, int, int, int] = (1, 5, 1970, 2)
    # Without the command "never sleep" it disconnects after this time, and advertises again later.
    sleep_after: float = 30.0
    wake_after: float = 1.0
    end: str = "silence"
    script: Script = field(default_factory=Script)


class Armband:
    """One armband. `done` is set at the end of the recording if the option `end` is "exit"."""

    def __init__(self, radio: Radio, recording: Recording, options: Options, log: EventLog) -> None:
        self._radio = radio
        self._recording = recording
        self._options = options
        self._log = log
        self._impairer = Impairer(options.script)
        self._refusals = options.script.refusals
        self._battery = options.battery
        # The next notification of the recording; a new connection continues with it.
        self._next = 0
        self._ended = False
        self._settings = Settings()
        self._connection: Connection | None = None
        self._streaming: asyncio.Task | None = None
        self._sleep_timer: asyncio.TimerHandle | None = None
        # Seconds from the end of the connection to the next advertisement; never where none.
        self._advertise_after: float | None = 0.0
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
        # Bumble carries out a Write Command on any attribute; an armband ignores it.
        self._server.on_att_write_command = self._on_write_command
        self._server.on("characteristic_subscription", self._on_subscription)
        if options.script.hides_subscriptions:
            for attribute in self._server.attributes:
                if attribute.type == GATT_CLIENT_CHARACTERISTIC_CONFIGURATION_DESCRIPTOR:
                    # Bumble lets everything be read that needs no authorization.
                    attribute.permissions |= att.Attribute.READ_REQUIRES_AUTHORIZATION
        self._signals = self._device.l2cap_channel_manager
        self._signals.on_control_frame = self._on_signal
        # Identifiers of requests for connection parameters without an answer.
        self._unanswered: set[int] = set()
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
        if self._options.script.chatter_ms is not None:
            self._spawn(self._chatter(connection, self._options.script.chatter_ms / 1000))
        if self._options.script.asks:
            self._spawn(self._ask(connection, **self._options.script.asks))
        self._advertise_after = 0.0
        self._plan_sleep()

    def _on_disconnection(self, reason: int) -> None:
        self._log.write("disconnected", reason=reason, next=self._next)
        self._connection = None
        self._settings = Settings()
        self._impairer.reset()
        self._stop_streaming()
        self._plan_sleep()
        if self._advertise_after is not None:
            self._spawn(self._advertise_later(self._advertise_after))

    async def _advertise_later(self, seconds: float) -> None:
        await asyncio.sleep(seconds)
        await self._advertise()

    def _disconnect(self, reason: int, advertise_after: float | None) -> None:
        """Ends the connection; advertises again after so many seconds, or never."""
        self._advertise_after = advertise_after
        self._radio.lose_link(reason)

    def _plan_sleep(self) -> None:
        if self._sleep_timer:
            self._sleep_timer.cancel()
            self._sleep_timer = None
        if self._connection and not self._settings.never_sleep:
            loop = asyncio.get_running_loop()
            self._sleep_timer = loop.call_later(self._options.sleep_after, self._sleep)

    def _sleep(self) -> None:
        self._log.write("asleep")
        self._disconnect(HUNG_UP, self._options.wake_after)

    async def _chatter(self, connection: Connection, period: float) -> None:
        """Notifies without a subscription until the connection streams or ends."""
        while self._connection is connection and self._streaming is None:
            self._send(Packet(FV_DATA, bytes(16)))
            self._log.write("chatter")
            await asyncio.sleep(period)

    async def _ask(self, connection: Connection, first_ms: int, every_ms: int, times: int) -> None:
        """Asks for other connection parameters, and ends the connection if that is not answered."""
        self._unanswered.clear()
        await asyncio.sleep(first_ms / 1000)
        for _ in range(times):
            if self._connection is not connection:
                return
            identifier = self._signals.next_identifier(connection)
            self._unanswered.add(identifier)
            self._log.write("asked", identifier=identifier)
            request = l2cap.L2CAP_Connection_Parameter_Update_Request(
                identifier=identifier, interval_min=16, interval_max=32, latency=0, timeout=200
            )
            self._signals.send_control_frame(connection, l2cap.L2CAP_LE_SIGNALING_CID, request)
            await asyncio.sleep(every_ms / 1000)
        if self._connection is connection and self._unanswered:
            self._log.write("unanswered", identifiers=sorted(self._unanswered))
            self._disconnect(HUNG_UP, self._options.wake_after)

    def _on_signal(self, _connection: Connection, _channel: int, frame: l2cap.L2CAP_Control_Frame) -> None:
        self._unanswered.discard(frame.identifier)
        self._log.write("signal", value=bytes(frame).hex())

    # What the central writes

    def _on_command(self, command: bytes) -> None:
        self._log.write("write", value=command.hex())
        before = self._settings.never_sleep
        try:
            self._settings.apply(command)
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
        await asyncio.sleep(self._options.script.begins_after_ms / 1000)
        schedule = Schedule.starting(clock(), self._options.pace)
        lane = self._options.first_lane
        while await self._recording.has(self._next):
            await asyncio.sleep(schedule.next(clock()))
            while self._radio.congested():
                await asyncio.sleep(CONGESTION_POLL)
            n = self._next
            while step := self._options.script.take_action(n):
                self._log.write(step.do, n=n, **step.fields)
                if not await self._act(step, schedule):
                    return
            self._next = n + 1
            impairment = self._options.script.impairment(n)
            if impairment:
                self._log.write(impairment.do, n=n, **impairment.fields)
            for packet in self._impairer.packets(n, lane, self._recording.notification(n)):
                self._send(packet)
            self._log.write("sent", n=n, lane=lane)
            if self._settings.moves and n % 2 == 1:
                self._send(Packet(IMU_DATA, movement(n)))
            lane = (lane + 1) % len(EMG_DATA)
        await self._delivered()
        self._end()

    async def _act(self, step: Step, schedule: Schedule) -> bool:
        """Carries out a step of the script; returns whether the stream continues."""
        match step.do:
            case "delay":
                seconds = step.fields["ms"] / 1000
                schedule.delay(seconds)
                await asyncio.sleep(seconds)
            case "vanish":
                await self._delivered()
                self._refusals += step.fields["refuse"]
                self._disconnect(LOST, step.fields["for_ms"] / 1000)
                return False
            case "sleep":
                await self._delivered()
                self._refusals += step.fields["refuse"]
                self._disconnect(HUNG_UP, step.fields["for_ms"] / 1000)
                return False
            case "battery":
                self._battery = step.fields["percent"]
                self._send(Packet(BATTERY_LEVEL, bytes([self._battery])))
        return True

    def _send(self, packet: Packet) -> None:
        if self._connection is None:
            return
        if packet.characteristic is None:
            self._connection.send_l2cap_pdu(packet.channel, packet.value)
            return
        handle = self._table.characteristic(packet.characteristic).handle
        wanted = self._server.subscribers.get(self._connection, {}).get(handle, bytes(2))[0] & 1
        # Without a subscription nothing is sent, except by a script on other characteristics.
        if wanted or packet.characteristic not in (*EMG_DATA, BATTERY_LEVEL, IMU_DATA):
            pdu = att.ATT_Handle_Value_Notification(
                attribute_handle=handle, attribute_value=packet.value
            )
            self._server.send_gatt_pdu(self._connection, bytes(pdu))

    async def _delivered(self) -> None:
        """Waits until the central's host has processed all that was sent."""
        while self._radio.waiting() > 0:
            await asyncio.sleep(CONGESTION_POLL)
        await asyncio.sleep(HOST_DELAY)

    def _end(self) -> None:
        self._ended = True
        self._log.write("end")
        match self._options.end:
            case "disconnect":
                self._disconnect(HUNG_UP, None)
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
        # Otherwise a bug here would look like an armband that fell silent.
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
