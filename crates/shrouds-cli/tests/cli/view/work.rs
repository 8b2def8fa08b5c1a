//! What the page is for: volumes, surfaces, solvers.

use serde_json::{Value, json};

use super::client::{Bed, Page};
use crate::common::Folder;

/// A bed with the tori in view 0, at their start.
fn with_tori(page: &mut Page, settings: Value) -> Value {
    page.ask(json!({ "do": "open", "slot": "a", "source": { "demo": "tori", "size": 24 } }));
    let made = page.ask(json!({ "do": "shroud", "view": 0, "slot": "a", "settings": settings }));
    // Its frames have come when the next answer has.
    page.ask(json!({ "do": "hello" }));
    made
}

#[test]
fn a_surface_is_the_one_of_the_command_line() {
    let folder = Folder::with_tori();
    let bed = Bed::start(&folder, "volume.npy");
    let mut page = bed.page();
    let hello = page.ask(json!({ "do": "hello" }));
    let source = hello["input"].clone();
    assert!(source["path"].as_str().unwrap().ends_with("volume.npy"), "{hello}");
    let opened = page.ask(json!({ "do": "open", "slot": "a", "source": source }));
    assert_eq!(opened["volume"]["dims"], json!([24, 24, 24]));
    for (n, settings) in [
        json!({}),
        json!({ "preset": "exact" }),
        json!({ "solver": "sweeps", "energy": "linear", "tolerance": 1e-4 }),
        json!({ "energy": "bending+0.3*variation", "start": "random:5", "faces": "join" }),
        json!({ "volume": "keep" }),
        json!({ "border": "open", "triangles": "fixed", "crease": true }),
    ]
    .into_iter()
    .enumerate()
    {
        let view = n % 4;
        let words: Vec<String> = settings.as_object().unwrap().iter().map(option).collect();
        let call = format!(
            "mesh volume.npy -o mesh.ply --attributes delta --report report.json {}",
            words.join(" ")
        );
        folder.succeed(&call);
        let report = folder.json("report.json");
        let made =
            page.ask(json!({ "do": "shroud", "view": view, "slot": "a", "settings": settings }));
        page.ask(json!({ "do": "run", "view": view }));
        let end = page.solver("done");
        page.event("settled");
        let surface = &made["surface"];
        assert_eq!(surface["vertices"], report["topology"]["vertices"]);
        assert_eq!(surface["triangles"], report["topology"]["triangles"]);
        assert_eq!(surface["components"], report["topology"]["components"]);
        assert_eq!(end["energy"], report["solver"]["energy"]["last"], "{settings}");
        assert_eq!(end["iteration"], report["solver"]["iterations"]);
        assert_eq!(end["status"], report["solver"]["status"]);
        assert_eq!(page.last(2).numbers(), deltas(&folder.bytes("mesh.ply")), "{settings}");
    }
}

fn option((name, value): (&String, &Value)) -> String {
    match value {
        Value::Bool(_) => format!("--{name}"),
        Value::String(text) => format!("--{name}={text}"),
        other => format!("--{name}={other}"),
    }
}

/// The property `delta` of a PLY file, whose vertices have it behind six numbers of 32 bits.
fn deltas(ply: &[u8]) -> Vec<f32> {
    let end = b"end_header\n";
    let at = ply.windows(end.len()).position(|part| part == end).unwrap() + end.len();
    let head = String::from_utf8(ply[..at].to_vec()).unwrap();
    let properties: Vec<&str> =
        head.lines().filter(|line| line.starts_with("property float ")).collect();
    assert_eq!(properties.len(), 7, "{head}");
    assert_eq!(properties[6], "property float delta");
    let count = head.lines().find_map(|line| line.strip_prefix("element vertex ")).unwrap();
    let vertices = ply[at..].chunks(28).take(count.parse().unwrap());
    vertices.map(|vertex| f32::from_le_bytes(vertex[24..].try_into().unwrap())).collect()
}

#[test]
fn frames_hold_the_surface() {
    let bed = Bed::start(&Folder::new(), "");
    let mut page = bed.page();
    let made = with_tori(&mut page, json!({ "preset": "exact" }));
    page.ask(json!({ "do": "run", "view": 0 }));
    page.solver("done");
    page.event("settled");
    let surface = &made["surface"];
    let topology = page.last(1).clone();
    assert_eq!([topology.view, topology.revision], [0, 1]);
    let words = topology.words();
    let [vertices, triangles, segments] = [0, 1, 2].map(|n| words[n] as usize);
    assert_eq!(surface["vertices"], vertices);
    assert_eq!(surface["triangles"], triangles);
    assert_eq!((topology.count, segments), (vertices, 2 * vertices), "two curves each, all closed");
    let families = segments.div_ceil(4);
    assert_eq!(words.len(), 4 + 6 * vertices + 3 * triangles + 2 * segments + families);
    let numbers = topology.numbers();
    for along in numbers[4 + 3 * vertices..4 + 6 * vertices].chunks(3) {
        assert_eq!(along.iter().map(|x| x.abs()).sum::<f32>(), 1.0);
    }
    let indices = &words[4 + 6 * vertices..][..3 * triangles + 2 * segments];
    assert!(indices.iter().all(|&index| (index as usize) < vertices));
    let delta = page.last(2).numbers();
    assert!(delta.len() == vertices && delta.iter().all(|x| (0.0..=1.0).contains(x)));
    for normal in page.last(5).numbers().chunks(3) {
        assert!((normal.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-5);
    }
    // Outside is right-handed: the volume by the tetrahedra of the triangles.
    let place = |v: u32| -> [f32; 3] {
        let v = v as usize;
        [0, 1, 2].map(|d| numbers[4 + 3 * v + d] + delta[v] * numbers[4 + 3 * vertices + 3 * v + d])
    };
    let fitted = page.frames.iter().rfind(|frame| frame.kind == 3).unwrap().words();
    let volume: f32 =
        fitted.chunks(3).map(|t| determinant([t[0], t[1], t[2]].map(place)) / 6.0).sum();
    let numbers = page.ask(json!({ "do": "numbers", "view": 0 }));
    let expected = numbers["volume"].as_f64().unwrap();
    assert!((f64::from(volume) / expected - 1.0).abs() < 1e-4, "{volume} {expected}");
    assert_eq!(surface["segments"], segments);
}

fn determinant([a, b, c]: [[f32; 3]; 3]) -> f32 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

#[test]
fn a_solver_steps_pauses_stops_and_goes_back() {
    let bed = Bed::start(&Folder::new(), "--threads 1");
    let mut page = bed.page();
    with_tori(&mut page, json!({ "solver": "sweeps", "tolerance": 1e-9 }));
    let start = page.last(2).numbers();
    page.ask(json!({ "do": "step", "view": 0 }));
    assert_eq!(page.solver("paused")["iteration"], 1);
    page.event("settled");
    assert_ne!(page.last(2).numbers(), start);
    page.ask(json!({ "do": "step", "view": 0 }));
    assert_eq!(page.solver("paused")["iteration"], 2);
    page.ask(json!({ "do": "run", "view": 0 }));
    page.solver("running");
    page.ask(json!({ "do": "pause", "view": 0 }));
    let before = page.solver("paused")["iteration"].as_u64().unwrap();
    page.ask(json!({ "do": "run", "view": 0 }));
    page.solver("running");
    page.ask(json!({ "do": "cancel", "view": 0 }));
    let end = page.solver("cancelled");
    page.event("settled");
    assert!(end["iteration"].as_u64().unwrap() > before);
    page.ask(json!({ "do": "reset", "view": 0 }));
    page.event("settled");
    assert_eq!(page.last(2).numbers(), start);
    // Another surface in the view of a solver ends it.
    page.ask(json!({ "do": "run", "view": 0 }));
    page.solver("running");
    with_tori(&mut page, json!({ "preset": "fast" }));
    page.ask(json!({ "do": "run", "view": 0 }));
    assert_eq!(page.solver("done")["status"], "preset done");
}
