//! A Bluetooth controller whose host is given only packets that it takes ([`attribute_pdu`]), or refuses ([`signaling`]).

use bt_hci::{
    ControllerToHostPacket,
    cmd::{self, AsyncCmd, SyncCmd},
    controller::{Controller, ControllerCmdAsync, ControllerCmdSync},
    data::{AclBroadcastFlag, AclPacket, AclPacketBoundary, IsoPacket, SyncPacket},
};
use embedded_io::ErrorType;
use shared::myo::{attribute_pdu, signaling};

/// The controller itself, but for what it receives.
pub struct Guarded<C>(pub C);

/// Buffer of the controller, and one for a packet that the host gets in place of a received one.
pub struct Buffer<B> {
    received: B,
    refused: [u8; signaling::MOST_BYTES],
}

/// Packet that the host gets. In place of a signal it gets a signal that it refuses; in place of another that it may not be
/// given an empty one of a kind that it counts and ignores: the host owes the controller an account of every packet.
fn taken<'a>(packet: AclPacket<'a>, refused: &'a mut [u8; signaling::MOST_BYTES]) -> AclPacket<'a> {
    let boundary = packet.boundary_flag();
    let first = boundary == AclPacketBoundary::FirstFlushable;
    if !first || attribute_pdu::may_be_taken(packet.data()) {
        return packet;
    }
    let (boundary, data) = match signaling::refused(packet.data(), refused) {
        Some(signal) => (boundary, signal),
        None => (AclPacketBoundary::Complete, &[][..]),
    };
    AclPacket::new(
        packet.handle(),
        boundary,
        AclBroadcastFlag::PointToPoint,
        data,
    )
}

impl<C: ErrorType> ErrorType for Guarded<C> {
    type Error = C::Error;
}

impl<C: Controller> Controller for Guarded<C> {
    type Buffer<'a> = Buffer<C::Buffer<'a>>;

    fn alloc_buf(&self) -> Result<Self::Buffer<'_>, Self::Error> {
        Ok(Buffer {
            received: self.0.alloc_buf()?,
            refused: [0; signaling::MOST_BYTES],
        })
    }

    async fn write_acl_data(&self, packet: &AclPacket<'_>) -> Result<(), Self::Error> {
        self.0.write_acl_data(packet).await
    }

    async fn write_sync_data(&self, packet: &SyncPacket<'_>) -> Result<(), Self::Error> {
        self.0.write_sync_data(packet).await
    }

    async fn write_iso_data(&self, packet: &IsoPacket<'_>) -> Result<(), Self::Error> {
        self.0.write_iso_data(packet).await
    }

    async fn read<'a>(
        &self,
        buffer: &'a mut Self::Buffer<'_>,
    ) -> Result<ControllerToHostPacket<'a>, Self::Error> {
        let Buffer { received, refused } = buffer;
        Ok(match self.0.read(received).await? {
            ControllerToHostPacket::Acl(packet) => {
                ControllerToHostPacket::Acl(taken(packet, refused))
            }
            other => other,
        })
    }
}

impl<T: SyncCmd + ?Sized, C: ControllerCmdSync<T>> ControllerCmdSync<T> for Guarded<C> {
    async fn exec(&self, command: &T) -> Result<T::Return, cmd::Error<Self::Error>> {
        self.0.exec(command).await
    }
}

impl<T: AsyncCmd + ?Sized, C: ControllerCmdAsync<T>> ControllerCmdAsync<T> for Guarded<C> {
    async fn exec(&self, command: &T) -> Result<(), cmd::Error<Self::Error>> {
        self.0.exec(command).await
    }
}
