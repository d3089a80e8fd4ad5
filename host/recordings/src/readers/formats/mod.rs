//! One reader per published format: bytes or text of a file in, recordings or damage out.

pub(crate) mod cote_allard;
pub(crate) mod emg_epn;
pub(crate) mod epn;
pub(crate) mod libemg;
pub(crate) mod myo_readings;
pub(crate) mod myo_rps;
pub(crate) mod myoup;
pub(crate) mod one_subject_myo;
pub mod react_emg;
pub(crate) mod roshambo;
pub(crate) mod ss_stm;
pub(crate) mod uci_gestures;
pub(crate) mod wang_myo;
