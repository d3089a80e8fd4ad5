//! The host on the other end of the cable, as a test plays it.

use super::{EVENTS_EP0SETUP, EVENTS_USBRESET, LOWPOWER, PACKET, SETUP, USBADDR, Usbd};
use crate::chip::Chip;
use crate::chip::bus::{Bus, Peripheral as _};

/// EVENTCAUSE: bits of the bus (6.35.13).
const SUSPEND: u32 = 1 << 8;
const RESUME: u32 = 1 << 9;
/// The request that the peripheral answers itself (6.35.9).
const SET_ADDRESS: u8 = 5;

#[derive(Clone, Default, Debug)]
pub struct Control {
    /// Bytes that it sent, or those that have come.
    pub data: Vec<u8>,
    /// True once it is over.
    pub is_over: bool,
    /// True if the device refused it.
    pub is_stalled: bool,
}

impl Chip {
    /// The device, as the host sees it.
    pub fn usb(&self) -> &Usbd {
        &self.usbd
    }

    /// The host does something.
    fn as_host(&mut self, act: impl FnOnce(&mut Usbd, &mut Bus)) {
        act(&mut self.usbd, &mut self.bus);
        self.usbd.schedule(&self.bus);
        self.bus.attention = true;
        self.settle();
    }

    pub fn reset_usb(&mut self) {
        self.as_host(|usb, bus| {
            usb.is_suspended = false;
            usb.registers.put(LOWPOWER, 0);
            usb.registers.put(USBADDR, 0);
            usb.raise(EVENTS_USBRESET, bus);
        });
    }

    /// Begins a control transfer: its eight bytes, and those that the host sends.
    pub fn begin_control(&mut self, setup: [u8; 8], data: &[u8]) {
        self.as_host(|usb, bus| {
            for (place, byte) in (0..).zip(setup) {
                usb.registers.put(SETUP + 4 * place, byte.into());
            }
            if setup[..2] == [0, SET_ADDRESS] {
                usb.registers.put(USBADDR, setup[2].into());
            }
            usb.control = Control {
                data: data.to_vec(),
                ..Control::default()
            };
            usb.raise(EVENTS_EP0SETUP, bus);
        });
    }

    /// Sends packets to an endpoint, when it takes them.
    pub fn send_usb(&mut self, endpoint: usize, bytes: &[u8]) {
        self.as_host(|usb, _| {
            let packets = bytes.chunks(PACKET as usize);
            usb.to_send
                .extend(packets.map(|packet| (endpoint, packet.to_vec())));
        });
    }

    /// Takes packets from now on, or no longer.
    pub fn read_usb(&mut self, reads: bool) {
        self.as_host(|usb, _| usb.reads = reads);
    }

    /// Asks these interrupt endpoints for packets from now on: a bit each.
    pub fn poll_usb(&mut self, endpoints: u32) {
        self.as_host(|usb, _| usb.polled = endpoints);
    }

    /// Suspends the bus, or resumes it, which wakes the device.
    pub fn suspend_usb(&mut self, is_suspended: bool) {
        let cause = if is_suspended { SUSPEND } else { RESUME };
        self.as_host(|usb, bus| {
            usb.is_suspended = is_suspended;
            if is_suspended {
                (usb.transfer, usb.frame) = (None, None);
            } else {
                usb.registers.put(LOWPOWER, 0);
            }
            usb.cause(cause, bus);
        });
    }

    /// Plugs the cable, or unplugs it: the supply of the bus comes or goes.
    pub fn plug_usb(&mut self, is_plugged: bool) {
        self.clock_and_power.plug(is_plugged, &mut self.bus);
        if !is_plugged {
            self.usbd.reads = false;
            self.usbd.polled = 0;
            self.usbd.is_suspended = false;
            self.usbd.to_send.clear();
        }
        self.settle();
    }
}
