//! What is laid over a surface, and changes of its volume.

use serde_json::{Value, json};
use shrouds::volume::phantom::named;
use shrouds::{Settings, shroud};

use super::client::{Bed, Page};
use crate::common::Folder;

/// A page with the finished tori in view 0.
fn finished(bed: &Bed, settings: Value) -> Page {
    let mut page = bed.page();
    page.ask(json!({ "do": "open", "slot": "a", "source": { "demo": "tori", "size": 24 } }));
    page.ask(json!({ "do": "shroud", "view": 0, "slot": "a", "settings": settings }));
    page.ask(json!({ "do": "run", "view": 0 }));
    page.solver("done");
    page.event("settled");
    page
}

/// Asks, and waits for the frame that follows the answer.
fn shown(page: &mut Page, request: Value, kind: u32) -> Value {
    let answer = page.ask(request);
    let count = page.frames.len();
    page.ask(json!({ "do": "hello" }));
    assert!(page.frames[count..].iter().any(|frame| frame.kind == kind), "{answer}");
    answer
}

#[test]
fn overlays_fit_the_surface() {
    let bed = Bed::start(&Folder::new(), "");
    let mut page = finished(&bed, json!({}));
    let volume = named("tori", 24).unwrap().volume;
    let made = shroud(&volume, &Settings::default()).unwrap();
    let vertices = made.mesh.vertices.len();
    for field in ["mean-curvature", "gaussian-curvature", "delta", "displacement"] {
        let request = json!({ "do": "colours", "view": 0, "field": field });
        let colours = shown(&mut page, request, 6);
        assert_eq!(page.last(6).count, vertices);
        let [low, high] = ["low", "high"].map(|end| colours[end].as_f64().unwrap());
        assert!(low < high && colours["legend"].as_array().unwrap().len() >= 2, "{colours}");
    }
    let displacement = page.last(6).numbers();
    for (moved, delta) in displacement.iter().zip(&made.delta) {
        assert!((f64::from(*moved) - (0.5 - delta)).abs() < 1e-6);
    }
    let request = json!({ "do": "contours", "view": 0, "axis": "z", "every": 2 });
    let contours = shown(&mut page, request, 7);
    let lines = page.last(7).words();
    assert_eq!(contours["contours"], lines[0]);
    let first = 1 + lines[0] as usize;
    let heights = lines[first..].chunks(3).map(|point| f32::from_bits(point[2]));
    assert!(heights.into_iter().all(|z| (z / 2.0 - (z / 2.0).round()).abs() < 1e-5));
    shown(&mut page, json!({ "do": "points", "slot": "a", "near": 1 }), 8);
    for point in page.last(8).words().chunks(4) {
        let index = [0, 1, 2].map(|d| f32::from_bits(point[d]) as usize);
        assert_eq!(volume.get(index), point[3] == 1);
    }
    let inside =
        shown(&mut page, json!({ "do": "slice", "slot": "a", "axis": "z", "index": 12 }), 9);
    assert_eq!((&inside["width"], &inside["shows"]), (&json!(24), &json!("inside")));
    let image = page.last(9);
    assert_eq!(image.payload.len(), 8 + 36 + 4 * 24 * 24);
    for (n, pixel) in image.payload[44..].chunks(4).enumerate() {
        assert_eq!(volume.get([n % 24, n / 24, 12]), pixel[0] > 128);
    }
    let vertex = page.ask(json!({ "do": "pick", "view": 0, "vertex": 100 }));
    let crossing = made.surface.crossing(100);
    assert_eq!(vertex["edge"]["inside"], json!(crossing.inside().map(|index| index as i64 - 1)));
    assert_eq!(vertex["delta"], made.delta[100]);
    assert_eq!(vertex["neighbours"].as_array().unwrap().iter().filter(|n| n.is_u64()).count(), 4);
    assert!(vertex["rho"].as_array().unwrap().iter().all(|rho| rho.as_f64().unwrap() >= 0.0));
}

#[test]
fn numbers_are_those_of_the_report() {
    let folder = Folder::new();
    let bed = Bed::start(&folder, "");
    for settings in [json!({ "preset": "fast" }), json!({ "surface": "dual" })] {
        let words: String = settings
            .as_object()
            .unwrap()
            .iter()
            .map(|(name, value)| format!(" --{name} {}", value.as_str().unwrap()))
            .collect();
        folder.succeed(&format!("demo tori --size 24 --quiet -o demo{words}"));
        let report = folder.json("demo/report.json");
        let mut page = finished(&bed, settings);
        let numbers = page.ask(json!({ "do": "numbers", "view": 0, "bits": true }));
        assert_eq!(numbers["volume"], report["geometry"]["volume"]);
        assert_eq!(numbers["area"], report["geometry"]["area"]);
        assert_eq!(numbers["true_volume"], report["geometry"]["true_volume"]);
        assert_eq!(numbers["triangles"], report["topology"]["triangles"]);
        assert_eq!((&numbers["wrong_side"], &numbers["manifold"]), (&json!(0), &json!(true)));
        let sizes = ["0", "1", "2", "4", "8"].map(|bits| numbers["bits"][bits].as_u64().unwrap());
        assert!(sizes.is_sorted() && sizes[0] > 0, "{sizes:?}");
        folder.succeed("pack demo/volume.npy --bits 0 -o packed.shroud");
        assert_eq!(sizes[0] as usize, folder.bytes("packed.shroud").len());
    }
}

#[test]
fn a_brush_changes_the_volume_and_its_surface_follows() {
    let folder = Folder::new();
    let bed = Bed::start(&folder, "");
    let mut page = finished(&bed, json!({}));
    let before = page.last(2).numbers();
    let stroke =
        json!({ "do": "brush", "slot": "a", "add": true, "centre": [12, 12, 12], "radius": 4 });
    let changed = page.ask(stroke.clone());
    assert!(changed["changed"].as_u64().unwrap() > 100);
    assert_eq!(changed["surfaces"][0]["revision"], 2);
    page.solver("done");
    page.event("settled");
    assert_eq!(page.last(1).revision, 2);
    // What the command line makes of the volume as it is now.
    let made = page.ask(json!({ "do": "export", "view": 0, "format": "npy" }));
    let path = format!("GET /download/{}", made["download"].as_str().unwrap());
    folder.file("edited.npy", &bed.request(&path, &[]).body);
    folder.succeed("mesh edited.npy -o edited.ply");
    let made = page.ask(json!({ "do": "export", "view": 0, "format": "ply" }));
    let path = format!("GET /download/{}", made["download"].as_str().unwrap());
    assert_eq!(bed.request(&path, &[]).body, folder.bytes("edited.ply"));
    assert_eq!(page.ask(stroke)["changed"], 0, "nothing is left to add");
    for (task, revision) in [("undo", 3), ("redo", 4), ("undo", 5)] {
        page.ask(json!({ "do": task, "slot": "a" }));
        page.solver("done");
        page.event("settled");
        assert_eq!(page.last(1).revision, revision);
    }
    assert_eq!(page.last(2).numbers(), before);
}

#[test]
fn volumes_are_made_of_volumes() {
    let bed = Bed::start(&Folder::new(), "");
    let mut page = bed.page();
    for (slot, demo) in [("a", "ball"), ("b", "box")] {
        page.ask(json!({ "do": "open", "slot": slot, "source": { "demo": demo, "size": 20 } }));
    }
    let [ball, cuboid] = ["ball", "box"].map(|name| named(name, 20).unwrap().volume);
    let request =
        json!({ "do": "combine", "operation": "intersect", "a": "a", "b": "b", "into": "c" });
    let both = page.ask(request);
    let operation = shrouds::volume::Operation::Intersect;
    assert_eq!(both["volume"]["inside"], ball.combine(operation, &cuboid).unwrap().count());
    let grown = page.ask(json!({ "do": "offset", "slot": "a", "by": 1.5, "into": "b" }));
    assert!(grown["volume"]["inside"].as_u64().unwrap() > ball.count());
    page.ask(json!({ "do": "shroud", "view": 2, "slot": "b" }));
    let call = page.ask(json!({ "do": "command", "view": 2 }));
    assert!(
        call["note"].is_string() && call["command"].as_str().unwrap().contains("volume.nii.gz")
    );
}

#[test]
fn energies_are_compared_and_regions_are_shown() {
    let folder = Folder::new();
    let bed = Bed::start(&folder, "");
    let mut page = bed.page();
    page.ask(json!({ "do": "open", "slot": "a", "source": { "demo": "tori", "size": 20 } }));
    let energies = ["bending", "linear(chord)"];
    page.ask(json!({ "do": "compare", "slot": "a", "energies": energies }));
    let call = "compare demo:tori --size 20 --energies bending;linear(chord) --json";
    let table: Value = serde_json::from_str(&folder.succeed(call)).unwrap();
    let rows: Vec<&Value> = page.events.iter().filter(|event| event["event"] == "row").collect();
    assert_eq!(rows.len(), 2);
    for (row, expected) in rows.iter().zip(table["energies"].as_array().unwrap()) {
        for field in ["energy", "status", "iterations", "value", "volume", "area", "roughness"] {
            assert_eq!(row["row"][field], expected[field], "{field}");
        }
    }
    let scene = page.ask(json!({ "do": "scene", "demo": "figure9" }));
    let steps = scene["steps"].as_array().unwrap();
    let found = shown(&mut page, json!({ "do": "scene_step", "step": 0, "into": "c" }), 7);
    assert_eq!(found["volume"]["inside"], steps[0]["inside"]);
    assert!(
        page.refusal(json!({ "do": "scene_step", "step": 99, "into": "c" })).contains("no step")
    );
}
