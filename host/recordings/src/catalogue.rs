//! Addresses and licences of the published data sets, as far as known (docs/recordings.md, docs/licences.md).

use crate::DataSet;

/// Address from which a data set is obtained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Address {
    /// A record of Zenodo, by its number: it states its files, their checksums and its licence.
    Zenodo(u32),
    /// A repository of GitHub (`owner/name`), as an archive of its default branch, which is made on demand: it has no
    /// checksum and cannot be resumed.
    GitHub(&'static str),
    /// An archive, by its path on UCI's server.
    Uci(&'static str),
    /// No download for a program; what to do instead.
    ByHand(&'static str),
}

/// A published data set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// The set.
    pub data_set: DataSet,
    /// Page for people.
    pub page: &'static str,
    /// Address for programs.
    pub address: Address,
    /// Licence, and where that is stated.
    pub licence: &'static str,
}

/// Licence of sets for which nobody states one.
const NONE_STATED: &str = "none stated in the copy that was read: without a licence there is no permission to redistribute; read the page before use";

/// Sets of which only repacked copies were read.
const REPACKED: Address = Address::ByHand(
    "save each recording as an int8 npy array, named as docs/recordings.md says in the row of the set",
);

/// Every published set, in the order of [`DataSet::ALL`].
pub const SOURCES: [Source; 20] = [
    Source {
        data_set: DataSet::Roshambo,
        page: "https://doi.org/10.5281/zenodo.3194792",
        address: Address::Zenodo(3_194_792),
        licence: "none stated in the copy that was read; the record on Zenodo states one",
    },
    Source {
        data_set: DataSet::SsStm,
        page: "https://github.com/Suguru55/SS-STM_for_MyoDatasets",
        address: Address::GitHub("Suguru55/SS-STM_for_MyoDatasets"),
        licence: "Apache-2.0 (LICENSE in the data set): use and redistribution with notice",
    },
    Source {
        data_set: DataSet::CoteAllard,
        page: "https://github.com/UlysseCoteAllard/MyoArmbandDataset",
        address: Address::GitHub("UlysseCoteAllard/MyoArmbandDataset"),
        licence: "GPL-3.0 (LICENSE in the data set): redistribution, changed or not, under GPL-3.0",
    },
    Source {
        data_set: DataSet::MyoReadings,
        page: "https://github.com/aljazfrancic/myo-readings-dataset",
        address: Address::GitHub("aljazfrancic/myo-readings-dataset"),
        licence: "MIT (LICENSE in the data set): use and redistribution with notice",
    },
    Source {
        data_set: DataSet::OneSubjectMyo,
        page: "https://github.com/LibEMG/OneSubjectMyoDataset",
        address: Address::GitHub("LibEMG/OneSubjectMyoDataset"),
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::WangMyo,
        page: "https://github.com/ZheWang98/Open-access-dataset-of-sEMG",
        address: Address::GitHub("ZheWang98/Open-access-dataset-of-sEMG"),
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::MyoRps,
        page: "https://github.com/michidk/myo-dataset",
        address: Address::GitHub("michidk/myo-dataset"),
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::Myoup,
        page: "https://github.com/tsagkas/MyoUP_dataset",
        address: Address::GitHub("tsagkas/MyoUP_dataset"),
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::Epn,
        page: "https://github.com/laboratorioAI/HGR_AMR_ROB_QLEARNING",
        address: Address::ByHand(
            "its labels are MATLAB objects: save each recording as userN/training/001_fist.npy (docs/recordings.md, epn)",
        ),
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::UciGestures,
        page: "https://archive.ics.uci.edu/dataset/481/emg+data+for+gestures",
        address: Address::Uci("static/public/481/emg+data+for+gestures.zip"),
        licence: "none stated in the copy that was read; UCI lists its sets under CC BY 4.0, which was not checked",
    },
    Source {
        data_set: DataSet::Ciil,
        page: "https://github.com/LibEMG/CIILData",
        address: REPACKED,
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::Epn10,
        page: "https://github.com/laboratorioAI/HandRobotic",
        address: REPACKED,
        licence: "GPL-3.0 (of the repository): redistribution, changed or not, under GPL-3.0",
    },
    Source {
        data_set: DataSet::DutraMoves,
        page: "https://github.com/brunoodutra/My_Thesis",
        address: REPACKED,
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::Pangestu,
        page: "https://github.com/fpangestu/myo-project",
        address: REPACKED,
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::Dideakay,
        page: "https://github.com/dideakay/emg-classification-myo",
        address: REPACKED,
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::Adl,
        page: "https://github.com/eeddy/DiscreteMCI",
        address: REPACKED,
        licence: NONE_STATED,
    },
    Source {
        data_set: DataSet::Psl,
        page: "https://github.com/noemiko/myo-sign-language",
        address: REPACKED,
        licence: "MIT",
    },
    Source {
        data_set: DataSet::Libras,
        page: "https://github.com/pernambucano/myo_libras",
        address: REPACKED,
        licence: "MIT",
    },
    Source {
        data_set: DataSet::EmgEpn612,
        page: "https://doi.org/10.5281/zenodo.4421500",
        address: Address::Zenodo(4_421_500),
        licence: "not read; the record on Zenodo states one",
    },
    Source {
        data_set: DataSet::ReactEmg,
        page: "https://github.com/roamlab/reactemg",
        address: Address::ByHand("the page has the links"),
        licence: "not read: read the terms of each part before use",
    },
];

/// The source of a set by its name; none if there is no such set, or it is not published.
pub fn source(name: &str) -> Option<&'static Source> {
    SOURCES.iter().find(|own| own.data_set.name() == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_published_set_has_a_source_and_the_page_of_recordings_has_its_address() {
        let published = DataSet::ALL
            .into_iter()
            .filter(|set| *set != DataSet::Synthetic);
        assert_eq!(
            published.collect::<Vec<_>>(),
            SOURCES.map(|own| own.data_set)
        );
        let page = include_str!("../../../docs/recordings.md");
        let licences = include_str!("../../../docs/licences.md");
        for own in SOURCES {
            let row = page.lines().find(|line| {
                let name = own.data_set.name();
                line.starts_with(&format!("| `{name}` |"))
            });
            let row = row.unwrap_or_else(|| panic!("no row of {}", own.data_set.name()));
            assert!(row.contains(own.page), "{row} has no {}", own.page);
            // Licences by name are those that the page of licences has read in the copies.
            let first = own.licence.split(' ').next().unwrap();
            if ["Apache-2.0", "GPL-3.0", "MIT"].contains(&first) {
                assert!(licences.contains(&format!("| {first} | `LICENSE` in the data set |")));
            }
        }
    }
}
