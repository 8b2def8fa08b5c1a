//! `shrouds pack` and `unpack`: volumes to a few kilobytes and back.

use serde_json::Value;
use shrouds::volume::phantom::named;

use crate::common::{Folder, nifti, npy};

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_volume_comes_back() {
    let folder = Folder::with_tori();
    for options in ["", " --profile fast", " --slab 5", " --slab 5 --independent --profile fast"] {
        let told = folder.succeed(&format!("pack volume.npy -o a.shroud --json{options}"));
        let told = json(&told);
        assert_eq!(told["bytes"], folder.bytes("a.shroud").len());
        assert_eq!(told["inside"], named("tori", 24).unwrap().volume.count());
        let bits = told["bits_per_triangle"].as_f64().unwrap();
        let expected = 8.0 * told["topology_bytes"].as_f64().unwrap()
            / (2.0 * told["vertices"].as_f64().unwrap());
        assert_eq!(bits, expected);
        folder.succeed("unpack a.shroud -o back.npy");
        assert_eq!(folder.bytes("back.npy"), folder.bytes("volume.npy"), "{options}");
    }
}

#[test]
fn the_mesh_is_that_of_the_volume() {
    let folder = Folder::new();
    let affine = [[-0.5, 0.0, 0.0, 10.0], [0.0, 0.5, 0.0, -20.0], [0.0, 0.0, 2.0, 5.0]];
    let volume = named("tori", 24).unwrap().volume;
    let data: Vec<u8> =
        (0..24 * 24 * 24).map(|n| u8::from(volume.get([n % 24, n / 24 % 24, n / 576]))).collect();
    folder.file("volume.nii", &nifti(&[24, 24, 24], affine, &data));
    for options in ["--faces join", "--border open"] {
        folder.succeed(&format!("pack volume.nii -o a.shroud {options}"));
        folder.succeed(&format!("mesh volume.nii -o expected.ply {options}"));
        folder.succeed("unpack a.shroud -o mesh.ply");
        assert_eq!(folder.bytes("mesh.ply"), folder.bytes("expected.ply"), "{options}");
    }
    let info = json(&folder.succeed("info a.shroud --json"));
    assert_eq!((&info["frame"], &info["border"]), (&"RAS".into(), &"open".into()));
    let words = folder.succeed("info a.shroud");
    assert!(words.contains("24 × 24 × 24") && words.contains("dense"), "{words}");
    folder.succeed("unpack a.shroud -o back.nii");
    let told = json(&folder.succeed("info back.nii --json"));
    assert_eq!((told["inside"].as_u64(), &told["affine"]), (Some(volume.count()), &info["affine"]));
}

#[test]
fn labels_are_packed_together() {
    let folder = Folder::new();
    let values: Vec<u8> =
        (0..4000).map(|n| [0, 1, 2, 7][n % 20 / 5 * (n / 20 % 10 / 3) % 4]).collect();
    folder.file("labels.npy", &npy("|u1", "(20, 10, 20)", &values));
    let told = json(&folder.succeed("pack labels.npy --labels all -o all.shroud --json"));
    assert_eq!((&told["labels"], &told["inside"]), (&4.into(), &Value::Null));
    folder.succeed("unpack all.shroud -o back.npy");
    assert!(folder.bytes("back.npy").ends_with(&values));
    folder.succeed("unpack all.shroud --label 7 -o seven.npy");
    let seven: Vec<u8> = values.iter().map(|&value| u8::from(value == 7)).collect();
    assert!(folder.bytes("seven.npy").ends_with(&seven));
    folder.succeed("unpack all.shroud --label 1 --label 7 -o two.ply");
    let info = json(&folder.succeed("info all.shroud --json"));
    assert_eq!(info["labels"], serde_json::json!([0, 1, 2, 7]));
    folder.refuse("unpack all.shroud -o x.vti", 2, &["x.vti", "labels are written", ".nrrd"]);
    folder.refuse("unpack all.shroud -o x.stl", 2, &["x.stl", "one mesh", "folder"]);
    folder.refuse("unpack all.shroud -o x.ply --bits 1", 2, &["--bits 1", "0 that the file has"]);
    folder.refuse("unpack all.shroud --label 3 -o x.ply", 1, &["no label 3", "0, 1, 2, 7"]);
}

#[test]
fn packed_labels_become_a_mesh_each() {
    let folder = Folder::new();
    let values: Vec<u8> =
        (0..4000).map(|n| [0, 1, 2, 7][n % 20 / 5 * (n / 20 % 10 / 3) % 4]).collect();
    folder.file("labels.npy", &npy("|u1", "(20, 10, 20)", &values));
    folder.succeed("pack labels.npy --labels all -o all.shroud");
    for (output, options) in [("organs", ""), ("stl", " --format stl"), ("organs.ply", "")] {
        let unpacked = folder.succeed(&format!("unpack all.shroud -o {output}{options} --json"));
        folder.succeed(&format!("mesh labels.npy --labels all -o other-{output}{options}"));
        let labels: Vec<Value> = json(&unpacked).as_array().unwrap().to_vec();
        assert_eq!(labels.iter().map(|one| &one["label"]).collect::<Vec<_>>(), [1, 2, 7]);
        for one in labels {
            let file = one["file"].as_str().unwrap();
            assert_eq!(folder.bytes(file), folder.bytes(&format!("other-{file}")), "{file}");
        }
    }
}

/// A grey-value ball, brighter inside.
fn grey_ball(folder: &Folder) {
    let squared = |x: usize, middle: f32| (x as f32 - middle).powi(2);
    let value = |n: usize| {
        let square = squared(n % 24, 11.3) + squared(n / 24 % 24, 11.8) + squared(n / 576, 11.6);
        (100.0 - square.sqrt()).to_le_bytes()
    };
    let values: Vec<u8> = (0..24 * 24 * 24).flat_map(value).collect();
    folder.file("grey.npy", &npy("<f4", "(24, 24, 24)", &values));
}

#[test]
fn the_places_of_vertices_come_back_the_nearer_the_more_bits() {
    let folder = Folder::with_tori();
    grey_ball(&folder);
    folder.succeed("mesh volume.npy -o ball.ply --energy variation");
    for call in [
        "pack volume.npy --energy variation --preset exact",
        "pack grey.npy --threshold 91.6 --places isosurface",
        "pack ball.ply --size 30",
        "pack ball.ply --size 30 --places shroud --border open --preset fast",
    ] {
        let mut last = f64::INFINITY;
        for bits in [1, 2, 4, 8] {
            let told = folder.succeed(&format!("{call} --bits {bits} -o a.shroud --json"));
            let planes = &json(&told)["planes"];
            assert_eq!(planes["bits"], bits);
            let edge = &planes["distances"]["edge"];
            // An interval's middle is at most this far off, and its end twice as far.
            let half = 0.5f64.powi(bits + 1);
            let (rms, max) = (edge["rms"].as_f64().unwrap(), edge["max"].as_f64().unwrap());
            assert!(rms < half && rms < last && max < 2.0 * half, "{call}: {planes}");
            last = rms;
            let mesh = json(&folder.succeed("unpack a.shroud -o mesh.ply --json"));
            assert_eq!((&mesh["bits"], &mesh["lost"]), (&bits.into(), &Value::Null));
            assert_eq!(mesh["checks"]["ok"], true);
            assert_eq!(mesh["settings"]["preset"], "exact");
        }
    }
}

#[test]
fn the_mesh_lies_where_the_report_says() {
    let folder = Folder::with_tori();
    let told = folder.succeed("pack volume.npy --preset exact --bits 4 -o a.shroud --json");
    let edge = json(&told)["planes"]["distances"]["edge"]["rms"].as_f64().unwrap();
    folder.succeed("mesh volume.npy --preset exact -o expected.ply");
    folder.succeed("unpack a.shroud -o mesh.ply");
    let (mesh, expected) = (folder.mesh("mesh.ply"), folder.mesh("expected.ply"));
    let squares: f64 = mesh
        .vertices
        .iter()
        .zip(&expected.vertices)
        .map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>())
        .sum();
    let found = (squares / mesh.vertices.len() as f64).sqrt();
    assert!((found - edge).abs() < 1e-6, "{found}, told {edge}");
    // The isosurface of a ball is a ball.
    grey_ball(&folder);
    folder.succeed("pack grey.npy --threshold 91.6 --places isosurface --bits 8 -o b.shroud");
    folder.succeed("unpack b.shroud -o ball.ply");
    for p in folder.mesh("ball.ply").vertices {
        let square = (p[0] - 11.3).powi(2) + (p[1] - 11.8).powi(2) + (p[2] - 11.6).powi(2);
        assert!((square.sqrt() - 8.4).abs() < 0.03, "{p:?}");
    }
}

#[test]
fn fewer_bits_are_read_where_they_are_asked_for_or_lost() {
    let folder = Folder::with_tori();
    folder.succeed("pack volume.npy --preset exact --bits 4 -o a.shroud");
    for bits in [0, 1, 3] {
        let told = json(&folder.succeed(&format!("unpack a.shroud --bits {bits} -o x.ply --json")));
        assert_eq!(told["bits"], bits);
    }
    folder.succeed("mesh volume.npy -o expected.ply");
    folder.succeed("unpack a.shroud --bits 0 -o mesh.ply");
    assert_eq!(folder.bytes("mesh.ply"), folder.bytes("expected.ply"));
    let bytes = folder.bytes("a.shroud");
    let mut damaged = bytes.clone();
    damaged[bytes.len() - 40] ^= 4;
    folder.file("damaged.shroud", &damaged);
    folder.file("cut.shroud", &bytes[..bytes.len() - 1]);
    for file in ["damaged.shroud", "cut.shroud"] {
        folder.refuse(&format!("unpack {file} -o y.ply"), 1, &[file, "bit plane 4", "--partial"]);
        let done = folder.run(&format!("unpack {file} -o z.ply --partial --json"));
        assert!(done.code == 0 && done.err.contains("only 3 of 4 bit planes"), "{}", done.err);
        assert_eq!(json(&done.out)["bits"], 3);
        // What is sound is enough.
        folder.succeed(&format!("unpack {file} --bits 3 -o sound.ply"));
        assert_eq!(folder.bytes("sound.ply"), folder.bytes("z.ply"));
        folder.succeed(&format!("unpack {file} -o back.npy"));
        assert_eq!(folder.bytes("back.npy"), folder.bytes("volume.npy"));
    }
    folder.refuse("unpack a.shroud --bits 8 -o y.ply", 2, &["--bits 8", "4 that the file has"]);
    folder.refuse("unpack a.shroud --bits 1 -o y.npy", 2, &["--bits", "meshes"]);
    folder.refuse("unpack a.shroud --volume keep -o y.ply", 2, &["--volume keep", "--bits 0"]);
}

#[test]
fn what_does_not_go_together_is_not_packed() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o ball.ply");
    for (options, parts) in [
        ("volume.npy --bits 3", ["--bits", "0, 1, 2, 4 or 8"]),
        ("volume.npy --labels all --bits 2", ["--bits", "--label"]),
        ("volume.npy --places shroud", ["--places", "--bits"]),
        ("volume.npy --preset exact", ["--preset", "unpack"]),
        ("volume.npy --bits 2 --surface dual", ["--surface", "unpack"]),
        ("volume.npy --bits 2 --places isosurface", ["isosurface", "--threshold"]),
        (
            "volume.npy --threshold 0 --bits 2 --places isosurface --energy linear",
            ["--energy", "shroud"],
        ),
        ("volume.npy --bits 2 --places mesh", ["--places mesh", ".ply"]),
        ("volume.npy --size 20", ["--size", "mesh"]),
        ("ball.ply --bits 2", ["lattice", "--size"]),
        ("ball.ply --size 20 --like volume.npy", ["--size", "one"]),
        ("ball.ply --size 20 --bits 2 --places isosurface", ["isosurface", "grey values"]),
        ("ball.ply --size 20 --bits 2 --border open", ["--border closed", "mesh"]),
        ("ball.ply --size 20 --threshold 1", ["--threshold", "not for a mesh"]),
        ("ball.ply --size 20 --labels all", ["--labels", "mesh"]),
    ] {
        let done = folder.run(&format!("pack {options} -o x.shroud"));
        assert_eq!(done.code, 2, "{options}: {}", done.err);
        parts.iter().for_each(|part| assert!(done.err.contains(part), "{options}: {}", done.err));
    }
    assert!(!folder.path("x.shroud").exists());
}

#[test]
fn damaged_files_and_wrong_calls() {
    let folder = Folder::with_tori();
    folder.succeed("pack volume.npy -o a.shroud --slab 6");
    let bytes = folder.bytes("a.shroud");
    folder.file("cut.shroud", &bytes[..bytes.len() - 1]);
    folder.refuse("unpack cut.shroud -o x.npy", 1, &["cut.shroud", "layers 18 to 23", "--partial"]);
    let done = folder.run("unpack cut.shroud -o x.npy --partial --json");
    assert!(done.code == 0 && done.err.contains("only the first 18 of 24 layers"), "{}", done.err);
    assert_eq!(json(&done.out)["dims"], serde_json::json!([24, 24, 18]));
    folder.file("no.shroud", b"what is this");
    folder.refuse("unpack no.shroud -o y.npy", 1, &["no.shroud", "no .shroud file"]);
    folder.refuse("info no.shroud", 1, &["no.shroud", "no .shroud file"]);
    folder.refuse("unpack missing.shroud -o y.npy", 1, &["missing.shroud"]);
    folder.refuse("pack volume.npy -o a.zip", 2, &["a.zip", ".shroud"]);
    folder.refuse("unpack a.shroud -o a.xyz", 2, &["a.xyz"]);
    folder.refuse("unpack a.shroud --label 1 -o y.npy", 2, &["--label"]);
    folder.refuse("unpack a.shroud --faces join -o y.ply", 2, &["--faces"]);
    folder.file("half.npy", &npy("<f4", "(1, 1, 1)", &0.5f32.to_le_bytes()));
    folder.refuse("pack half.npy --labels all -o y.shroud", 1, &["half.npy", "whole numbers"]);
}
