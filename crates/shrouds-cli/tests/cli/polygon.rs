//! `shrouds polygon`: pictures, lines and JSON of slices.

use serde_json::Value;

use crate::common::{Folder, nifti, volume};

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn a_slice_becomes_a_picture_lines_or_json() {
    let folder = Folder::with_tori();
    let told = folder.run("polygon volume.npy --slice z=12 -o a.svg");
    assert_eq!((told.code, told.out.as_str()), (0, ""));
    for part in ["slice z=12 of 24 × 24", "3 polygons, 1 hole", "converged after", "by voxel count"]
    {
        assert!(told.err.contains(part), "no '{part}' in {}", told.err);
    }
    let svg = String::from_utf8(folder.bytes("a.svg")).unwrap();
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && svg.matches('Z').count() >= 8);

    let out = folder.succeed("polygon volume.npy --slice z=12 -o a.json --json");
    let report: Value = serde_json::from_str(&out).unwrap();
    let json = folder.json("a.json");
    assert_eq!((&report["slice"], &report["geometry"]), (&"z=12".into(), &json["geometry"]));
    assert!(report.get("polygons").is_none());
    assert_eq!(json["solver"]["status"], "converged");
    assert_eq!(json["settings"]["preset"], "exact");
    let polygons = json["polygons"].as_array().unwrap();
    let area: f64 = polygons.iter().map(|polygon| polygon["area"].as_f64().unwrap()).sum();
    let [total, counted] =
        ["area", "pixel_area"].map(|key| json["geometry"][key].as_f64().unwrap());
    assert!((area - total).abs() < 1e-9 && (area / counted - 1.0).abs() < 0.1, "{area}, {counted}");
    let points: usize = polygons.iter().map(|p| p["points"].as_array().unwrap().len()).sum();
    assert_eq!(json["geometry"]["vertices"], points);
    for polygon in polygons {
        assert_eq!(polygon["closed"], true);
        assert!(numbers(&polygon["delta"]).iter().all(|delta| (0.001..0.999).contains(delta)));
        assert!(polygon["points"].as_array().unwrap().iter().all(|p| numbers(p)[2] == 12.0));
    }

    folder.succeed("polygon volume.npy --slice z=12 -o a.obj --quiet --threads 1");
    let text = String::from_utf8(folder.bytes("a.obj")).unwrap();
    let count = |kind: &str| text.lines().filter(|line| line.starts_with(kind)).count();
    assert_eq!((count("v "), count("l ")), (points, polygons.len()));
}

#[test]
fn points_lie_in_the_world_or_in_indices() {
    let folder = Folder::new();
    let affine = [[0.0, 0.0, -2.0, 90.0], [1.5, 0.0, 0.0, -126.0], [0.0, 3.0, 0.0, -72.0]];
    // One voxel, at (2, 1, 1) of 4 × 3 × 2.
    let mut data = [0; 24];
    data[2 + 4 * (1 + 3)] = 1;
    folder.file("one.nii", &nifti(&[4, 3, 2], affine, &data));
    for (slice, axis) in [("x=2", 0), ("y=1", 1), ("z=1", 2)] {
        let centre = |options: &str| -> [f64; 3] {
            folder.succeed(&format!("polygon one.nii --slice {slice} -o a.json --quiet {options}"));
            let json = folder.json("a.json");
            let points: Vec<_> =
                json["polygons"][0]["points"].as_array().unwrap().iter().map(numbers).collect();
            assert_eq!(points.len(), 4);
            [0, 1, 2].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / 4.0)
        };
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.02);
        // Four vertices around a voxel, alike on both sides of it.
        assert!(close(centre("--frame index"), [2.0, 1.0, 1.0]), "{axis}");
        assert!(close(centre(""), [88.0, -123.0, -69.0]), "{axis}");
    }
}

#[test]
fn the_only_slice_needs_no_name() {
    let folder = Folder::new();
    folder.volume("image.npy", &volume([9, 7, 1], |[i, j, _]| i > 2 && j != 3));
    folder.volume("side.npy", &volume([1, 9, 7], |[_, i, j]| i > 2 && j != 3));
    let area = |name: &str| {
        let out = folder.succeed(&format!("polygon {name} -o a.json --json --solver sweeps"));
        serde_json::from_str::<Value>(&out).unwrap()["geometry"]["area"].as_f64().unwrap()
    };
    assert!(area("image.npy") > 20.0);
    assert_eq!(area("image.npy"), area("side.npy"));
    // An open border leaves lines open, and no area.
    let out = folder.succeed("polygon image.npy -o a.svg --json --border open --energy linear");
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(
        (&report["geometry"]["open"], &report["geometry"]["area"]),
        (&2.into(), &Value::Null)
    );
}

#[test]
fn calls_that_cannot_be_done_are_refused() {
    let folder = Folder::with_tori();
    folder.volume("full.npy", &volume([4, 4, 1], |_| true));
    for (words, code, parts) in [
        ("polygon volume.npy -o a.svg", 2, ["24 × 24 × 24", "--slice z=12"]),
        ("polygon volume.npy -o a.svg --slice z=24", 2, ["no slice z=24", "z=23"]),
        ("polygon volume.npy -o a.svg --slice z=0", 1, ["nothing is inside", "between z="]),
        ("polygon volume.npy -o a.png --slice z=12", 2, [".svg", ".json"]),
        (
            "polygon volume.npy -o a.svg --slice z=12 --surface dual",
            2,
            ["--surface dual", "no mesh"],
        ),
        (
            "polygon volume.npy -o a.svg --slice z=12 --triangles fixed",
            2,
            ["--triangles", "no mesh"],
        ),
        ("polygon full.npy -o a.svg --border open", 1, ["no polygon", "--border closed"]),
        ("polygon volume.npy -o no/a.svg --slice z=12", 1, ["no/a.svg", "folder"]),
    ] {
        folder.refuse(words, code, &parts);
    }
    assert_eq!(folder.run("polygon volume.npy -o a.svg --slice 12").code, 2);
    let done = folder.run("polygon volume.npy -o a.svg --slice z=12 --strict --max-iterations 0");
    assert_eq!(done.code, 3, "{}", done.err);
}
