//! Downloads of a data set.

use std::fmt::Display;
use std::io::Read as _;

use serde::Deserialize;

use super::client::{agent, request_error};
use super::error::FetchError;
use crate::catalogue::{Address, Source};

/// Maximum size of a Zenodo record, in bytes.
const RECORD: u64 = 4 << 20;

/// Zenodo's server; a test has its own.
pub const ZENODO: &str = "https://zenodo.org";

/// One file to download.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Download {
    /// Address.
    pub url: String,
    /// Name on disk, without a folder.
    pub file: String,
    /// Length in bytes, if it is published.
    pub size: Option<u64>,
    /// MD5, such as `md5:0cc1…`, if it is published.
    pub checksum: Option<String>,
}

/// Downloads of a data set, and their licence.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Licence that the publisher states with the files, if there is one.
    pub stated_licence: Option<String>,
    /// The files; empty for what is obtained by hand.
    pub downloads: Vec<Download>,
}

/// Plans the downloads of a data set. Zenodo, at the address `zenodo`, is asked for its record.
///
/// # Errors
/// When Zenodo cannot be reached, or its record is invalid.
pub fn plan(source: &Source, zenodo: &str) -> Result<Plan, FetchError> {
    match &source.address {
        Address::Zenodo(number) => record(zenodo, *number, &source.page),
        Address::Archive(url) => Ok(Plan {
            stated_licence: None,
            downloads: vec![Download {
                url: url.clone(),
                file: format!("{}.zip", source.name),
                size: None,
                checksum: None,
            }],
        }),
        Address::ByHand(_) => Ok(Plan::default()),
    }
}

/// The part of a record that is read. Source: developers.zenodo.org, *Records*.
#[derive(Deserialize)]
struct Record {
    files: Vec<RecordFile>,
    #[serde(default)]
    metadata: serde_json::Value,
}

#[derive(Deserialize)]
struct RecordFile {
    key: String,
    size: u64,
    #[serde(default)]
    checksum: String,
    links: Links,
}

#[derive(Deserialize)]
struct Links {
    #[serde(rename = "self")]
    own: String,
}

/// Plans the downloads of a record of Zenodo.
fn record(server: &str, number: u32, page: &str) -> Result<Plan, FetchError> {
    let url = format!("{server}/api/records/{number}");
    let response = agent(&url).get(&url).call();
    let mut response = response.map_err(|error| request_error(&url, &error))?;
    let status = response.status().as_u16();
    if status != 200 {
        return Err(FetchError::status(&url, status, page));
    }
    let mut text = String::new();
    let mut body = response.body_mut().as_reader().take(RECORD);
    let refused = |reason: &dyn Display| {
        FetchError::new(format!("{url}: expected a record of Zenodo: {reason}"))
    };
    body.read_to_string(&mut text)
        .map_err(|error| refused(&error))?;
    let record: Record = serde_json::from_str(&text).map_err(|error| refused(&error))?;
    if record.files.is_empty() {
        return Err(refused(&"it has no files, or not for everybody"));
    }
    let downloads = record.files.into_iter().map(|file| {
        let named = !file.key.is_empty() && !file.key.starts_with('.');
        if !named || file.key.contains(['/', '\\', ':', '\0']) {
            return Err(refused(&format!("a file is named {:?}", file.key)));
        }
        Ok(Download {
            url: file.links.own,
            size: Some(file.size),
            checksum: Some(file.checksum.to_ascii_lowercase())
                .filter(|own| own.starts_with("md5:")),
            file: file.key,
        })
    });
    Ok(Plan {
        downloads: downloads.collect::<Result<_, _>>()?,
        stated_licence: record.metadata["license"]["id"].as_str().map(str::to_owned),
    })
}
