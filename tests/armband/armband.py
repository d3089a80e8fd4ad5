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

from commands import STREAMING_MODES, CommandError, emg_mode
from event_log import EventLog
from gatt_table import CONTROL_SERVICE, EMG_DATA, FV_DATA, GattTable, vendor_uuid
from misbehaviour import Packet, Script, corrupted
from radio import Radio
from stream import Recording, Schedule

# ATT MTU of a Bluetooth 4.0 device: 20 bytes of value.
MTU = 23
ADVERTISING_INTERVAL_MS = 100
# Seconds between two checks whether a slow reader has caught up.
CONGESTION_POLL = 0.002
# Seconds for the central's host to process what it has read. At the end of a link the host discards
# what it has not processed, but a script that ends the link before notification 100 means that the
# host has got 99.
HOST_DELAY = 0.1
# Requests for connection parameters on a connection.
REQUESTS = 3
# Seconds to the next advertisement after a connection in which they were not answered.
WAKE_AFTER = 1.0

LOST = hci.HCI_ErrorCode.CONNECTION_TIMEOUT_ERROR
HUNG_UP = hci.HCI_ErrorCode.REMOTE_USER_TERMINATED_CONNECTION_ERROR
REFUSED = hci.HCI_ErrorCode.CONNECTION_FAILED_TO_BE_ESTABLISHED_ERROR


@dataclass
class Options:
    """Settings of the armband."""

    pace: float = 1.0
    # Whether it ends the connection after the recording's last sample, and advertises no more.
    disconnects: bool = False
    script: Script = field(default_factory=Script)


class Armband:
    """One armband."""

    def __init__(self, radio: Radio, recording: Recording, options: Options, log: EventLog) -> None:
        self._radio = radio
        self._recording = recording
        self._options = options
        self._log = log
        self._refusals = (options.script.habit("refuse") or {"count": 0})["count"]
        # The next notification of the recording; a new connection continues with it.
        self._next = 0
        self._ended = False
        self._connection: Connection | None = None
        self._streaming: asyncio.Task | None = None
        # Seconds from the end of the connection to the next advertisement; never where none.
        self._advertise_after: float | None = 0.0

        self._table = GattTable(self._on_command)
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
        if options.script.habit("hide-subscriptions"):
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
        if chatter := self._options.script.habit("chatter"):
            self._spawn(self._chatter(connection, chatter["ms"] / 1000))
        if asks := self._options.script.habit("ask-parameters"):
            self._spawn(self._ask(connection, asks["first_ms"] / 1000, asks["every_ms"] / 1000))
        self._advertise_after = 0.0

    def _on_disconnection(self, reason: int) -> None:
        self._log.write("disconnected", reason=reason, next=self._next)
        self._connection = None
        self._stop_streaming()
        if self._advertise_after is not None:
            self._spawn(self._advertise_later(self._advertise_after))

    async def _advertise_later(self, seconds: float) -> None:
        await asyncio.sleep(seconds)
        await self._advertise()

    def _disconnect(self, reason: int, advertise_after: float | None) -> None:
        """Ends the connection; advertises again after so many seconds, or never."""
        self._advertise_after = advertise_after
        self._radio.lose_link(reason)

    async def _chatter(self, connection: Connection, period: float) -> None:
        """Notifies without a subscription until the connection streams or ends."""
        while self._connection is connection and self._streaming is None:
            self._send(Packet(FV_DATA, bytes(16)))
            self._log.write("chatter")
            await asyncio.sleep(period)

    async def _ask(self, connection: Connection, first: float, every: float) -> None:
        """Asks for other connection parameters, and ends the connection if that is not answered."""
        self._unanswered.clear()
        await asyncio.sleep(first)
        for _ in range(REQUESTS):
            if self._connection is not connection:
                return
            identifier = self._signals.next_identifier(connection)
            self._unanswered.add(identifier)
            self._log.write("asked", identifier=identifier)
            request = l2cap.L2CAP_Connection_Parameter_Update_Request(
                identifier=identifier, interval_min=16, interval_max=32, latency=0, timeout=200
            )
            self._signals.send_control_frame(connection, l2cap.L2CAP_LE_SIGNALING_CID, request)
            await asyncio.sleep(every)
        if self._connection is connection and self._unanswered:
            self._log.write("unanswered", identifiers=sorted(self._unanswered))
            self._disconnect(HUNG_UP, WAKE_AFTER)

    def _on_signal(self, _connection: Connection, _channel: int, frame: l2cap.L2CAP_Control_Frame) -> None:
        self._unanswered.discard(frame.identifier)
        self._log.write("signal", value=bytes(frame).hex())

    # What the central writes

    def _on_command(self, command: bytes) -> None:
        self._log.write("write", value=command.hex())
        try:
            mode = emg_mode(command)
        except CommandError as error:
            self._log.write("error", reason=str(error), value=command.hex())
            return
        if mode is None:
            return
        if mode not in STREAMING_MODES:
            self._stop_streaming()
        elif self._streaming is None and not self._ended:
            self._log.write("mode", emg=mode)
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
        if late := self._options.script.habit("begin-late"):
            await asyncio.sleep(late["ms"] / 1000)
        schedule = Schedule.starting(clock(), self._options.pace)
        lane = 0
        while await self._recording.has(self._next):
            await asyncio.sleep(schedule.next(clock()))
            while self._radio.congested():
                await asyncio.sleep(CONGESTION_POLL)
            n = self._next
            packet = Packet(EMG_DATA[lane], self._recording.notification(n))
            if step := self._options.script.take(n):
                self._log.write(step["do"], n=n)
                if step["do"] != "corrupt":
                    await self._delivered()
                    reason = LOST if step["do"] == "vanish" else HUNG_UP
                    self._disconnect(reason, step["for_ms"] / 1000)
                    return
                packet = corrupted(n, step["kind"])
            self._next = n + 1
            self._send(packet)
            lane = (lane + 1) % len(EMG_DATA)
        await self._delivered()
        self._ended = True
        self._log.write("end")
        if self._options.disconnects:
            self._disconnect(HUNG_UP, None)

    def _send(self, packet: Packet) -> None:
        if self._connection is None:
            return
        if packet.characteristic is None:
            self._connection.send_l2cap_pdu(packet.channel, packet.value)
            return
        handle = self._table.characteristic(packet.characteristic).handle
        wanted = self._server.subscribers.get(self._connection, {}).get(handle, bytes(2))[0] & 1
        # Without a subscription nothing is sent, except by a script on other characteristics.
        if wanted or packet.characteristic not in EMG_DATA:
            pdu = att.ATT_Handle_Value_Notification(
                attribute_handle=handle, attribute_value=packet.value
            )
            self._server.send_gatt_pdu(self._connection, bytes(pdu))

    async def _delivered(self) -> None:
        """Waits until the central's host has processed all that was sent."""
        while self._radio.waiting() > 0:
            await asyncio.sleep(CONGESTION_POLL)
        await asyncio.sleep(HOST_DELAY)

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
