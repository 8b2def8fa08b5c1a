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
        let numbers = page.ask(json!({ "do": "numbers", "view": 0 }));
        assert_eq!(numbers["volume"], report["geometry"]["volume"]);
        assert_eq!(numbers["area"], report["geometry"]["area"]);
        assert_eq!(numbers["true_volume"], report["geometry"]["true_volume"]);
        assert_eq!(numbers["triangles"], report["topology"]["triangles"]);
        assert_eq!((&numbers["wrong_side"], &numbers["manifold"]), (&json!(0), &json!(true)));
    }
}

#[test]
fn sizes_are_those_of_packed_files_and_come_by_themselves() {
    let folder = Folder::new();
    folder.succeed("demo tori --size 24 --quiet -o demo");
    let bed = Bed::start(&folder, "");
    let mut page = finished(&bed, json!({}));
    page.ask(json!({ "do": "sizes", "view": 0 }));
    for bits in [0, 1, 2, 4, 8] {
        let size = page.event("size");
        assert_eq!((&size["bits"], &size["revision"]), (&json!(bits), &json!(1)));
        folder.succeed(&format!("pack demo/volume.npy --bits {bits} -o packed.shroud"));
        let length = folder.bytes("packed.shroud").len();
        assert_eq!(size["bytes"], length, "{bits} bits");
    }
    // Whoever asks again ends what went on; the rest comes once.
    let before = page.events.iter().filter(|event| event["event"] == "size").count();
    for _ in 0..20 {
        page.ask(json!({ "do": "sizes", "view": 0 }));
    }
    while page.event("size")["bits"] != 8 {}
    let found = page.events.iter().filter(|event| event["event"] == "size").count() - before;
    assert!((5..100).contains(&found), "{found} sizes");
}

#[test]
fn a_brush_changes_the_volume_and_its_surface_follows() {
    let folder = Folder::new();
    let bed = Bed::start(&folder, "");
    let mut page = finished(&bed, json!({}));
    let before = page.last(2).numbers();
    let stroke = json!({
        "do": "brush", "slot": "a", "add": true, "centre": [12, 12, 12], "radius": 4, "follow": true,
    });
    let changed = page.ask(stroke.clone());
    assert!(changed["changed"].as_u64().unwrap() > 100);
    assert_eq!(changed["surfaces"][0]["revision"], 2);
    assert_eq!(page.last(1).revision, 2, "the new surface comes before the answer");
    page.ask(json!({ "do": "run", "view": 0 }));
    page.solver("done");
    page.event("settled");
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
        page.ask(json!({ "do": "run", "view": 0 }));
        page.solver("done");
        page.event("settled");
        assert_eq!(page.last(1).revision, revision);
    }
    assert_eq!(page.last(2).numbers(), before);
}

/// The finished tori after two dabs of one stroke, and what was answered to them.
fn painted(bed: &Bed, settings: Value, follow: bool) -> (Page, [Value; 2]) {
    let mut page = finished(bed, settings);
    let answers = [[4.0, 12.0, 12.0], [5.0, 13.0, 12.0]].map(|centre| {
        page.ask(json!({
            "do": "brush", "slot": "a", "add": true, "centre": centre, "radius": 2,
            "stroke": 1, "follow": follow,
        }))
    });
    (page, answers)
}

#[test]
fn surfaces_follow_a_stroke_where_it_reaches_them() {
    let bed = Bed::start(&Folder::new(), "");
    let (mut page, answers) = painted(&bed, json!({}), true);
    let volume = named("tori", 24).unwrap().volume;
    let settings = Settings::default();
    let mut live = shrouds::LiveShroud::new(&volume, &settings).unwrap();
    let mut edited = volume.clone();
    for (answer, centre) in answers.iter().zip([[4.0, 12.0, 12.0_f64], [5.0, 13.0, 12.0]]) {
        assert_eq!(answer["surfaces"][0]["followed"], true);
        let near =
            |p: [usize; 3]| (0..3).map(|d| (p[d] as f64 - centre[d]).powi(2)).sum::<f64>() <= 4.0;
        let next = shrouds::Occupancy::from_fn(edited.grid().clone(), |p| edited.get(p) || near(p));
        edited = next;
        live.update(&edited, [0..24, 0..24, 0..24]).unwrap();
    }
    let expected: Vec<f32> = live.delta().iter().map(|&delta| delta as f32).collect();
    assert_eq!(page.last(2).numbers(), expected);
    assert!(!page.events.iter().any(|event| event["view"] == 0 && event["revision"] == 3));
    let undone = page.ask(json!({ "do": "undo", "slot": "a" }));
    assert_eq!(undone["volume"]["inside"], volume.count(), "a stroke is taken back as a whole");
    assert_eq!(
        (&undone["volume"]["undo"], &undone["volume"]["redo"]),
        (&json!(false), &json!(true))
    );
    assert_eq!(undone["surfaces"][0]["followed"], false);
    // From a surface that followed the way back to the start is that of a fresh one.
    page.ask(json!({ "do": "redo", "slot": "a", "follow": true }));
    page.ask(json!({ "do": "reset", "view": 0 }));
    page.event("settled");
    let start = page.last(2).numbers();
    page.ask(json!({ "do": "shroud", "view": 0, "slot": "a" }));
    page.ask(json!({ "do": "hello" }));
    assert_eq!(page.last(2).numbers(), start);
}

#[test]
fn surfaces_that_cannot_follow_keep_what_they_had_and_wait() {
    let bed = Bed::start(&Folder::new(), "");
    for (settings, follow) in [(json!({ "solver": "sweeps" }), true), (json!({}), false)] {
        let (mut page, answers) = painted(&bed, settings, follow);
        assert!(answers.iter().all(|answer| answer["surfaces"][0]["followed"] == false));
        let runs =
            |page: &Page| page.events.iter().filter(|event| event["event"] == "solver").count();
        let before = runs(&page);
        let numbers = page.ask(json!({ "do": "numbers", "view": 0 }));
        assert_eq!(runs(&page), before, "no solver runs by itself");
        assert_eq!(numbers["wrong_side"], 0);
    }
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
