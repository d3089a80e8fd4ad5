//! Numbers of the SoftDevice's supervisor calls, events and answers, as its headers have them (nrf_sdm.h, nrf_soc.h, ble.h,
//! ble_gap.h, ble_gattc.h and nrf_error.h of S140 7.3.0; those of S132 7.3.0 are the same).

/// Supervisor calls.
pub mod call {
    pub const SOFTDEVICE_ENABLE: u8 = 16;
    pub const FLASH_PAGE_ERASE: u8 = 40;
    pub const FLASH_WRITE: u8 = 41;
    pub const CLOCK_HFCLK_REQUEST: u8 = 66;
    pub const EVT_GET: u8 = 75;
    pub const BLE_ENABLE: u8 = 96;
    pub const BLE_EVT_GET: u8 = 97;
    pub const BLE_CFG_SET: u8 = 105;
    pub const GAP_WHITELIST_SET: u8 = 110;
    pub const GAP_CONN_PARAM_UPDATE: u8 = 117;
    pub const GAP_DISCONNECT: u8 = 118;
    pub const GAP_TX_POWER_SET: u8 = 119;
    pub const GAP_SCAN_START: u8 = 138;
    pub const GAP_SCAN_STOP: u8 = 139;
    pub const GAP_CONNECT: u8 = 140;
    pub const GAP_CONNECT_CANCEL: u8 = 141;
    pub const GAP_DATA_LENGTH_UPDATE: u8 = 144;
    pub const GATTC_READ: u8 = 161;
    pub const GATTC_WRITE: u8 = 163;
}

/// Answers.
pub mod answer {
    pub const SUCCESS: u32 = 0;
    pub const NOT_FOUND: u32 = 5;
    pub const INVALID_STATE: u32 = 8;
    pub const BUSY: u32 = 17;
    pub const INVALID_CONN_HANDLE: u32 = 0x3002;
}

/// Events of the link.
pub mod event {
    pub const CONNECTED: u16 = 16;
    pub const DISCONNECTED: u16 = 17;
    pub const CONN_PARAM_UPDATE: u16 = 18;
    pub const TIMEOUT: u16 = 27;
    pub const ADV_REPORT: u16 = 29;
    pub const CONN_PARAM_UPDATE_REQUEST: u16 = 31;
    pub const READ_RSP: u16 = 54;
    pub const WRITE_RSP: u16 = 56;
    pub const HVX: u16 = 57;
    /// Events of the chip: the end of an operation of flash.
    pub const FLASH_SUCCESS: u32 = 2;
    pub const FLASH_ERROR: u32 = 3;
}

/// Answers of the other side's attributes: 0x100 and the protocol's own number.
pub mod attribute {
    pub const READ_NOT_PERMITTED: u16 = 0x102;
    pub const WRITE_NOT_PERMITTED: u16 = 0x103;
}
