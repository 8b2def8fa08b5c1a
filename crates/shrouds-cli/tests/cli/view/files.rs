//! Files from and for the page.

use std::io::Write;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::client::Bed;
use crate::common::{Folder, gzip, nifti};

const AFFINE: [[f32; 4]; 3] = [[-0.9, 0.0, 0.0, 12.0], [0.0, 0.0, 1.5, -7.0], [0.0, 1.1, 0.0, 3.0]];

/// Two labels in 8 × 7 × 6 voxels of a scanner that lay on its side.
fn labels() -> Vec<u8> {
    let label = |n: usize| match [n % 8, n / 8 % 7, n / 56] {
        [1..5, 1..6, 1..5] => 3,
        [5..7, 2..5, 1..5] => 7,
        _ => 0,
    };
    gzip(&nifti(&[8, 7, 6], AFFINE, &(0..336).map(label).collect::<Vec<u8>>()))
}

fn upload(bed: &Bed, name: &str, bytes: &[u8]) -> Value {
    let answer = bed.request(&format!("POST /upload?name={name}"), bytes);
    assert_eq!(answer.status, 200, "{}", answer.head);
    serde_json::from_slice(&answer.body).unwrap()
}

#[test]
fn a_file_is_sent_selected_from_and_comes_back_as_a_mesh() {
    let folder = Folder::new();
    folder.file("two.nii.gz", &labels());
    let bed = Bed::start(&folder, "");
    let mut page = bed.page();
    let sent = upload(&bed, "two.nii.gz", &labels());
    let opened = page.ask(json!({ "do": "open", "slot": "a", "source": sent }));
    let volume = &opened["volume"];
    assert_eq!((&volume["name"], &volume["frame"]), (&json!("two.nii.gz"), &json!("RAS")));
    let counts: Vec<(i64, i64)> = volume["labels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|label| (label["value"].as_i64().unwrap(), label["count"].as_i64().unwrap()))
        .collect();
    assert_eq!(counts, [(0, 336 - 80 - 24), (3, 80), (7, 24)]);
    assert_eq!(volume["inside"], 104);
    let chosen = page.ask(json!({ "do": "select", "slot": "a", "labels": [7] }));
    assert_eq!(
        (&chosen["volume"]["inside"], &chosen["volume"]["selected"]),
        (&json!(24), &json!("7"))
    );
    let above = page.ask(json!({ "do": "select", "slot": "a", "threshold": 3 }));
    assert_eq!(above["volume"]["inside"], 24);
    page.ask(json!({ "do": "select", "slot": "a", "labels": [3, 7] }));
    page.ask(json!({ "do": "shroud", "view": 0, "slot": "a", "settings": { "preset": "exact" } }));
    page.ask(json!({ "do": "run", "view": 0 }));
    page.solver("done");
    let call = page.ask(json!({ "do": "command", "view": 0 }));
    let expected = "shrouds mesh two.nii.gz --label=3 --label=7 --preset=exact -o mesh.ply";
    assert_eq!(call["command"], expected);
    folder.succeed(&format!("{} --report report.json", expected.strip_prefix("shrouds ").unwrap()));
    let made = page.ask(json!({ "do": "export", "view": 0, "format": "ply" }));
    assert_eq!(made["name"], "two.ply");
    let download =
        bed.request(&format!("GET /download/{}", made["download"].as_str().unwrap()), &[]);
    assert!(download.head.contains("attachment; filename=\"two.ply\""), "{}", download.head);
    assert!(download.body == folder.bytes("mesh.ply"), "the same bytes as the command line");
    let mut report = page.ask(json!({ "do": "report", "view": 0 }))["report"].clone();
    let mut written = folder.json("report.json");
    for report in [&mut report, &mut written] {
        report["times"] = Value::Null;
        report["memory"] = Value::Null;
    }
    assert_eq!(report, written);
    for format in ["stl", "obj", "glb", "vtp", "3mf", "nii.gz", "nrrd", "npy", "vti", "shroud"] {
        let made =
            page.ask(json!({ "do": "export", "view": 0, "format": format, "frame": "index" }));
        let path = format!("GET /download/{}", made["download"].as_str().unwrap());
        let answer = bed.request(&path, &[]);
        assert!(answer.status == 200 && !answer.body.is_empty(), "{format}");
    }
    // The upload was opened and is nobody else's.
    assert!(page.refusal(json!({ "do": "open", "slot": "b", "source": sent })).contains("opened"));
}

#[test]
fn uploads_that_are_none_are_refused_and_leave_nothing() {
    let folder = Folder::new();
    let bed = Bed::start(&folder, "");
    let kept = || {
        let server = std::fs::read_dir(folder.path("temporary")).unwrap().next().unwrap().unwrap();
        std::fs::read_dir(server.path()).unwrap().count()
    };
    for name in ["", "..%2f..%2fx.npy", ".npy", "a%00b", &"a".repeat(300)] {
        assert_eq!(bed.request(&format!("POST /upload?name={name}"), b"x").status, 400, "{name}");
    }
    let host = format!("Host: 127.0.0.1:{}", bed.port);
    let line = format!("POST /upload?name=x.npy&token={} HTTP/1.1\r\n{host}", bed.token);
    let mut stream = TcpStream::connect(("127.0.0.1", bed.port)).unwrap();
    write!(stream, "{line}\r\nContent-Length: 5000000000\r\n\r\n").unwrap();
    let mut answer = [0; 12];
    std::io::Read::read_exact(&mut stream, &mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 413");
    // One that breaks off.
    let mut stream = TcpStream::connect(("127.0.0.1", bed.port)).unwrap();
    write!(stream, "{line}\r\nContent-Length: 1000\r\n\r\nabc").unwrap();
    let start = Instant::now();
    while kept() == 0 && start.elapsed() < Duration::from_secs(30) {
        std::thread::sleep(Duration::from_millis(5));
    }
    drop(stream);
    while kept() > 0 && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(kept(), 0);
    // One that is no volume, and one that is cut off: messages name the file, not our folder.
    let mut page = bed.page();
    for (name, bytes) in [("x.npy", b"no array".to_vec()), ("y.nii.gz", labels()[..60].to_vec())] {
        let source = upload(&bed, name, &bytes);
        let refusal = page.refusal(json!({ "do": "open", "slot": "a", "source": source }));
        assert!(refusal.starts_with(name), "{refusal}");
    }
    assert_eq!(kept(), 0);
}
