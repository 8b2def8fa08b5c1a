//! What nobody should send, and what the server survives.

use std::io::Write;
use std::net::TcpStream;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio_tungstenite::tungstenite::Message;

use super::client::{Bed, Page};
use crate::common::Folder;

/// Waits until something is so.
fn becomes_so(mut is_so: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(60) {
        if is_so() {
            return true;
        }
        sleep(Duration::from_millis(20));
    }
    false
}

/// Pseudo-random numbers, the same every time.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 33) as usize % count
    }

    fn pick<T: Clone>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())].clone()
    }

    /// A value of any type, often one that hurts.
    fn value(&mut self, depth: usize) -> Value {
        let kinds = if depth == 0 { 8 } else { 10 };
        match self.below(kinds) {
            0 => Value::Null,
            1 => json!(self.below(2) == 0),
            2 => json!(self.pick(&[0u64, 1, 3, 4, 255, 256, 65_536, u64::MAX])),
            3 => json!(self.pick(&[-1i64, i64::MIN, -7])),
            4 => json!(self.pick(&[0.5, -0.0, 1e308, -1e308, 1e-320])),
            5 => {
                json!(self.pick(&["", "a", "b", "c", "d", "exact", "random:", "\u{0}", "../../x"]))
            }
            6 => json!("9".repeat(self.below(2000))),
            7 => json!(vec![0.5; self.below(40)]),
            8 => (0..self.below(5)).map(|_| self.value(depth - 1)).collect(),
            _ => {
                let names = ["demo", "path", "upload", "size", "preset", "energy", "x"];
                let field = |_| (self.pick(&names).to_owned(), self.value(depth - 1));
                Value::Object((0..3).map(field).collect())
            }
        }
    }

    /// A message with fields of any kind. None asks for work that succeeds and takes long.
    fn message(&mut self) -> String {
        const TASKS: [&str; 28] = [
            "open",
            "select",
            "combine",
            "offset",
            "shroud",
            "run",
            "step",
            "pause",
            "reset",
            "cancel",
            "numbers",
            "pick",
            "colours",
            "contours",
            "points",
            "slice",
            "brush",
            "undo",
            "redo",
            "export",
            "report",
            "command",
            "compare",
            "scene",
            "scene_step",
            "fly",
            "",
            "hello ",
        ];
        const FIELDS: [&str; 22] = [
            "slot",
            "source",
            "labels",
            "threshold",
            "operation",
            "a",
            "b",
            "into",
            "by",
            "view",
            "settings",
            "vertex",
            "field",
            "axis",
            "every",
            "near",
            "index",
            "add",
            "centre",
            "radius",
            "format",
            "energies",
        ];
        let mut message = json!({ "id": self.below(100), "do": self.pick(&TASKS) });
        for _ in 0..self.below(6) {
            message[self.pick(&FIELDS)] = self.value(3);
        }
        let text = message.to_string();
        match self.below(4) {
            // Cut off, or with letters changed.
            0 => text.chars().take(self.below(text.len())).collect(),
            1 => text.replace(self.pick(&["\"", ":", "{", "0"]), self.pick(&["", "\\", "[", "é"])),
            _ => text,
        }
    }
}

#[test]
fn a_thousand_messages_that_mean_nothing() {
    let bed = Bed::start(&Folder::new(), "--threads 1");
    let mut page = bed.page();
    let mut random = Random(20);
    let mut refused = 0;
    for n in 0..1000 {
        let message = match n % 10 {
            9 => {
                let bytes: Vec<u8> =
                    (0..random.below(300)).map(|_| random.below(256) as u8).collect();
                Message::binary(bytes)
            }
            _ => Message::text(random.message()),
        };
        page.send(message.clone());
        let answer = loop {
            let text = page.text();
            if text.get("event").is_none() {
                break text;
            }
        };
        refused += usize::from(answer["error"].is_string());
        assert!(answer["error"].is_string() || answer["ok"].is_object(), "{message}: {answer}");
    }
    // Without a surface there is little that can be wished for.
    assert!(refused > 850, "{refused}");
    // Whatever was sent, a page can still work.
    let mut other = bed.page();
    for page in [&mut page, &mut other] {
        page.ask(json!({ "do": "open", "slot": "a", "source": { "demo": "ball", "size": 12 } }));
        page.ask(json!({ "do": "shroud", "view": 1, "slot": "a" }));
        page.ask(json!({ "do": "run", "view": 1 }));
        page.solver("done");
    }
}

#[test]
fn requests_out_of_all_bounds() {
    let bed = Bed::start(&Folder::new(), "--threads 1");
    let mut page = bed.page();
    page.ask(json!({ "do": "open", "slot": "a", "source": { "demo": "tori", "size": 16 } }));
    page.ask(json!({ "do": "shroud", "view": 0, "slot": "a" }));
    for (request, part) in [
        (
            json!({ "do": "open", "slot": "b", "source": { "demo": "tori", "size": 65535 } }),
            "1 and 2048",
        ),
        (json!({ "do": "open", "slot": "b", "source": { "path": "/etc/passwd" } }), "passwd"),
        (json!({ "do": "open", "slot": "b", "source": { "path": "/none.nii" } }), "none.nii"),
        (json!({ "do": "open", "slot": "b", "source": { "upload": "../../x" } }), "not there"),
        (json!({ "do": "open", "slot": "b", "source": {} }), "a source is"),
        (json!({ "do": "select", "slot": "a", "threshold": 1.0 }), "no values"),
        (json!({ "do": "select", "slot": "b", "threshold": 1.0 }), "slot b is empty"),
        (json!({ "do": "offset", "slot": "a", "by": 1e300, "into": "b" }), "1"),
        (json!({ "do": "combine", "operation": "xor", "a": "a", "b": "b", "into": "c" }), "empty"),
        (json!({ "do": "run", "view": 1 }), "view 1 is empty"),
        (json!({ "do": "pick", "view": 0, "vertex": u32::MAX }), "no vertex"),
        (json!({ "do": "colours", "view": 0, "field": "beauty" }), "no colours"),
        (json!({ "do": "colours", "view": 0, "field": "delta", "range": [1, 0] }), "range"),
        (json!({ "do": "contours", "view": 0, "axis": "x", "every": 1e-300 }), "farther apart"),
        (json!({ "do": "contours", "view": 0, "axis": "x", "every": -1 }), "above 0"),
        (json!({ "do": "points", "slot": "a", "near": 255 }), "1 to 4"),
        (json!({ "do": "slice", "slot": "a", "axis": "z", "index": u64::MAX }), "no slice"),
        (
            json!({ "do": "brush", "slot": "a", "add": true, "centre": [0, 0, 0], "radius": 1e9 }),
            "brush",
        ),
        (json!({ "do": "undo", "slot": "a" }), "no change"),
        (json!({ "do": "export", "view": 0, "format": "../x.ply" }), "no format"),
        (json!({ "do": "report", "view": 0 }), "finished"),
        (json!({ "do": "scene", "path": "/none.toml" }), "none.toml"),
        (json!({ "do": "scene", "demo": "figure1" }), "no scene"),
        (json!({ "do": "scene_step", "step": 0, "into": "a" }), "no scene"),
        (json!({ "do": "compare", "slot": "a", "energies": ["beauty"] }), "beauty"),
        (
            json!({ "do": "shroud", "view": 0, "slot": "a", "settings": { "surface": "dual", "border": "open" } }),
            "border",
        ),
    ] {
        let refusal = page.refusal(request.clone());
        assert!(refusal.contains(part), "{request}: {refusal}");
    }
    page.ask(json!({ "do": "open", "slot": "b", "source": { "demo": "tori", "size": 12 } }));
    let request = json!({ "do": "combine", "operation": "union", "a": "a", "b": "b", "into": "c" });
    assert!(page.refusal(request).contains("lattice"));
}

#[test]
fn sockets_that_break_the_rules_are_closed_alone() {
    let bed = Bed::start(&Folder::new(), "");
    let mut well = bed.page();
    let mut page = bed.page();
    page.send(Message::text("x".repeat(2 << 20)));
    assert!(page.next().is_none(), "a message too long");
    // Bytes that are no frame, behind a handshake that is one.
    let mut stream = TcpStream::connect(("127.0.0.1", bed.port)).unwrap();
    let head = format!(
        "GET /ws?token={} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
        bed.token, bed.port
    );
    stream.write_all(head.as_bytes()).unwrap();
    stream.write_all(&[0xff; 64]).unwrap();
    // A frame that promises 2⁶² bytes.
    let mut liar = TcpStream::connect(("127.0.0.1", bed.port)).unwrap();
    liar.write_all(head.as_bytes()).unwrap();
    liar.write_all(&[0x82, 0xff, 0x40, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5]).unwrap();
    // Half a request.
    let mut half = TcpStream::connect(("127.0.0.1", bed.port)).unwrap();
    half.write_all(b"GET / HT").unwrap();
    well.ask(json!({ "do": "hello" }));
    assert_eq!(bed.request("GET /", &[]).status, 200);
}

fn solve_for_ever(page: &mut Page, view: usize) {
    let settings = json!({ "solver": "sweeps", "tolerance": 1e-12, "max-iterations": 1_000_000 });
    page.ask(json!({ "do": "open", "slot": "a", "source": { "demo": "gyroid", "size": 40 } }));
    page.ask(json!({ "do": "shroud", "view": view, "slot": "a", "settings": settings }));
    page.ask(json!({ "do": "run", "view": view }));
    page.solver("running");
}

#[test]
fn a_page_that_goes_takes_its_work_along() {
    let bed = Bed::start(&Folder::new(), "--threads 1");
    let threads = bed.threads();
    let mut running = bed.page();
    solve_for_ever(&mut running, 0);
    let mut pausing = bed.page();
    solve_for_ever(&mut pausing, 3);
    pausing.ask(json!({ "do": "pause", "view": 3 }));
    pausing.solver("paused");
    assert!(threads.is_none() || bed.threads() > threads);
    drop(running);
    drop(pausing);
    let is_idle = becomes_so(|| bed.threads() == threads);
    assert!(is_idle, "{:?} threads of {threads:?}", bed.threads());
    bed.page().ask(json!({ "do": "hello" }));
}

#[test]
fn the_program_ends_cleanly() {
    let folder = Folder::new();
    for signal in ["-INT", "-TERM"] {
        let mut bed = Bed::start(&folder, "");
        let mut page = bed.page();
        solve_for_ever(&mut page, 0);
        assert_eq!(std::fs::read_dir(folder.path("temporary")).unwrap().count(), 1);
        let id = bed.child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
        let mut status = None;
        becomes_so(|| {
            status = bed.child.try_wait().unwrap();
            status.is_some()
        });
        assert!(status.unwrap().success(), "{signal}");
        assert_eq!(std::fs::read_dir(folder.path("temporary")).unwrap().count(), 0, "{signal}");
    }
}
