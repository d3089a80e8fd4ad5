//! A Bluetooth controller whose host is given only packets that it takes ([`attribute_pdu`]).

use bt_hci::{
    ControllerToHostPacket,
    cmd::{self, AsyncCmd, SyncCmd},
    controller::{Controller, ControllerCmdAsync, ControllerCmdSync},
    data::{AclBroadcastFlag, AclPacket, AclPacketBoundary, IsoPacket, SyncPacket},
};
use embedded_io::ErrorType;
use shared::myo::attribute_pdu;

/// The controller itself, but for what it receives.
pub struct Guarded<C>(pub C);

/// Packet that the host gets. In the place of one that it may not be given it gets an empty one of a kind
/// that it counts and ignores: the host owes the controller an account of every packet.
fn taken(packet: AclPacket<'_>) -> AclPacket<'_> {
    let first = packet.boundary_flag() == AclPacketBoundary::FirstFlushable;
    if !first || attribute_pdu::may_be_taken(packet.data()) {
        return packet;
    }
    AclPacket::new(
        packet.handle(),
        AclPacketBoundary::Complete,
        AclBroadcastFlag::PointToPoint,
        &[],
    )
}

impl<C: ErrorType> ErrorType for Guarded<C> {
    type Error = C::Error;
}

impl<C: Controller> Controller for Guarded<C> {
    type Buffer<'a> = C::Buffer<'a>;

    fn alloc_buf(&self) -> Result<Self::Buffer<'_>, Self::Error> {
        self.0.alloc_buf()
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
        Ok(match self.0.read(buffer).await? {
            ControllerToHostPacket::Acl(packet) => ControllerToHostPacket::Acl(taken(packet)),
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
