//! `mesh --materials`: the interfaces of all labels.

use serde_json::{Value, json};
use shrouds_io::read_mesh;

use crate::common::{Folder, cut_ball, npy};

const SIZE: usize = 20;

fn label(n: usize) -> u8 {
    cut_ball(SIZE, 55.0, n)
}

fn folder() -> Folder {
    let folder = Folder::new();
    let values: Vec<u8> = (0..SIZE.pow(3)).map(label).collect();
    folder.file("labels.npy", &npy("|u1", "(20, 20, 20)", &values));
    folder
}

#[test]
fn one_mesh_has_every_interface_once_and_the_report_every_label_and_contact() {
    let folder = folder();
    folder.succeed("mesh labels.npy --materials -o all.ply --report all.json --picture all.png");
    let report = folder.json("all.json");
    for (check, count) in report["checks"].as_object().unwrap() {
        assert_eq!(count, 0, "{check}");
    }
    let pairs: Vec<_> =
        report["contacts"].as_array().unwrap().iter().map(|c| &c["labels"]).collect();
    assert_eq!(json!(pairs), json!([[1, 0], [1, 4], [1, 9], [4, 0], [4, 9], [9, 0]]));
    let labels = report["labels"].as_array().unwrap();
    let volume: f64 = labels.iter().map(|label| label["volume"].as_f64().unwrap()).sum();
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 55f64.powf(1.5);
    // The chords of so small a ball lose some, and curves that end at junctions some more.
    assert!((volume / ball - 1.0).abs() < 0.05, "{volume} {ball}");
    // Half of all boundaries but those with the background.
    let area = |of: &str| -> f64 {
        report[of].as_array().unwrap().iter().map(|one| one["area"].as_f64().unwrap()).sum()
    };
    let contacts = report["contacts"].as_array().unwrap().iter();
    let outer = contacts.filter(|c| c["labels"][1] == 0).map(|c| c["area"].as_f64().unwrap());
    assert!((area("labels") - 2.0 * area("contacts") + outer.sum::<f64>()).abs() < 1e-6);
    let triangles = report["topology"]["triangles"].as_u64().unwrap();
    assert_eq!(folder.mesh("all.ply").triangles.len() as u64, triangles);
    for name in ["all.vtp", "all.glb", "all.obj", "all.3mf"] {
        folder.succeed(&format!("mesh labels.npy --materials -o {name}"));
    }
    assert_eq!(read_mesh(folder.path("all.obj")).unwrap().triangles.len() as u64, triangles);
}

#[test]
fn labels_enclose_their_voxels_if_they_are_to() {
    let folder = folder();
    let call = "mesh labels.npy --materials --volume keep -o all.ply --report all.json";
    let said = folder.run(call).err;
    assert!(said.contains("volumes of 3 labels kept to"), "{said}");
    let report = folder.json("all.json");
    assert_eq!(report["solver"]["kept_volumes"]["held"], json!([]));
    for label in report["labels"].as_array().unwrap() {
        let [volume, voxels] = ["volume", "voxels"].map(|key| label[key].as_f64().unwrap());
        assert!((volume / voxels - 1.0).abs() < 1e-9, "{label}");
    }
}

#[test]
fn the_closed_meshes_of_a_folder_are_certified_and_share_their_corners() {
    let folder = folder();
    folder.succeed("mesh labels.npy --materials -o organs --preset fast");
    let places = |label: u8| -> std::collections::BTreeSet<[u64; 3]> {
        let mesh = folder.mesh(&format!("organs/label-{label}.ply"));
        mesh.vertices.iter().map(|place| place.map(f64::to_bits)).collect()
    };
    for label in [1, 4, 9] {
        let file = format!("organs/label-{label}.ply");
        folder.succeed(&format!("check {file} --volume labels.npy --label {label}"));
    }
    assert!(places(4).intersection(&places(1)).count() > 20);
    assert_eq!(folder.run("mesh labels.npy --materials -o all.stl").code, 2);
    assert_eq!(folder.run("mesh labels.npy --materials -o all.ply --energy linear").code, 2);
    assert_eq!(folder.run("mesh labels.npy --materials --label 4 -o all.ply").code, 2);
}

#[test]
fn labels_that_are_not_chosen_are_background() {
    let folder = folder();
    folder.succeed("mesh labels.npy --materials --label 9 --label 1 -o two.ply --report two.json");
    let others = |n: usize| if label(n) == 4 { 0 } else { label(n) };
    let values: Vec<u8> = (0..SIZE.pow(3)).map(others).collect();
    folder.file("others.npy", &npy("|u1", "(20, 20, 20)", &values));
    folder.succeed("mesh others.npy --materials -o expected.ply");
    assert!(folder.bytes("two.ply") == folder.bytes("expected.ply"));
    folder.succeed("check two.ply --volume labels.npy --label 1 --label 9");
    assert_eq!(folder.run("check two.ply --volume labels.npy").code, 1, "label 4 is missing");
    for (words, part) in [
        ("--label 4 --label 4", "at least two"),
        ("--label 4 --label 0", "at least two"),
        ("--label 4 --label 5", "only 4 has voxels"),
        ("--label 5 --label 6", "no voxel has label 5, 6"),
    ] {
        let done = folder.run(&format!("mesh labels.npy --materials {words} -o no.ply"));
        assert!(done.code > 0 && done.err.contains(part), "{words}: {}", done.err);
    }
}

#[test]
fn one_mesh_of_all_labels_is_checked_and_measured_as_it_is() {
    let folder = folder();
    folder.succeed("mesh labels.npy --materials -o all.ply --report all.json --preset fast");
    let made = folder.json("all.json");
    let parsed = |text: String| -> Value { serde_json::from_str(&text).unwrap() };
    let checked = parsed(folder.succeed("check all.ply --volume labels.npy --json"));
    assert_eq!(checked["checks"], made["checks"]);
    assert_eq!(checked["contacts"].as_array().unwrap().len(), 6);
    let near = |a: &Value, b: &Value| {
        let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
        assert!((a - b).abs() < 1e-4 * b, "{a} {b}");
    };
    let measured = parsed(folder.succeed("measure all.ply --json"));
    let (rows, labels) = (measured["rows"].as_array().unwrap(), made["labels"].as_array().unwrap());
    assert_eq!(rows.len(), 3);
    for (row, label) in rows.iter().zip(labels) {
        assert_eq!(row["label"], label["label"]);
        // What chords cut off is added, some per cent of so small a body.
        let [found, chords] = [row, label].map(|of| of["volume"].as_f64().unwrap());
        assert!((1.0..1.03).contains(&(found / chords)), "{found} {chords}");
    }
    // Between two labels, and between each and the outside.
    let contacts = made["contacts"].as_array().unwrap();
    let between: Vec<&Value> = contacts.iter().filter(|c| c["labels"][1] != 0).collect();
    assert_eq!(measured["contacts"].as_array().unwrap().len(), between.len());
    for (found, contact) in measured["contacts"].as_array().unwrap().iter().zip(between) {
        assert_eq!(json!([found["label"], found["other"]]), contact["labels"]);
        near(&found["area"], &contact["area"]);
    }
    let outside = contacts.iter().filter(|c| c["labels"][1] == 0);
    for (row, contact) in rows.iter().zip(outside) {
        near(&row["contact_outside"], &contact["area"]);
    }
    // One voxel of label 4 becomes one of label 9.
    let mut values: Vec<u8> = (0..SIZE.pow(3)).map(label).collect();
    let inside = (0..SIZE.pow(3)).find(|&n| (0..3).all(|k| values[n + k * SIZE * SIZE] == 4));
    values[inside.unwrap() + SIZE * SIZE] = 9;
    folder.file("other.npy", &npy("|u1", "(20, 20, 20)", &values));
    let done = folder.run("check all.ply --volume other.npy");
    assert_eq!(done.code, 1, "{}", done.out);
    assert!(done.err.contains("in another label") && done.out.contains("FAIL  label 4"));
    folder.refuse("check all.ply --volume labels.npy --label 4", 2, &["--label", "closed mesh"]);
}
