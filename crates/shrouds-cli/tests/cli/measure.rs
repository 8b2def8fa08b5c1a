//! `shrouds measure`: numbers against formulas and other verbs, columns, what is refused.

use std::f64::consts::PI;

use serde_json::Value;
use shrouds::TriMesh;
use shrouds_io::read_mesh;

use crate::common::{Folder, nifti, npy, volume};

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn near(found: &Value, expected: f64, relative: f64) {
    let found = found.as_f64().unwrap();
    assert!((found / expected - 1.0).abs() < relative, "{found} instead of {expected}");
}

/// A file with two halves of a ball of radius 10, labels 1 and 2, and a voxel of label 7 away from them.
fn halves(folder: &Folder) -> [u64; 2] {
    const SIZE: usize = 26;
    let label = |n: usize| {
        let [x, y, z] = [n % SIZE, n / SIZE % SIZE, n / SIZE / SIZE].map(|i| i as f64 - 12.6);
        match x * x + y * y + z * z <= 100.0 {
            true if x + 0.4 * y - 0.3 * z > 0.0 => 1,
            true => 2,
            false => 7 * u8::from(n == 2 + SIZE * (2 + SIZE * 2)),
        }
    };
    let values: Vec<u8> = (0..SIZE.pow(3)).map(label).collect();
    folder.file("halves.npy", &npy("|u1", "(26, 26, 26)", &values));
    [1, 2].map(|label| values.iter().filter(|v| **v == label).count() as u64)
}

#[test]
fn an_ellipsoid_has_its_numbers() {
    let folder = Folder::new();
    // Half axes 9, 6, 6 along x, y, z in the world, where the lattice is turned and spaced 1, 2, 1.5.
    let affine = [[0.0, 0.0, -1.5, 60.0], [1.0, 0.0, 0.0, -20.0], [0.0, 2.0, 0.0, 5.0]];
    let dims = [16, 10, 16];
    let mut data = vec![0; 16 * 10 * 16];
    for (n, value) in data.iter_mut().enumerate() {
        let [i, j, k] = [n % 16, n / 16 % 10, n / 160].map(|i| i as f64);
        let [x, y, z] = [(11.5 - 1.5 * k), i - 7.5, 2.0 * j - 9.2];
        *value = u8::from((x / 9.0).powi(2) + (y * y + z * z) / 36.0 <= 1.0);
    }
    folder.file("body.nii", &nifti(&dims, affine, &data));
    let told = json(&folder.succeed("measure body.nii --json"));
    assert_eq!(told["handedness"], "right");
    assert_eq!((&told["unit"], &told["units"]["area"]), (&"mm".into(), &"mm²".into()));
    assert_eq!(told["units"]["gaussian_curvature_median"], "1/mm²");
    let row = &told["rows"][0];
    let volume = 4.0 / 3.0 * PI * 9.0 * 36.0;
    near(&row["volume"], volume, 0.03);
    assert_eq!(row["voxels"], data.iter().filter(|v| **v == 1).count());
    near(&row["voxel_volume"], 3.0 * row["voxels"].as_f64().unwrap(), 1e-12);
    let [low, high] = ["volume_low", "volume_high"].map(|key| row[key].as_f64().unwrap());
    assert!(low < volume && volume < high, "{low} {high}");
    // A prolate spheroid.
    let eccentricity: f64 = (1.0f64 - 36.0 / 81.0).sqrt();
    let area = 2.0 * PI * 36.0 * (1.0 + 9.0 / 6.0 / eccentricity * eccentricity.asin());
    near(&row["area"], area, 0.02);
    near(&row["axis_lengths"][0], 18.0, 0.03);
    near(&row["axis_lengths"][2], 12.0, 0.03);
    assert!(row["axis_1"][0].as_f64().unwrap() > 0.99, "along x, towards +x");
    for (k, middle) in [48.5, -12.5, 14.2].into_iter().enumerate() {
        near(&row["centroid"][k], middle, 0.02);
    }
    let mean = row["convex_area"].as_f64().unwrap() / row["area"].as_f64().unwrap();
    assert!(mean > 0.99, "{mean}");
    assert!(row["thickness_maximum"].as_f64().unwrap() < 18.5);
    assert_eq!((&row["euler"], &row["genus"], &row["cavities"]), (&2.into(), &0.into(), &0.into()));
}

#[test]
fn mesh_and_volume_tell_the_same() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o mesh.ply --preset exact --quiet");
    folder.succeed("mesh volume.npy -o mesh.stl --preset exact --quiet");
    folder.succeed("mesh volume.npy -o dual.ply --preset exact --surface dual --quiet");
    let of =
        |call: &str| json(&folder.succeed(&format!("measure {call} --json")))["rows"][0].clone();
    let (volume, mesh, stl) = (of("volume.npy"), of("mesh.ply"), of("mesh.stl"));
    for key in ["area", "volume", "triangle_area", "triangle_volume", "thickness_median"] {
        near(&mesh[key], volume[key].as_f64().unwrap(), 0.005);
        near(&stl[key], mesh[key].as_f64().unwrap(), 0.01);
    }
    for key in ["surfaces", "euler", "genus", "cavities"] {
        assert_eq!(mesh[key], volume[key], "{key}");
        assert_eq!(stl[key], volume[key], "{key}");
    }
    assert_eq!(
        (&mesh["surfaces"], &mesh["euler"], &mesh["genus"]),
        (&2.into(), &0.into(), &2.into())
    );
    let file = folder.mesh("mesh.ply");
    near(&mesh["triangle_area"], file.area(), 1e-12);
    near(&mesh["triangle_volume"], file.volume(), 1e-9);
    near(&of("volume.npy --surface dual")["area"], of("dual.ply")["area"].as_f64().unwrap(), 0.005);
    let signs = ["gaussian_positive_area", "gaussian_negative_area", "gaussian_near_zero_area"];
    let sum: f64 = signs.iter().map(|key| volume[key].as_f64().unwrap()).sum();
    near(&volume["area"], sum, 1e-9);
    // The outer half of a ring is a cap along each circle, the inner half a saddle.
    assert!(signs[..2].iter().all(|key| volume[key].as_f64().unwrap() > 0.2 * sum), "{volume}");
    assert_eq!(mesh["voxels"], Value::Null);
}

#[test]
fn parts_and_cavities_are_rows() {
    let folder = Folder::new();
    // A shell, and a block beside it.
    let body = volume([30, 16, 16], |[i, j, k]| {
        let square: f64 = [i, j, k].map(|n| (n as f64 - 7.5).powi(2)).iter().sum();
        (12.0..45.0).contains(&square) || (20..24).contains(&i) && (3..9).contains(&j) && k == 4
    });
    folder.volume("parts.npy", &body);
    folder.succeed("mesh parts.npy -o parts.ply --preset exact --quiet");
    let whole = json(&folder.succeed("measure parts.npy --json"))["rows"][0].clone();
    assert_eq!(
        (&whole["surfaces"], &whole["cavities"], &whole["euler"]),
        (&3.into(), &1.into(), &6.into())
    );
    let rows = json(&folder.succeed("measure parts.npy --components --json"))["rows"].clone();
    assert_eq!(rows.as_array().unwrap().len(), 2);
    assert_eq!((&rows[1]["component"], &rows[1]["voxels"]), (&2.into(), &24.into()));
    assert_eq!((&rows[0]["cavities"], &rows[1]["cavities"]), (&1.into(), &0.into()));
    let sum: f64 = [0, 1].iter().map(|n| rows[n]["area"].as_f64().unwrap()).sum();
    // Each one settles for itself.
    near(&whole["area"], sum, 3e-3);
    // Of a mesh the shell and its cavity are surfaces of their own.
    let rows = json(&folder.succeed("measure parts.ply --components --json"))["rows"].clone();
    assert_eq!(rows.as_array().unwrap().len(), 3);
    let negative = |n: usize| rows[n]["volume"].as_f64().unwrap() < 0.0;
    assert_eq!((0..3).filter(|n| negative(*n)).count(), 1);
    let table = folder.succeed("measure parts.npy --components");
    assert!(table.contains("part 2") && table.contains("voxel³"), "{table}");
}

#[test]
fn labels_touch_each_other_and_the_outside() {
    let folder = Folder::new();
    let counts = halves(&folder);
    let told =
        json(&folder.succeed("measure halves.npy --labels all --contacts --csv out.csv --json"));
    let rows = told["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 3);
    for (row, count) in rows.iter().zip(counts) {
        assert_eq!(row["voxels"], count);
        near(&row["contact_outside"], 2.0 * PI * 100.0, 0.02);
    }
    let contacts = told["contacts"].as_array().unwrap();
    assert_eq!(contacts.len(), 1);
    assert_eq!((&contacts[0]["label"], &contacts[0]["other"]), (&1.into(), &2.into()));
    near(&contacts[0]["area"], PI * 100.0, 0.02);

    let csv = String::from_utf8(folder.bytes("out.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert!(lines.len() == 4 && lines.iter().all(|line| line.len() == lines[0].len()));
    let column = lines[0].iter().position(|name| *name == "area [voxel²]").unwrap();
    near(&rows[1]["area"], lines[2][column].parse().unwrap(), 1e-12);
    assert!(lines[0].contains(&"centroid_z [voxel]"));
    let csv = String::from_utf8(folder.bytes("out-contacts.csv")).unwrap();
    assert!(csv.starts_with("label,name,other_label,other_name,area [voxel²]\r\n1,,2,,"), "{csv}");

    // Alone, a label has the same numbers.
    let alone = json(&folder.succeed("measure halves.npy --label 2 --json"))["rows"][0].clone();
    near(&alone["area"], rows[1]["area"].as_f64().unwrap(), 1e-3);
    let table = folder.succeed("measure halves.npy --labels all --contacts");
    assert!(table.contains("contact of") && table.contains("1 contact"), "{table}");
}

#[test]
fn distances_go_both_ways() {
    let folder = Folder::new();
    let ball = |radius: f64| {
        volume([30; 3], move |point| {
            point.map(|i| (i as f64 - 14.7).powi(2)).iter().sum::<f64>() <= radius * radius
        })
    };
    folder.volume("large.npy", &ball(12.0));
    folder.volume("small.npy", &ball(10.0));
    folder.succeed("mesh small.npy -o small.ply --preset exact --quiet");
    for other in ["small.npy", "small.ply"] {
        let call = format!("measure large.npy --distance-to {other} --json");
        let row = json(&folder.succeed(&call))["rows"][0].clone();
        for key in ["distance_mean", "distance_rms", "distance_95", "distance_maximum"] {
            near(&row[key], 2.0, 0.1);
        }
        near(&row["distance_forth_mean"], 2.0, 0.01);
        near(&row["distance_back_mean"], 2.0, 0.01);
    }
    let row = json(&folder.succeed("measure small.ply --distance-to small.ply --json"))["rows"][0]
        .clone();
    assert!(row["distance_maximum"].as_f64().unwrap() < 1e-9);
    // Labels go to the same labels.
    halves(&folder);
    let told =
        json(&folder.succeed("measure halves.npy --labels all --distance-to halves.npy --json"));
    assert!((0..3).all(|n| told["rows"][n]["distance_maximum"].as_f64().unwrap() < 1e-9));
}

#[test]
fn an_open_mesh_has_an_area_and_no_volume() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o mesh.obj --quiet");
    let text = String::from_utf8(folder.bytes("mesh.obj")).unwrap();
    let kept: Vec<&str> = text.lines().collect();
    folder.file("open.obj", kept[..kept.len() - 5].join("\n").as_bytes());
    let told = folder.succeed("measure open.obj");
    assert!(told.contains("not closed") && told.contains("lengths in unit"), "{told}");
    let row = json(&folder.succeed("measure open.obj --json"))["rows"][0].clone();
    let open: TriMesh = read_mesh(folder.path("open.obj")).unwrap();
    near(&row["triangle_area"], open.area(), 1e-12);
    for key in ["volume", "centroid", "sphericity", "genus", "surface_to_volume", "axis_lengths"] {
        assert_eq!(row[key], Value::Null, "{key}");
    }
}

#[test]
fn what_has_no_meaning_is_refused() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o mesh.ply --quiet");
    folder.refuse("measure mesh.ply --labels all", 2, &["mesh.ply", "mesh"]);
    folder.refuse("measure mesh.ply --label 3", 2, &["mesh.ply"]);
    folder.refuse("measure volume.npy --frame index", 2, &["--frame"]);
    folder.refuse("measure volume.npy --csv volume.npy", 2, &["volume.npy"]);
    folder.refuse("measure volume.npy --csv no/such.csv", 1, &["such.csv"]);
    folder.refuse("measure notes.txt", 2, &["notes.txt"]);
    folder.refuse("measure volume.npy --distance-to notes.txt", 2, &["notes.txt"]);
    folder.refuse("measure volume.npy --distance-to none.ply", 1, &["none.ply"]);
    for (call, part) in [
        ("measure volume.npy --contacts", "--labels"),
        ("measure volume.npy --components --distance-to mesh.ply", "--distance-to"),
        ("measure volume.npy --labels all --label 1", "--label"),
    ] {
        let done = folder.run(call);
        assert!(done.code == 2 && done.err.contains(part), "{call}: {}", done.err);
    }
    folder.file("none.npy", &npy("|u1", "(2, 2, 2)", &[0; 8]));
    folder.refuse("measure none.npy --labels all", 1, &["none.npy", "no label but 0"]);
    folder.refuse("measure none.npy", 1, &["none.npy", "nothing is inside"]);
    folder.file("floats.npy", &npy("<f4", "(1, 1, 2)", &[0, 0, 0, 63, 0, 0, 0, 0]));
    folder.refuse("measure floats.npy --labels all", 1, &["floats.npy", "no labels"]);
    folder.file("empty.obj", b"v 0 0 0\nv 1 0 0\n");
    folder.refuse("measure empty.obj", 1, &["empty.obj"]);
}
