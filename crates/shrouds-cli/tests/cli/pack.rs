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
    folder.refuse("unpack all.shroud -o x.ply", 2, &["all.shroud", "--label"]);
    folder.refuse("unpack all.shroud --label 3 -o x.ply", 1, &["no label 3", "0, 1, 2, 7"]);
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
