//! A reader for each format that no description reads: bytes or text of a file in, recordings or damage out.

pub(crate) mod emg_epn;
pub(crate) mod libemg;
pub(crate) mod myo_readings;
pub(crate) mod one_subject_myo;
pub mod react_emg;
pub(crate) mod uci_gestures;

use crate::recording::DataSet;

impl DataSet {
    /// Properties that a file is recognised by as one of the set.
    pub const fn recognised_by(self) -> &'static str {
        match self {
            Self::Roshambo => {
                "subject*_emg.npy (n, 8) of integers with *_ann.npy, a gesture's name per sample"
            }
            Self::SsStm => "subN/MxTy.csv, eight decimals a row (count / 128)",
            Self::CoteAllard => "classe_N.dat, int16, eight values a sample",
            Self::MyoReadings => {
                "12345-1/G.txt, eight integers and the label a row; below a folder left_hand mirrored"
            }
            Self::OneSubjectMyo => "its published samples, classes in metadata.json",
            Self::WangMyo => {
                "EMG_SN/1_fist.npy (n, 8), or EMG_SN/..._1_x.mat with data (count / 128)"
            }
            Self::MyoRps => "csv with index,timestamp,0,...,7, named sN_r_1-rock-0-emg.csv",
            Self::Myoup => "sN/e2_emg.npy with e2_ann.npy, or sNe2.mat with emg and pulse",
            Self::Epn => "userN/training/001_fist.npy (n, 8)",
            Self::UciGestures => "01/1_raw_data_*.txt with time, channel1..channel8, class",
            Self::Ciil => "ciil/min00/train_R0_open.npy (n, 8)",
            Self::Epn10 => "epn10/p01/testing_close_00.npy (n, 8)",
            Self::DutraMoves => "dutra-moves/p01/s1_emg.npy (n, 8) with s1_ann.npy",
            Self::Pangestu => "pangestu/p01/close_T1.npy (n, 8)",
            Self::Dideakay => "dideakay/p1/close_1.npy (n, 8)",
            Self::Adl => "adl/p01/type.npy (n, 8)",
            Self::Psl => "psl/p00/w01_01.npy (n, 8)",
            Self::Libras => "libras/p1/C_1.npy (n, 8)",
            Self::EmgEpn612 => "JSON per user with trainingSamples, testingSamples",
            Self::ReactEmg => {
                "your own: a table with eight channels by name (emg_0..emg_7, label in gt), what a recordings.toml \
                 describes, or LibEMG's csv with metadata.json or collection_details.json; and ReactEMG's sN_*.npy (n, 9)"
            }
            Self::Synthetic => "as react-emg, with a column synthetic_muscle",
        }
    }
}
