//! Events as packets of Open Sound Control over UDP, for music and art programs.
//!
//! | address | arguments |
//! | --- | --- |
//! | `/myointent/label` | string label, int 1 if valid, int sample that it is for |
//! | `/myointent/strength` | int percent of the wearer's range, with each label; of a board after `strength on` |
//! | `/myointent/scores` | float probability of each class, in the model's order |
//! | `/myointent/emg` | eight ints, the raw sample; a packet a sample |
//! | `/myointent/quaternion`, `/acceleration`, `/turn_rate` | four or three floats, with `--imu` |
//! | `/myointent/connected` | int 1 if the source is connected |
//!
//! UDP tells nobody whether a packet arrives, or whether somebody listens.

use std::io::{self, ErrorKind, Write};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs as _, UdpSocket};

use rosc::{OscMessage, OscPacket, OscType, encoder};
use serde_json::Value;

/// Writer of lines of JSON ([`JsonLines`](super::json_lines::JsonLines)) that sends each as packets.
#[derive(Debug)]
pub(crate) struct Osc {
    socket: UdpSocket,
    target: SocketAddr,
    /// Line so far.
    line: Vec<u8>,
}

impl Osc {
    /// A sender to an address or a name, and a port.
    ///
    /// # Errors
    /// When the name is not known, or the system gives no socket.
    pub(crate) fn to(target: &str) -> io::Result<Self> {
        let found = target.to_socket_addrs()?;
        // `localhost` is both, and most receivers listen on IPv4 alone.
        let target = found.min_by_key(SocketAddr::is_ipv6);
        let target = target.ok_or(ErrorKind::AddrNotAvailable)?;
        let any = if target.is_ipv4() {
            Ipv4Addr::UNSPECIFIED.into()
        } else {
            Ipv6Addr::UNSPECIFIED.into()
        };
        let socket = UdpSocket::bind(SocketAddr::new(any, 0))?;
        if target.is_ipv4() {
            socket.set_broadcast(true)?;
        }
        Ok(Self {
            socket,
            target,
            line: Vec::new(),
        })
    }

    fn send(&self, (name, args): (&str, Vec<OscType>)) -> io::Result<()> {
        let addr = format!("/myointent/{name}");
        let packet = OscPacket::Message(OscMessage { addr, args });
        let bytes = encoder::encode(&packet)
            .map_err(|error| io::Error::new(ErrorKind::InvalidData, format!("{error:?}")))?;
        self.socket.send_to(&bytes, self.target)?;
        Ok(())
    }
}

impl Write for Osc {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for part in bytes.split_inclusive(|&byte| byte == b'\n') {
            self.line.extend(part);
            if part.ends_with(b"\n") {
                let event: Value = serde_json::from_slice(&self.line)?;
                self.line.clear();
                for message in messages(&event) {
                    self.send(message)?;
                }
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Messages of an event, most often none.
fn messages(event: &Value) -> Vec<(&'static str, Vec<OscType>)> {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a sample, or a count that wraps"
    )]
    let int = |value: &Value| OscType::Int(value.as_i64().unwrap_or_default() as i32);
    #[expect(clippy::cast_possible_truncation, reason = "it was an f32")]
    let float = |value: &Value| OscType::Float(value.as_f64().unwrap_or_default() as f32);
    let truth = |value: &Value| OscType::Int(i32::from(value == true));
    let items = |value: &Value, of: &dyn Fn(&Value) -> OscType| -> Vec<OscType> {
        value.as_array().into_iter().flatten().map(of).collect()
    };
    match event["type"].as_str() {
        Some("report") => {
            let label = OscType::String(event["label"].as_str().unwrap_or_default().to_owned());
            let of_label = vec![label, truth(&event["valid"]), int(&event["instant"])];
            let strength = &event["strength"];
            let strength = strength.is_u64().then(|| ("strength", vec![int(strength)]));
            [("label", of_label)].into_iter().chain(strength).collect()
        }
        Some("scores") => vec![("scores", items(&event["scores"], &float))],
        Some("samples") => {
            let samples = event["emg"].as_array().into_iter().flatten();
            samples.map(|sample| ("emg", items(sample, &int))).collect()
        }
        Some("imu") => ["quaternion", "acceleration", "turn_rate"]
            .map(|kind| (kind, items(&event[kind], &float)))
            .into(),
        Some("source") => vec![("connected", vec![truth(&event["connected"])])],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;

    use super::*;
    use crate::live::{self, Options, Source};

    #[test]
    fn movement_is_three_messages() {
        let event = serde_json::json!({
            "type": "imu", "at": 1.5, "sample": 8,
            "quaternion": [1.0, 0.0, -0.5, 0.0], "acceleration": [0.0, 0.0, -1.0], "turn_rate": [2.5, 0.0, 0.0],
        });
        let floats = |values: &[f32]| values.iter().copied().map(OscType::Float).collect();
        let expected: [(_, Vec<OscType>); 3] = [
            ("quaternion", floats(&[1.0, 0.0, -0.5, 0.0])),
            ("acceleration", floats(&[0.0, 0.0, -1.0])),
            ("turn_rate", floats(&[2.5, 0.0, 0.0])),
        ];
        assert_eq!(messages(&event), expected);
    }

    #[test]
    fn a_udp_socket_receives_labels_scores_and_samples() {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        receiver
            .set_read_timeout(Some(Duration::from_secs(60)))
            .unwrap();
        let port = receiver.local_addr().unwrap().port();
        let osc = Osc::to(&format!("localhost:{port}")).unwrap();
        let over = AtomicBool::new(false);
        let kinds = ["label", "strength", "scores", "emg", "connected"];
        let mut received: BTreeMap<String, Vec<OscType>> = BTreeMap::new();
        std::thread::scope(|scope| {
            let live = scope.spawn(|| {
                let is_over = || over.load(Ordering::Relaxed);
                live::print(Options::of(Source::Demo), osc, |_| (), is_over)
            });
            let mut buffer = [0; 512];
            while received.len() < kinds.len() {
                let length = receiver.recv(&mut buffer).unwrap();
                let (rest, packet) = rosc::decoder::decode_udp(&buffer[..length]).unwrap();
                let OscPacket::Message(OscMessage { addr, args }) = packet else {
                    panic!("{packet:?}");
                };
                assert!(rest.is_empty());
                received.insert(addr, args);
            }
            over.store(true, Ordering::Relaxed);
            live.join().unwrap().unwrap();
        });
        let of = |kind: &str| &received[&format!("/myointent/{kind}")][..];
        assert!(
            matches!(of("label"), [OscType::String(label), OscType::Int(0 | 1), OscType::Int(_)] if label == "relax"),
            "{received:?}"
        );
        let scores = of("scores").iter().map(|score| match score {
            OscType::Float(score) => *score,
            other => panic!("{other:?}"),
        });
        let scores: Vec<f32> = scores.collect();
        assert!(
            scores.len() >= 3 && (scores.iter().sum::<f32>() - 1.0).abs() < 0.01,
            "{scores:?}"
        );
        assert!(
            of("emg")
                .iter()
                .all(|value| matches!(value, OscType::Int(-128..=127)))
        );
        assert_eq!(
            (of("emg").len(), of("connected")),
            (8, &[OscType::Int(1)][..])
        );
    }
}
