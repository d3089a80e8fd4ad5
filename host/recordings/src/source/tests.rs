//! Downloads from a server of the test's own, which breaks off, redirects and lies.

use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};

use super::*;
use crate::catalogue::source;
use crate::{LoadOptions, load};

/// A server with given answers; one connection a request.
struct Server {
    address: String,
    requests: Arc<Mutex<Vec<String>>>,
}

impl Server {
    /// Starts a server. `answer` gets the head of a request and its number, from 0 on, and gives all bytes before the
    /// connection is closed.
    fn start(answer: impl Fn(&str, usize) -> Vec<u8> + Send + 'static) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = format!("http://{}", listener.local_addr().unwrap());
        let requests = Arc::new(Mutex::new(Vec::new()));
        let seen = requests.clone();
        // Ends with the test program.
        std::thread::spawn(move || {
            for stream in listener.incoming() {
                let Ok(mut stream) = stream else { return };
                let head = head(&mut stream);
                let number = {
                    let mut seen = seen.lock().unwrap();
                    seen.push(head.clone());
                    seen.len() - 1
                };
                let _ = stream.write_all(&answer(&head, number));
            }
        });
        Self { address, requests }
    }

    fn requests(&self) -> Vec<String> {
        self.requests.lock().unwrap().clone()
    }

    fn file(&self, checksum: Option<&str>) -> Plan {
        Plan {
            stated_licence: None,
            downloads: vec![Download {
                url: format!("{}/file.zip", self.address),
                file: "file.zip".to_owned(),
                size: None,
                checksum: checksum.map(str::to_owned),
            }],
        }
    }
}

fn head(stream: &mut TcpStream) -> String {
    let mut head = Vec::new();
    let mut byte = [0];
    while !head.ends_with(b"\r\n\r\n") && stream.read(&mut byte).unwrap_or(0) == 1 {
        head.push(byte[0]);
    }
    String::from_utf8(head).unwrap().to_ascii_lowercase()
}

fn answer(status: &str, headers: &str, body: &[u8]) -> Vec<u8> {
    let head = format!("HTTP/1.1 {status}\r\nconnection: close\r\n{headers}\r\n");
    [head.as_bytes(), body].concat()
}

/// Answer 200 with the whole content, of which only the first `sent` bytes may be sent.
fn whole(content: &[u8], sent: usize) -> Vec<u8> {
    let headers = format!("content-length: {}\r\netag: \"one\"\r\n", content.len());
    answer("200 OK", &headers, &content[..sent])
}

/// Answer 206 with what a request asks for, of which only the first `sent` bytes may be sent.
fn rest(content: &[u8], request: &str, sent: usize) -> Vec<u8> {
    let (_, range) = request.split_once("range: bytes=").unwrap();
    let from: usize = range.split('-').next().unwrap().parse().unwrap();
    let (length, left) = (content.len(), content.len() - from);
    let headers = format!(
        "content-length: {left}\r\ncontent-range: bytes {from}-{}/{length}\r\netag: \"one\"\r\n",
        length - 1
    );
    let sent = &content[from..][..left.min(sent)];
    answer("206 Partial Content", &headers, sent)
}

fn content() -> Vec<u8> {
    (0..200_000_u32)
        .flat_map(|at| (at % 251).to_le_bytes())
        .collect()
}

fn roshambo() -> &'static Source {
    source("roshambo").unwrap()
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Content of the first file of a plan, downloaded into a folder.
fn fetch(plan: &Plan, folder: &tempfile::TempDir) -> Result<Vec<u8>, FetchError> {
    let received = download(plan, roshambo(), folder.path())?;
    Ok(fs::read(&received[0].path).unwrap())
}

#[test]
fn a_download_that_breaks_off_goes_on_where_it_stopped() {
    let server = Server::start(|request, number| match number {
        0 => whole(&content(), 300_000),
        1 => rest(&content(), request, 100_000),
        _ => rest(&content(), request, usize::MAX),
    });
    let folder = folder();
    assert_eq!(fetch(&server.file(None), &folder).unwrap(), content());
    let requests = server.requests();
    assert_eq!(requests.len(), 3);
    assert!(!requests[0].contains("range:"));
    for (at, header) in [
        (1, "range: bytes=300000-"),
        (1, "if-range: \"one\""),
        (2, "range: bytes=400000-"),
    ] {
        assert!(requests[at].contains(header), "{}", requests[at]);
    }
    // Neither the part nor its version is left.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_later_command_goes_on_too_and_a_changed_file_begins_anew() {
    let folder = folder();
    let other: Vec<u8> = content().into_iter().rev().collect();
    let sent = other.clone();
    let server = Server::start(move |_, number| match number {
        0 => whole(&content(), 300_000),
        1..4 => Vec::new(),
        // A server that ignores ranges, or whose file is another one now, sends all of it.
        _ => whole(&sent, sent.len()),
    });
    let error = fetch(&server.file(None), &folder).unwrap_err();
    let error = error.to_string();
    for words in [
        "broke off after 300000 bytes of 800000: ",
        "the same command continues there",
    ] {
        assert!(error.contains(words), "{error}");
    }
    assert_eq!(fetch(&server.file(None), &folder).unwrap(), other);
    assert!(server.requests()[4].contains("range: bytes=300000-"));
}

#[test]
fn a_part_of_another_address_with_a_damaged_version_or_longer_than_the_file_is_thrown_away() {
    let server = Server::start(|request, _| {
        if request.contains("range:") {
            answer("416 Range Not Satisfiable", "content-length: 0\r\n", &[])
        } else {
            whole(b"short", 5)
        }
    });
    let url = server.file(None).downloads[0].url.clone();
    for version in [
        String::new(),
        "https://example.org/file.zip\n\"1\"\n".to_owned(),
        format!("{url}\n\"1\""),
        format!("{url}\n\0\0\0\n"),
        format!("{url}\n\n"),
    ] {
        let folder = folder();
        let path = |ending: &str| folder.path().join(format!("file.zip{ending}"));
        fs::write(path(".partial"), [7; 100]).unwrap();
        fs::write(path(".version"), &version).unwrap();
        let before = server.requests().len();
        assert_eq!(fetch(&server.file(None), &folder).unwrap(), b"short");
        let asked = server.requests().split_off(before);
        let is_gone_on = asked[0].contains("range:");
        assert_eq!(is_gone_on, version.ends_with("\n\n"), "{version:?}");
    }
}

#[test]
fn a_file_that_is_not_the_published_one_is_removed() {
    let server = Server::start(|_, _| whole(b"abc", 3));
    let folder = folder();
    let right = server.file(Some("md5:900150983cd24fb0d6963f7d28e17f72"));
    fetch(&right, &folder).unwrap();
    fs::remove_file(folder.path().join("file.zip")).unwrap();
    let wrong = server.file(Some("md5:00000000000000000000000000000000"));
    let error = fetch(&wrong, &folder).unwrap_err();
    let words =
        "expected md5:00000000000000000000000000000000, found md5:900150983cd24fb0d6963f7d28e17f72";
    assert!(error.to_string().contains(words), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_redirect_is_followed_with_the_range() {
    let target = Server::start(|request, number| match number {
        0 => whole(&content(), 300_000),
        _ => rest(&content(), request, usize::MAX),
    });
    let moved = format!("{}/moved", target.address);
    let to = format!("location: {moved}\r\ncontent-length: 0\r\n");
    let server = Server::start(move |_, _| answer("302 Found", &to, &[]));
    let folder = folder();
    assert_eq!(fetch(&server.file(None), &folder).unwrap(), content());
    assert!(target.requests()[1].contains("range: bytes=300000-"));
}

#[test]
fn a_missing_file_and_a_missing_server_say_what_to_do() {
    let server = Server::start(|_, _| answer("404 Not Found", "content-length: 0\r\n", &[]));
    let folder = folder();
    let error = fetch(&server.file(None), &folder).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("status 404"), "{error}");
    assert!(error.contains("https://doi.org/10.5281/zenodo.3194792"));
    assert_eq!(server.requests().len(), 1);

    // A port that nobody listens on.
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr();
    let free = free.unwrap();
    let error = plan(roshambo(), &format!("http://{free}")).unwrap_err();
    let words = format!("cannot reach {free}");
    assert!(error.to_string().contains(&words), "{error}");
}

#[test]
fn more_than_was_announced_is_not_kept() {
    let server = Server::start(|_, _| answer("200 OK", "", &content()));
    let mut plan = server.file(None);
    plan.downloads[0].size = Some(1000);
    let folder = folder();
    let error = fetch(&plan, &folder).unwrap_err();
    let error = error.to_string();
    assert!(error.contains("more than 1000 bytes"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_record_of_zenodo_gives_files_checksums_and_licence() {
    let record = |key: &str| {
        format!(
            "{{\"id\":3194792,\"metadata\":{{\"title\":\"x\",\"license\":{{\"id\":\"cc-by-4.0\"}}}},\"files\":[{{\"id\":\"1\",\
             \"key\":\"{key}\",\"size\":3,\"checksum\":\"md5:900150983cd24fb0d6963f7d28e17f72\",\
             \"links\":{{\"self\":\"https://zenodo.org/api/records/3194792/files/{key}/content\"}}}}]}}"
        )
    };
    let good = record("data.zip");
    let server = Server::start(move |_, _| answer("200 OK", "", good.as_bytes()));
    let found = plan(roshambo(), &server.address).unwrap();
    assert!(server.requests()[0].starts_with("get /api/records/3194792 "));
    assert_eq!(found.stated_licence.as_deref(), Some("cc-by-4.0"));
    assert_eq!(found.downloads.len(), 1);
    assert_eq!(found.downloads[0].size, Some(3));
    assert!(found.downloads[0].checksum.is_some());
    let bad = ["../data.zip", "a/b", "", ".hidden"].map(record);
    for bad in bad.into_iter().chain(["<html>".to_owned()]) {
        let server = Server::start(move |_, _| answer("200 OK", "", bad.as_bytes()));
        let error = plan(roshambo(), &server.address).unwrap_err();
        let words = "expected a record of Zenodo";
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn an_archive_is_put_in_place_whole_or_not_at_all_and_its_recordings_are_read() {
    let folder = folder();
    let archive = folder.path().join("any.name");
    let mut writer = zip::ZipWriter::new(fs::File::create(&archive).unwrap());
    let rows = "1,2,3,4,5,6,7,8,0\n".repeat(30);
    let options = zip::write::SimpleFileOptions::default();
    let name = "myo-readings-dataset-main/_readings/12345-1/0.txt";
    writer.start_file(name, options).unwrap();
    writer.write_all(rows.as_bytes()).unwrap();
    writer.finish().unwrap();
    let place = folder.path().join("myo-readings");
    let files = std::slice::from_ref(&archive);
    let set = DataSet::named("myo-readings");
    let done = put_in_place(files, &place, set).unwrap();
    assert_eq!((done.files, done.bytes), (1, rows.len() as u64));
    let library = load(&place, &LoadOptions::default()).unwrap();
    assert_eq!(library.subjects(), ["myo-readings/12345"]);
    let again = put_in_place(files, &place, set).unwrap_err();
    assert!(again.to_string().contains("exists: remove it"), "{again}");

    let other = folder.path().join("new/other");
    let wrong = put_in_place(files, &other, DataSet::named("roshambo")).unwrap_err();
    let words = "expected recordings of roshambo";
    assert!(wrong.to_string().contains(words), "{wrong}");
    assert!(!folder.path().join("new").exists());
    let whole = fs::read(&archive).unwrap();
    fs::write(&archive, &whole[..whole.len() - 30]).unwrap();
    put_in_place(files, &other, set).unwrap_err();
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 2, "{left:?}");
}
