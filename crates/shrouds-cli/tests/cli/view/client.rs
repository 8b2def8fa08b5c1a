//! The program with its server, and a page that is none.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::Duration;

use futures_util::{SinkExt, StreamExt};
use serde_json::{Value, json};
use tokio::runtime::{Builder, Runtime};
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

use crate::common::{Folder, command};

/// Whatever takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(120);

/// A running `shrouds view`, ended when it is dropped.
pub(crate) struct Bed {
    pub(crate) child: Child,
    pub(crate) port: u16,
    pub(crate) token: String,
}

/// A page's end of a socket.
pub(crate) struct Page {
    runtime: Runtime,
    socket: WebSocketStream<MaybeTlsStream<tokio::net::TcpStream>>,
    ids: u64,
    /// Events so far.
    pub(crate) events: Vec<Value>,
    /// As many of them came before the last request, or were waited for.
    heard: usize,
    /// Binary messages so far.
    pub(crate) frames: Vec<Frame>,
}

/// A binary message.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    pub(crate) kind: u32,
    pub(crate) view: u32,
    pub(crate) revision: u32,
    pub(crate) count: usize,
    pub(crate) payload: Vec<u8>,
}

/// What an HTTP request was answered.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Bed {
    pub(crate) fn start(folder: &Folder, words: &str) -> Self {
        let words = format!("view --no-open {words}");
        std::fs::create_dir_all(folder.path("temporary")).unwrap();
        let mut command = command(&folder.path("."), &words);
        command.env("TMPDIR", folder.path("temporary")).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://127.0.0.1:").unwrap();
        let (port, token) = address.split_once("/?token=").unwrap();
        Self { child, port: port.parse().unwrap(), token: token.into() }
    }

    /// Threads of the program, where the system tells it.
    pub(crate) fn threads(&self) -> Option<usize> {
        let tasks = std::fs::read_dir(format!("/proc/{}/task", self.child.id())).ok()?;
        Some(tasks.count())
    }

    pub(crate) fn page(&self) -> Page {
        self.try_page(&[]).unwrap()
    }

    /// A page with more headers.
    pub(crate) fn try_page(&self, headers: &[(&'static str, &str)]) -> Result<Page, Box<Error>> {
        let runtime = Builder::new_current_thread().enable_all().build().unwrap();
        let address = format!("ws://127.0.0.1:{}/ws?token={}", self.port, self.token);
        let mut request = address.into_client_request().unwrap();
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        let (socket, _) = runtime.block_on(connect_async(request))?;
        Ok(Page { runtime, socket, ids: 0, events: Vec::new(), heard: 0, frames: Vec::new() })
    }

    /// Sends a request as it is, without the rest of its connection.
    pub(crate) fn http(&self, head: &str, body: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let length = body.len();
        let head = format!("{head}\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        // The server may refuse before all has arrived.
        let _ = stream.write_all(body);
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { status, head, body: bytes[end + 4..].to_vec() }
    }

    /// `METHOD PATH` with our host and token.
    pub(crate) fn request(&self, line: &str, body: &[u8]) -> Answer {
        let mark = if line.contains('?') { '&' } else { '?' };
        let line = format!("{line}{mark}token={} HTTP/1.1", self.token);
        self.http(&format!("{line}\r\nHost: 127.0.0.1:{}", self.port), body)
    }
}

impl Drop for Bed {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Page {
    pub(crate) fn send(&mut self, message: Message) {
        // A server that closes the socket meanwhile is seen when reading.
        let _ = self.runtime.block_on(self.socket.send(message));
    }

    /// The next message, or nothing when the socket is closed.
    pub(crate) fn next(&mut self) -> Option<Message> {
        let next = async { timeout(PATIENCE, self.socket.next()).await };
        let message = self.runtime.block_on(next).expect("no message came");
        message.and_then(Result::ok).filter(|message| !message.is_close())
    }

    /// Waits for the next text, keeping frames and events.
    pub(crate) fn text(&mut self) -> Value {
        loop {
            match self.next().expect("the socket is open") {
                Message::Text(text) => {
                    let value: Value = serde_json::from_str(&text).unwrap();
                    if value.get("event").is_some() {
                        self.events.push(value.clone());
                    }
                    return value;
                }
                Message::Binary(bytes) => {
                    let frame = Frame::new(&bytes);
                    if frame.kind == 2 {
                        self.acknowledge(&frame);
                    }
                    self.frames.push(frame);
                }
                _ => {}
            }
        }
    }

    fn acknowledge(&mut self, frame: &Frame) {
        let ack = json!({
            "do": "ack", "view": frame.view, "revision": frame.revision, "iteration": 0,
        });
        self.send(Message::text(ack.to_string()));
    }

    /// Sends a request and returns its number.
    pub(crate) fn say(&mut self, mut request: Value) -> u64 {
        self.heard = self.events.len();
        self.ids += 1;
        request["id"] = self.ids.into();
        self.send(Message::text(request.to_string()));
        self.ids
    }

    /// The answer to a request, be it good or bad.
    pub(crate) fn answer(&mut self, request: Value) -> Value {
        let id = self.say(request);
        loop {
            let text = self.text();
            if text["id"] == id {
                return text;
            }
        }
    }

    /// The answer to a request that is granted.
    pub(crate) fn ask(&mut self, request: Value) -> Value {
        let answer = self.answer(request.clone());
        assert!(answer.get("error").is_none(), "{request}: {answer}");
        answer["ok"].clone()
    }

    /// Why a request is refused.
    pub(crate) fn refusal(&mut self, request: Value) -> String {
        let answer = self.answer(request.clone());
        answer["error"].as_str().unwrap_or_else(|| panic!("{request}: {answer}")).to_owned()
    }

    /// The next event of this name since the last request; it may have come before the answer.
    pub(crate) fn event(&mut self, name: &str) -> Value {
        loop {
            while let Some(event) = self.events.get(self.heard) {
                self.heard += 1;
                if event["event"] == name {
                    return event.clone();
                }
            }
            self.text();
        }
    }

    /// The next event of a solver in this state.
    pub(crate) fn solver(&mut self, state: &str) -> Value {
        loop {
            let event = self.event("solver");
            if event["state"] == state {
                return event;
            }
        }
    }

    /// The last frame of a kind; there must be one.
    pub(crate) fn last(&self, kind: u32) -> &Frame {
        self.frames.iter().rfind(|frame| frame.kind == kind).unwrap()
    }
}

impl Frame {
    pub(crate) fn new(bytes: &[u8]) -> Self {
        let word = |n: usize| u32::from_le_bytes(bytes[4 * n..4 * n + 4].try_into().unwrap());
        assert_eq!(bytes.len() % 4, 0);
        let payload = bytes[16..].to_vec();
        let [kind, view, revision] = [word(0), word(1), word(2)];
        Self { kind, view, revision, count: word(3) as usize, payload }
    }

    pub(crate) fn words(&self) -> Vec<u32> {
        let (words, _) = self.payload.as_chunks();
        words.iter().map(|word| u32::from_le_bytes(*word)).collect()
    }

    pub(crate) fn numbers(&self) -> Vec<f32> {
        self.words().into_iter().map(f32::from_bits).collect()
    }
}
