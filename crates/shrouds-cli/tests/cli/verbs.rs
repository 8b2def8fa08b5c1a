//! `demo`, `info`, `render`, and what all verbs share.

use std::process::Stdio;

use serde_json::Value;

use crate::common::{Folder, command, nifti, npy};

#[test]
fn demo_writes_four_files_and_tells_the_numbers() {
    let folder = Folder::new();
    let told = folder.succeed("demo");
    for part in [
        "tori",
        "14,626 inside, of 64 × 64 × 64",
        "truth",
        "0 of 262,144 voxels",
        "before convergence",
        "mesh.ply",
    ] {
        assert!(told.contains(part), "no '{part}' in {told}");
    }
    let inside = |name: &str| folder.bytes(&format!("shrouds-demo/{name}"));
    let files = ["mesh.ply", "picture.png", "report.json", "volume.npy"];
    assert!(files.iter().all(|name| !inside(name).is_empty()));
    let report = folder.json("shrouds-demo/report.json");
    let truth = report["geometry"]["true_volume"].as_f64().unwrap();
    let volume = report["geometry"]["volume"].as_f64().unwrap();
    assert!((volume / truth - 1.0).abs() < 0.01, "{volume}, {truth}");
    // What it built can be shrouded again, to the same bytes.
    folder.succeed("mesh shrouds-demo/volume.npy -o again.ply --quiet");
    assert_eq!(folder.bytes("again.ply"), inside("mesh.ply"));
    // It may be called again.
    let done = folder.run("demo --json --quiet");
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    let again: Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(again["topology"], report["topology"]);
}

#[test]
fn demos_of_other_phantoms() {
    let folder = Folder::new();
    folder.succeed("demo point --output point --quiet");
    assert_eq!(folder.mesh("point/mesh.ply").triangles.len(), 8);
    folder.succeed("demo noise --size 8 --output deep/noise --quiet --faces join");
    assert_eq!(folder.json("deep/noise/report.json")["checks"]["ok"], true);
    folder.succeed("demo noise --size 8 --output noise --quiet --surface dual");
    assert_eq!(folder.json("noise/report.json")["checks"]["ok"], true);
}

#[test]
fn info_on_a_volume() {
    let folder = Folder::new();
    let affine = [[-2.0, 0.0, 0.0, 90.0], [0.0, 2.0, 0.0, -126.0], [0.0, 0.0, 3.0, -72.0]];
    let mut data = [0; 24];
    data[..3].copy_from_slice(&[4, 4, 9]);
    folder.file("organs.nii", &nifti(&[4, 3, 2], affine, &data));
    let json: Value = serde_json::from_str(&folder.succeed("info organs.nii --json")).unwrap();
    assert_eq!(json["kind"], "volume");
    assert_eq!(json["dims"], serde_json::json!([4, 3, 2]));
    assert_eq!(json["spacing"], serde_json::json!([2.0, 2.0, 3.0]));
    assert_eq!(json["affine"][0], serde_json::json!([-2.0, 0.0, 0.0, 90.0]));
    assert_eq!((&json["frame"], &json["unit"]), (&"RAS".into(), &"mm".into()));
    assert_eq!(json["range"], serde_json::json!([0.0, 9.0]));
    assert_eq!(json["labels"][1], serde_json::json!({"label": 4, "voxels": 2}));
    assert_eq!(json["inside"], 3);
    let told = folder.succeed("info organs.nii --label 4");
    for part in ["4 × 3 × 2", "(2, 2, 3)", "RAS", "mm", "u8", "0 (21), 4 (2), 9 (1)", "2 voxels: 4"]
    {
        assert!(told.contains(part), "no '{part}' in {told}");
    }
}

#[test]
fn info_on_many_labels_shows_the_first() {
    let folder = Folder::new();
    let data: Vec<u8> = (0..125).collect();
    folder.file("many.npy", &npy("|u1", "(5, 5, 5)", &data));
    let told = folder.succeed("info many.npy");
    assert!(told.contains("19 (1) and 105 more"), "{told}");
    let json: Value = serde_json::from_str(&folder.succeed("info many.npy --json")).unwrap();
    assert_eq!(json["labels"].as_array().unwrap().len(), 125);
}

#[test]
fn info_on_a_mesh() {
    let folder = Folder::with_tori();
    let report: Value =
        serde_json::from_str(&folder.succeed("mesh volume.npy -o out.ply --json")).unwrap();
    let json: Value = serde_json::from_str(&folder.succeed("info out.ply --json")).unwrap();
    assert_eq!(json["kind"], "mesh");
    assert_eq!(json["vertices"], report["topology"]["vertices"]);
    assert_eq!((&json["closed"], &json["components"]), (&true.into(), &2.into()));
    let [told, wanted] = [&json, &report["geometry"]].map(|v| v["volume"].as_f64().unwrap());
    assert!((told / wanted - 1.0).abs() < 1e-5);
    assert!(json["bounds"][0][0].as_f64() < json["bounds"][1][0].as_f64());
    assert!(folder.succeed("info out.ply").contains("Euler characteristic 0"));
}

#[test]
fn render_draws_meshes_and_volumes() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o out.ply --quiet --picture mesh.png");
    let small = "--width 120 --height 90";
    folder.succeed(&format!("render out.ply -o a.png {small} --perspective --smooth"));
    folder.succeed(&format!("render volume.npy -o b.png {small} --azimuth -20 --elevation -10"));
    folder.succeed(&format!("render volume.npy -o c.png {small} --network --zoom 2"));
    folder.succeed(&format!("render out.ply -o d.png {small} --colour 00FF00"));
    folder.succeed("render volume.npy -o usual.png");
    // What is usual is the same everywhere.
    assert_eq!(folder.bytes("mesh.png"), folder.bytes("usual.png"));
    let pictures = ["a.png", "b.png", "c.png", "d.png"].map(|name| folder.bytes(name));
    for (n, picture) in pictures.iter().enumerate() {
        assert_eq!(&picture[16..24], &[0, 0, 0, 120, 0, 0, 0, 90], "width and height");
        assert!(pictures[n + 1..].iter().all(|other| other != picture));
    }
}

#[test]
fn help_has_an_example_for_every_verb() {
    let folder = Folder::new();
    for verb in ["demo", "mesh", "check", "info", "render", "compare", "polygon", "view"] {
        let help = folder.succeed(&format!("{verb} --help"));
        assert!(
            help.contains("Example") && help.contains(&format!("\n  shrouds {verb} ")),
            "{verb}"
        );
        assert!(help.contains("--threads") && help.contains("--quiet"), "{verb}");
        assert!(folder.succeed("--help").contains(verb));
        let makes_shrouds = !["check", "info", "view"].contains(&verb);
        for entry in shrouds::energy::catalogue() {
            let is_its = |line: &&str| {
                line.strip_prefix("  ").is_some_and(|line| line.starts_with(entry.name))
            };
            let line = help.lines().find(is_its);
            assert_eq!(line.is_some(), makes_shrouds, "{verb}: {}", entry.name);
            assert_eq!(
                line.is_some_and(|line| line.contains('*')),
                makes_shrouds && !entry.keeps_thin_parts
            );
        }
    }
    assert!(folder.succeed("--version").contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = Folder::with_tori();
    for verb in ["info volume.npy", "mesh volume.npy -o out.ply --json", "demo point --size 8"] {
        let mut call = command(&folder.path(""), verb);
        let mut child = call.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && !told.contains("panicked"), "{verb}: {told}");
    }
}
