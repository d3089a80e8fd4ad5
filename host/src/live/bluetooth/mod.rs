//! An armband over this computer's own Bluetooth, without a board.
//!
//! ```text
//! web::armband  -- actions -->  adapter (btleplug)  -- radio -->  armband
//!               <-- heard ----
//! ```

mod adapter;
mod link;

pub(super) use self::adapter::open;
