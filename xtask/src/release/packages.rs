//! Packages that are linked into the files of a release, with their licences.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use serde_json::{Value, json};

use crate::{cargo, workspace};

/// Packages, features and targets of what each kind of file links.
const LINKED: [(&str, &str); 6] = [
    (
        "boards with USB",
        "myointent-firmware --no-default-features --features=xiao --target=thumbv7em-none-eabihf",
    ),
    (
        "images with S140",
        "myointent-firmware --no-default-features --features=nrf52840,radio-softdevice --target=thumbv7em-none-eabihf",
    ),
    (
        "images with S132",
        "myointent-firmware --no-default-features --features=nrf52832,radio-softdevice --target=thumbv7em-none-eabihf",
    ),
    ("program", "myointent --target=all"),
    ("wheel", "myointent-python --target=all"),
    ("page", "myointent-web --target=wasm32-unknown-unknown"),
];

/// Files without which nothing may be distributed: what Nordic's licence and that of its library ask for.
const NEEDED: [(&str, &str); 4] = [
    ("nrf-sdc-sys", "license"),
    ("nrf-mpsl-sys", "license-attribution"),
    ("nrf-softdevice-s140", "license-nordic"),
    ("nrf-softdevice-s132", "license-nordic"),
];

/// Licence of a package that names none, only a file.
const OWN: &str = "its own";

/// Largest file in bytes that may be a licence.
const LARGEST: u64 = 100 << 10;

/// A package from a registry.
#[derive(Debug)]
pub struct Package {
    name: String,
    version: String,
    licence: String,
    authors: Vec<String>,
    folder: PathBuf,
    /// Kinds of files that it is linked into.
    part_of: BTreeSet<&'static str>,
}

/// Returns the packages of registries that are linked, by name and version.
pub fn linked() -> Result<Vec<Package>> {
    let mut part_of: BTreeMap<(String, String), BTreeSet<&'static str>> = BTreeMap::new();
    for (file, arguments) in LINKED {
        let tree = format!("tree --locked --edges=normal --prefix=none --package {arguments}");
        for line in output(&tree)?.lines() {
            let mut words = line.split(' ');
            if let (Some(name), Some(version)) = (words.next(), words.next()) {
                let version = version.trim_start_matches('v').to_owned();
                part_of
                    .entry((name.to_owned(), version))
                    .or_default()
                    .insert(file);
            }
        }
    }
    let all = output("metadata --locked --all-features --format-version=1")?;
    let all: Value = serde_json::from_str(&all)?;
    let text = |package: &Value, key: &str| package[key].as_str().unwrap_or_default().to_owned();
    let mut found = Vec::new();
    for package in all["packages"].as_array().context("no packages")? {
        let key = (text(package, "name"), text(package, "version"));
        // The project's own have no source.
        if let Some(part_of) = part_of
            .remove(&key)
            .filter(|_| package["source"].is_string())
        {
            let authors = package["authors"].as_array().into_iter().flatten();
            let folder = PathBuf::from(text(package, "manifest_path"));
            found.push(Package {
                name: key.0,
                version: key.1,
                licence: match package["license"].as_str() {
                    Some(licence) => licence.replace(" / ", "/").replace('/', " OR "),
                    None => OWN.to_owned(),
                },
                authors: authors
                    .filter_map(Value::as_str)
                    .map(str::to_owned)
                    .collect(),
                folder: folder.parent().context("no folder")?.to_owned(),
                part_of,
            });
        }
    }
    ensure!(
        part_of.is_empty(),
        "cargo does not know {:?}",
        part_of.keys()
    );
    found.sort_by(|a, b| (&a.name, &a.version).cmp(&(&b.name, &b.version)));
    Ok(found)
}

fn output(words: &str) -> Result<String> {
    let output = cargo().args(words.split(' ')).output();
    let output = output.context("cargo cannot be run")?;
    let error = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "cargo {words}: {error}");
    Ok(String::from_utf8(output.stdout)?)
}

/// Text with the project's licence, a list of the packages, and each text that they hold once, with the files that hold it.
pub fn licences(linked: &[Package]) -> Result<String> {
    let mut text = String::from("myointent\n\n");
    for own in ["LICENSE-MIT", "LICENSE-APACHE"] {
        text += &fs::read_to_string(workspace().join(own))?;
        text.push('\n');
    }
    text += "\n======== Packages, whose sources are at https://crates.io\n\n\
             The standard library of Rust: MIT OR Apache-2.0, by The Rust Project Contributors\n";
    let mut texts: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in linked {
        let Package {
            name,
            version,
            licence,
            ..
        } = package;
        let _ = write!(text, "{name} {version}: {licence}");
        let mut files = Vec::new();
        collect(&package.folder, &mut files)?;
        if files.is_empty() {
            let _ = write!(
                text,
                ", no text in the package; authors: {}",
                package.authors.join(", ")
            );
        }
        text.push('\n');
        for file in files {
            let holder = file.strip_prefix(&package.folder)?.display();
            let bytes = fs::read(&file)?;
            let content = String::from_utf8_lossy(&bytes).replace("\r\n", "\n");
            texts
                .entry(content)
                .or_default()
                .insert(format!("{name}/{holder}"));
        }
    }
    for (package, file) in NEEDED {
        let has = |holder: &String| {
            let holder = holder.to_lowercase();
            holder.starts_with(package) && holder.contains(file)
        };
        let is_there = texts.values().flatten().any(has);
        ensure!(is_there, "no {file} of {package}");
    }
    for (content, holders) in texts {
        let holders: Vec<_> = holders.into_iter().collect();
        let _ = write!(text, "\n======== {}\n\n{content}\n", holders.join(", "));
    }
    Ok(text)
}

/// Collects the licences in a folder and those below, which are of libraries that a package brings.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().to_lowercase();
        let metadata = entry.metadata()?;
        let is_licence = ["license", "licence", "copying", "notice", "unlicense"]
            .iter()
            .any(|start| name.starts_with(start));
        if metadata.is_dir() {
            collect(&entry.path(), files)?;
        } else if is_licence && metadata.len() < LARGEST {
            files.push(entry.path());
        }
    }
    files.sort();
    Ok(())
}

/// Software bill of materials, CycloneDX 1.5.
pub fn bill(linked: &[Package]) -> String {
    let component = |package: &Package| {
        let Package {
            name,
            version,
            licence,
            ..
        } = package;
        let part_of = package.part_of.iter();
        json!({
            "type": "library",
            "bom-ref": format!("pkg:cargo/{name}@{version}"),
            "name": name,
            "version": version,
            "purl": format!("pkg:cargo/{name}@{version}"),
            "licenses": if licence == OWN { json!([{ "license": { "name": OWN } }]) } else { json!([{ "expression": licence }]) },
            "properties": part_of.map(|file| json!({ "name": "myointent:linked-into", "value": file })).collect::<Vec<_>>(),
        })
    };
    let bill = json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": { "component": {
            "type": "application",
            "name": "myointent",
            "version": env!("CARGO_PKG_VERSION"),
            "licenses": [{ "expression": env!("CARGO_PKG_LICENSE") }],
        } },
        "components": linked.iter().map(component).collect::<Vec<_>>(),
    });
    format!("{bill:#}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Packages with the same text, one without a text, and those that need one of Nordic.
    fn packages(root: &Path) -> Vec<Package> {
        let held = |name: &str| match name {
            "silent" => "README",
            "nrf-mpsl-sys" => "third_party/LICENSE-ATTRIBUTION.txt",
            "nrf-softdevice-s132" | "nrf-softdevice-s140" => "LICENSE-NORDIC",
            _ => "LICENSE",
        };
        let names = ["one", "two", "silent"].into_iter();
        let names = names.chain(NEEDED.map(|(name, _)| name));
        names
            .map(|name| {
                let file = root.join(name).join(held(name));
                fs::create_dir_all(file.parent().unwrap()).unwrap();
                fs::write(file, "Permission is granted\n").unwrap();
                Package {
                    name: name.to_owned(),
                    version: "1.2.3".to_owned(),
                    licence: if name == "one" { OWN } else { "MIT" }.to_owned(),
                    authors: vec!["Ada".to_owned()],
                    folder: root.join(name),
                    part_of: BTreeSet::from(["page"]),
                }
            })
            .collect()
    }

    #[test]
    fn each_text_is_there_once_and_none_that_nordic_asks_for_may_be_missing() {
        let root = std::env::temp_dir().join(format!("xtask-licences-{}", std::process::id()));
        let packages = packages(&root);
        let text = licences(&packages).unwrap();
        assert_eq!(text.matches("Permission is granted\n").count(), 1);
        assert!(text.contains("one/LICENSE, two/LICENSE\n"), "{text}");
        assert!(text.contains("silent 1.2.3: MIT, no text in the package; authors: Ada\n"));
        for missing in 3..packages.len() {
            let held = packages[missing].folder.clone();
            fs::rename(&held, held.with_extension("moved")).unwrap();
            fs::create_dir(&held).unwrap();
            assert!(licences(&packages).is_err(), "{}", held.display());
            fs::remove_dir(&held).unwrap();
            fs::rename(held.with_extension("moved"), &held).unwrap();
        }
        fs::remove_dir_all(root).unwrap();
    }

    #[test]
    fn a_bill_names_packages_and_licences() {
        let root = std::env::temp_dir().join(format!("xtask-bill-{}", std::process::id()));
        let bill: Value = serde_json::from_str(&bill(&packages(&root))).unwrap();
        fs::remove_dir_all(root).unwrap();
        let [one, two, ..] = &bill["components"].as_array().unwrap()[..] else {
            panic!("{bill}");
        };
        assert_eq!(one["licenses"], json!([{ "license": { "name": OWN } }]));
        assert_eq!(two["licenses"], json!([{ "expression": "MIT" }]));
        assert_eq!(two["purl"], "pkg:cargo/two@1.2.3");
    }
}
