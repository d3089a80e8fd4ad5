"""The radio link between armband and central: Bumble's link and controllers, changed to behave like
Bluetooth 4.0 where Bumble 0.0.236 does not."""

import asyncio
import copy
import dataclasses
import fcntl
import termios

from bumble import hci
from bumble.controller import Controller
from bumble.link import LocalLink
from bumble.transport.common import Transport

# The kernel accounts nearly 800 bytes for a packet: room for five, as in a real controller.
CONGESTION = 4096


class PublicAddressLink(LocalLink):
    """A link whose packets have the address of the connection as their source.

    Bumble's always uses the random address, so packets of a peripheral with a public address are
    dropped as "no connection".
    """

    def send_acl_data(self, sender_controller, destination_address, transport, data) -> None:
        connection = sender_controller.le_connections.get(destination_address)
        receiver = self.find_le_controller(destination_address)
        if connection is None or receiver is None:
            return
        asyncio.get_running_loop().call_soon(
            receiver.on_link_acl_data, connection.self_address, transport, data
        )


# The signal strength of an armband unless another one is given, dBm.
RSSI = -50


class LegacyController(Controller):
    """A controller without extended advertising, whose cancel and reset are complete."""

    # With the feature set, Bumble answers a legacy scan with extended reports, which a legacy host
    # does not receive. The armband is a Bluetooth 4.0 device.
    le_features = Controller.le_features & ~hci.LeFeatureMask.LE_EXTENDED_ADVERTISING

    def __init__(self, *args, **kwargs) -> None:
        # Signal strength by address: Bumble's is the same for all.
        self.rssi: dict[hci.Address, int] = {}
        super().__init__(*args, **kwargs)

    def send_hci_packet(self, packet: hci.HCI_Packet) -> None:
        if isinstance(packet, hci.HCI_LE_Advertising_Report_Event):
            reports = [
                dataclasses.replace(report, rssi=self.rssi.get(report.address, RSSI))
                for report in packet.reports
            ]
            packet = hci.HCI_LE_Advertising_Report_Event(reports)
        super().send_hci_packet(packet)

    def on_hci_le_create_connection_cancel_command(self, _command):
        # Bumble's keeps the pending connection, so that every later one is "disallowed".
        pending = self.pending_le_connection
        if pending is None:
            return hci.HCI_StatusReturnParameters(hci.HCI_ErrorCode.COMMAND_DISALLOWED_ERROR)
        self.pending_le_connection = None
        cancelled = hci.HCI_LE_Connection_Complete_Event(
            status=hci.HCI_ErrorCode.UNKNOWN_CONNECTION_IDENTIFIER_ERROR,
            connection_handle=0,
            role=hci.Role.CENTRAL,
            peer_address_type=pending.peer_address.address_type,
            peer_address=pending.peer_address,
            connection_interval=0,
            peripheral_latency=0,
            supervision_timeout=0,
            central_clock_accuracy=0,
        )
        # After the Command Complete, which is sent when this returns.
        asyncio.get_running_loop().call_soon(self.send_hci_packet, cancelled)
        return hci.HCI_StatusReturnParameters(hci.HCI_ErrorCode.SUCCESS)

    def on_hci_reset_command(self, command):
        # Bumble's clears nothing: a central that restarts would find its old connection.
        self.le_scan_enable = False
        self.pending_le_connection = None
        for connection in list(self.le_connections.values()):
            peer = self.link.find_le_controller(connection.peer_address)
            del self.le_connections[connection.peer_address]
            if peer and (theirs := peer.le_connections.get(connection.self_address)):
                peer.on_le_disconnected(theirs, hci.HCI_ErrorCode.CONNECTION_TIMEOUT_ERROR)
        return super().on_hci_reset_command(command)


class Radio:
    """Both ends of the link: the armband's controller and the central's."""

    def __init__(self, armband_address: str) -> None:
        link = PublicAddressLink()
        address = hci.Address(armband_address, hci.Address.PUBLIC_DEVICE_ADDRESS)
        self.armband = LegacyController("armband", link=link, public_address=address)
        self.central = LegacyController("central", link=link)
        self._sink = None

    def beside(self, armband_address: str, rssi: int) -> "Radio":
        """The same place with another armband in it, which the central hears with this strength."""
        other = copy.copy(self)
        address = hci.Address(armband_address, hci.Address.PUBLIC_DEVICE_ADDRESS)
        link = self.central.link
        other.armband = LegacyController("another armband", link=link, public_address=address)
        self.central.rssi[address] = rssi
        return other

    def serve(self, transport: Transport) -> None:
        """Connects the central's controller to a host on an H4 stream."""
        transport.source.set_packet_sink(self.central)
        self.central.host = transport.sink
        self._sink = transport.sink

    def lose_link(self, reason: int) -> None:
        """Ends the connection on both sides."""
        for controller in (self.armband, self.central):
            for connection in list(controller.le_connections.values()):
                controller.on_le_disconnected(connection, reason)

    def waiting(self) -> int:
        """Bytes that the central's host has not read yet, as accounted by the kernel."""
        stream = getattr(self._sink, "transport", None)
        if stream is None:
            return 0
        waiting = bytearray(4)
        fcntl.ioctl(stream.get_extra_info("socket").fileno(), termios.TIOCOUTQ, waiting)
        return int.from_bytes(waiting, "little") + stream.get_write_buffer_size()

    def congested(self) -> bool:
        """Whether the central's host is so far behind that the armband has to wait.

        A real link layer stops acknowledging then. Bumble's would queue packets without limit and
        deliver them in one burst when a stalled reader continues.
        """
        return self.waiting() > CONGESTION
