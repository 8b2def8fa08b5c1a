//! Views of several labels: the interfaces between them, and what such views have not.

use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::client::{Bed, Page};
use crate::common::{Folder, cut_ball, nifti, npy};

const SIZE: usize = 16;
/// A lattice that is mirrored in the world.
const AFFINE: [[f32; 4]; 3] = [[-0.9, 0.0, 0.0, 12.0], [0.0, 0.0, 1.5, -7.0], [0.0, 1.1, 0.0, 3.0]];

fn label(n: usize) -> u8 {
    cut_ball(SIZE, 40.0, n)
}

fn folder() -> Folder {
    let folder = Folder::new();
    let values: Vec<u8> = (0..SIZE.pow(3)).map(label).collect();
    folder.file("labels.nii", &nifti(&[16, 16, 16], AFFINE, &values));
    folder
}

fn open(page: &mut Page, source: Value) {
    page.ask(json!({ "do": "open", "slot": "a", "source": source }));
}

/// Puts the labels into view 0; nothing is made of them.
fn show(page: &mut Page, settings: Value) -> Value {
    let mut settings = settings;
    settings["materials"] = true.into();
    page.ask(json!({ "do": "shroud", "view": 0, "slot": "a", "settings": settings }))
}

fn run(page: &mut Page) -> Value {
    page.ask(json!({ "do": "run", "view": 0 }));
    let end = page.solver("done");
    page.event("settled");
    end
}

fn without_times(report: &Value) -> Value {
    let mut report = report.clone();
    (report["times"], report["memory"]) = (Value::Null, Value::Null);
    report
}

/// The volume that triangles enclose together, as if they all faced away from label `place`.
fn volume(mesh: &super::client::Frame, interfaces: &super::client::Frame, place: u32) -> f64 {
    let (words, numbers) = (mesh.words(), mesh.numbers());
    let [vertices, triangles] = [words[0] as usize, words[1] as usize];
    let corner = |v: u32| {
        let at = 2 + 3 * v as usize;
        [0, 1, 2].map(|d| f64::from(numbers[at + d]))
    };
    let mut rows = words[2 + 3 * vertices..].chunks(3);
    assert_eq!(words.len(), 2 + 3 * (vertices + triangles));
    let runs = interfaces.words();
    let mut sum = 0.0;
    for run in runs[2..].chunks(3).take(runs[0] as usize) {
        for row in rows.by_ref().take(run[2] as usize) {
            let [a, b, c] = [row[0], row[1], row[2]].map(corner);
            let cross = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
            let part = a[0] * cross(1, 2) + a[1] * cross(2, 0) + a[2] * cross(0, 1);
            let sign = f64::from(u8::from(run[0] == place)) - f64::from(u8::from(run[1] == place));
            sum += sign * part / 6.0;
        }
    }
    assert_eq!(rows.count(), 0, "every triangle is in one run");
    sum
}

#[test]
fn interfaces_are_those_of_the_command_line() {
    let folder = folder();
    let bed = Bed::start(&folder, "");
    let mut page = bed.page();
    open(&mut page, json!({ "path": "labels.nii" }));
    for (labels, settings, words) in [
        (None, json!({}), ""),
        (None, json!({ "preset": "fast", "faces": "join" }), "--preset=fast --faces=join"),
        (Some([9, 1]), json!({ "preset": "exact" }), "--label=9 --label=1 --preset=exact"),
    ] {
        page.ask(json!({ "do": "select", "slot": "a", "labels": labels }));
        let made = show(&mut page, settings.clone());
        let places = made["surface"]["materials"].clone();
        assert_eq!(places, if labels.is_some() { json!([0, 1, 9]) } else { json!([0, 1, 4, 9]) });
        let end = run(&mut page);
        let call = page.ask(json!({ "do": "command", "view": 0 }))["command"].clone();
        let call = call.as_str().unwrap().strip_prefix("shrouds ").unwrap();
        for word in words.split_whitespace().chain(["--materials", "-o mesh.ply"]) {
            assert!(call.contains(word), "{call}");
        }
        folder.succeed(&format!("{call} --report report.json"));
        let written = folder.json("report.json");
        let report = page.ask(json!({ "do": "report", "view": 0 }))["report"].clone();
        assert_eq!(without_times(&report), without_times(&written));
        for name in ["status", "iterations"] {
            let told = if name == "status" { &end["status"] } else { &end["iteration"] };
            assert_eq!(told, &written["solver"][name]);
        }
        let numbers = page.ask(json!({ "do": "numbers", "view": 0 }));
        let topology = &written["topology"];
        for name in ["vertices", "triangles"] {
            assert_eq!(numbers[name], topology[name]);
        }
        let materials = &numbers["materials"];
        assert_eq!(materials["junctions"], topology["junction_points"]);
        assert_eq!(materials["labels"], written["labels"]);
        assert_eq!(materials["contacts"], written["contacts"]);
        assert_eq!((&numbers["wrong_side"], &numbers["manifold"]), (&json!(0), &json!(true)));
        // What the page draws.
        let (mesh, interfaces) = (page.last(4).clone(), page.last(10).clone());
        assert_eq!([mesh.view, mesh.revision], [interfaces.view, interfaces.revision]);
        assert_eq!(made["surface"]["revision"], mesh.revision);
        assert_eq!(topology["vertices"], mesh.words()[0]);
        assert_eq!(topology["triangles"], mesh.words()[1]);
        assert_eq!(topology["junction_lines"], interfaces.words()[1]);
        assert_eq!(written["contacts"].as_array().unwrap().len(), interfaces.count);
        for label in written["labels"].as_array().unwrap() {
            let place = places.as_array().unwrap().iter().position(|l| *l == label["label"]);
            let found = volume(&mesh, &interfaces, place.unwrap() as u32);
            let expected = label["volume"].as_f64().unwrap();
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
        let export = page.ask(json!({ "do": "export", "view": 0, "format": "ply" }));
        let path = format!("GET /download/{}", export["download"].as_str().unwrap());
        assert!(bed.request(&path, &[]).body == folder.bytes("mesh.ply"), "{call}");
    }
    for format in ["obj", "glb", "vtp", "3mf"] {
        page.ask(json!({ "do": "export", "view": 0, "format": format, "frame": "index" }));
    }
}

#[test]
fn the_cells_are_a_demo_with_labels() {
    let folder = Folder::new();
    let bed = Bed::start(&folder, "");
    let mut page = bed.page();
    open(&mut page, json!({ "demo": "cells", "size": 20 }));
    show(&mut page, json!({}));
    run(&mut page);
    let call = page.ask(json!({ "do": "command", "view": 0 }))["command"].clone();
    let (demo, mesh) = call.as_str().unwrap().split_once(" && ").unwrap();
    assert_eq!(demo, "shrouds demo cells --size=20");
    folder.succeed(demo.strip_prefix("shrouds ").unwrap());
    folder.succeed(mesh.strip_prefix("shrouds ").unwrap());
    let export = page.ask(json!({ "do": "export", "view": 0, "format": "ply" }));
    let path = format!("GET /download/{}", export["download"].as_str().unwrap());
    assert!(bed.request(&path, &[]).body == folder.bytes("mesh.ply"));
    folder.succeed("check mesh.ply --volume shrouds-demo/volume.npy");
    // As one body it is a ball.
    page.ask(json!({ "do": "shroud", "view": 0, "slot": "a" }));
    let call = page.ask(json!({ "do": "command", "view": 0 }));
    assert_eq!(call["command"], "shrouds demo cells --size=20");
    page.ask(json!({ "do": "step", "view": 0 }));
    // Some labels as one body.
    page.ask(json!({ "do": "select", "slot": "a", "labels": [2, 3] }));
    page.ask(json!({ "do": "shroud", "view": 0, "slot": "a" }));
    let call = page.ask(json!({ "do": "command", "view": 0 }))["command"].clone();
    let (_, mesh) = call.as_str().unwrap().split_once(" && shrouds ").unwrap();
    assert_eq!(mesh, "mesh shrouds-demo/volume.npy --label=2 --label=3 -o mesh.ply");
    folder.succeed(mesh);
}

#[test]
fn the_labels_of_a_page_that_goes_are_not_waited_for_long() {
    let bed = Bed::start(&Folder::new(), "--threads 1");
    let threads = bed.threads();
    for _ in 0..3 {
        let mut page = bed.page();
        open(&mut page, json!({ "demo": "cells", "size": 40 }));
        show(&mut page, json!({}));
        page.ask(json!({ "do": "run", "view": 0 }));
    }
    let mut page = bed.page();
    open(&mut page, json!({ "demo": "cells", "size": 16 }));
    show(&mut page, json!({}));
    run(&mut page);
    drop(page);
    let start = Instant::now();
    while bed.threads() > threads && start.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(20));
    }
    assert_eq!(bed.threads(), threads);
}

#[test]
fn what_interfaces_have_not_is_said() {
    let folder = folder();
    let bed = Bed::start(&folder, "");
    let mut page = bed.page();
    open(&mut page, json!({ "path": "labels.nii" }));
    show(&mut page, json!({}));
    for (request, part) in [
        (json!({ "do": "numbers", "view": 0 }), "not made yet"),
        (json!({ "do": "report", "view": 0 }), "not made yet"),
        (json!({ "do": "export", "view": 0, "format": "ply" }), "not made yet"),
    ] {
        let refusal = page.refusal(request.clone());
        assert!(refusal.contains(part), "{request}: {refusal}");
    }
    run(&mut page);
    let brush =
        json!({ "do": "brush", "slot": "a", "add": false, "centre": [8, 8, 8], "radius": 2 });
    for (request, part) in [
        (json!({ "do": "step", "view": 0 }), "in one piece"),
        (json!({ "do": "pause", "view": 0 }), "in one piece"),
        (json!({ "do": "reset", "view": 0 }), "several labels"),
        (json!({ "do": "sizes", "view": 0 }), "several labels"),
        (json!({ "do": "pick", "view": 0, "vertex": 0 }), "several labels"),
        (json!({ "do": "colours", "view": 0, "field": "delta" }), "several labels"),
        (json!({ "do": "contours", "view": 0, "axis": "x", "every": 4 }), "several labels"),
        (brush.clone(), "cannot be changed by hand"),
        (json!({ "do": "undo", "slot": "a" }), "cannot be changed by hand"),
        (json!({ "do": "redo", "slot": "a" }), "cannot be changed by hand"),
        (json!({ "do": "export", "view": 0, "format": "stl" }), "ply, vtp"),
        (json!({ "do": "export", "view": 0, "format": "npy" }), "ply, vtp"),
        (json!({ "do": "export", "view": 0, "format": "shroud" }), "ply, vtp"),
        (
            json!({ "do": "compare", "slot": "a", "energies": [], "settings": { "materials": true } }),
            "one body",
        ),
    ] {
        let refusal = page.refusal(request.clone());
        assert!(refusal.contains(part), "{request}: {refusal}");
    }
    // Slices and lattice points are those of the volume.
    page.ask(json!({ "do": "slice", "slot": "a", "axis": "z", "index": 8 }));
    // With one body in the view the volume can be changed, and has no labels from then on.
    page.ask(json!({ "do": "shroud", "view": 0, "slot": "a" }));
    page.ask(brush);
    let again =
        json!({ "do": "shroud", "view": 0, "slot": "a", "settings": { "materials": true } });
    assert!(page.refusal(again).contains("changed here"));
}

#[test]
fn labels_that_are_none_are_refused() {
    let folder = folder();
    let many: Vec<u8> = (0..1200u16).flat_map(u16::to_le_bytes).collect();
    folder.file("many.npy", &npy("<u2", "(10, 10, 12)", &many));
    let grey: Vec<u8> = (0..64).flat_map(|n| (0.3 * f64::from(n)).to_le_bytes()).collect();
    folder.file("grey.npy", &npy("<f8", "(4, 4, 4)", &grey));
    folder.file("one.npy", &npy("|u1", "(3, 3, 3)", &[7; 27]));
    let bed = Bed::start(&folder, "");
    let mut page = bed.page();
    let shroud =
        |settings: Value| json!({ "do": "shroud", "view": 0, "slot": "a", "settings": settings });
    let wanted = || shroud(json!({ "materials": true }));
    for (source, part) in [
        (json!({ "demo": "tori", "size": 12 }), "tori has no labels"),
        (json!({ "path": "many.npy" }), "too many"),
        (json!({ "path": "grey.npy" }), "no labels"),
        (json!({ "path": "one.npy" }), "at least two labels"),
    ] {
        open(&mut page, source.clone());
        let refusal = page.refusal(wanted());
        assert!(refusal.contains(part), "{source}: {refusal}");
    }
    open(&mut page, json!({ "path": "labels.nii" }));
    for (labels, part) in [
        (json!([4]), "at least two"),
        (json!([4, 4]), "at least two"),
        (json!([0, 4]), "at least two"),
        (json!([4, 77]), "only 4 has voxels"),
        (json!([76, 77]), "no voxel has label 76, 77"),
        (json!([i64::MIN, i64::MAX]), "no voxel has label"),
    ] {
        page.ask(json!({ "do": "select", "slot": "a", "labels": labels }));
        let refusal = page.refusal(wanted());
        assert!(refusal.contains(part), "{labels}: {refusal}");
    }
    let thousands: Vec<i64> = (0..5000).collect();
    let refusal = page.refusal(json!({ "do": "select", "slot": "a", "labels": thousands }));
    assert!(refusal.contains("at most 1024"), "{refusal}");
    page.ask(json!({ "do": "select", "slot": "a", "threshold": 2 }));
    assert!(page.refusal(wanted()).contains("no threshold"));
    page.ask(json!({ "do": "select", "slot": "a" }));
    for settings in [
        json!({ "materials": true, "energy": "linear" }),
        json!({ "materials": true, "surface": "dual" }),
        json!({ "materials": true, "border": "open" }),
        json!({ "materials": "yes" }),
        json!({ "materials": [1, 4] }),
    ] {
        let refusal = page.refusal(shroud(settings.clone()));
        assert!(refusal.contains("materials"), "{settings}: {refusal}");
    }
    page.ask(wanted());
    run(&mut page);
}

#[test]
fn interfaces_that_nobody_wants_are_dropped() {
    let bed = Bed::start(&Folder::new(), "--threads 1");
    let mut page = bed.page();
    open(&mut page, json!({ "demo": "cells", "size": 48 }));
    show(&mut page, json!({ "preset": "exact" }));
    page.ask(json!({ "do": "run", "view": 0 }));
    // A second time it is being done already.
    page.ask(json!({ "do": "run", "view": 0 }));
    page.ask(json!({ "do": "cancel", "view": 0 }));
    page.solver("cancelled");
    assert!(page.refusal(json!({ "do": "numbers", "view": 0 })).contains("not made yet"));
    page.ask(json!({ "do": "run", "view": 0 }));
    // Something else in their view takes their place at once; they are not heard of again.
    let body = page.ask(json!({ "do": "shroud", "view": 0, "slot": "a" }));
    page.ask(json!({ "do": "run", "view": 0 }));
    page.solver("done");
    assert_eq!(page.event("settled")["revision"], body["surface"]["revision"]);
    show(&mut page, json!({ "preset": "fast" }));
    run(&mut page);
    let newest = page.last(10).revision;
    assert_eq!(page.frames.iter().filter(|frame| frame.kind == 10).count(), 1);
    assert!(u64::from(newest) > body["surface"]["revision"].as_u64().unwrap());
}
