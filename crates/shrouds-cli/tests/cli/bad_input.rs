//! Files that cannot be used: a clear line, exit code 1, nothing written, nothing left.

use crate::common::{Folder, gzip, nifti, npy, volume};

const AFFINE: [[f32; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// Every verb that reads a volume refuses this file.
fn all_refuse(folder: &Folder, file: &str, parts: &[&str]) {
    folder.refuse(&format!("mesh {file} -o out.ply --picture p.png --report r.json"), 1, parts);
    folder.refuse(&format!("mesh {file} -o out.ply --json"), 1, parts);
    folder.refuse(&format!("render {file} -o out.png"), 1, parts);
    folder.refuse(&format!("compare {file} --picture out.png --json"), 1, parts);
}

#[test]
fn missing_file_or_folder() {
    let folder = Folder::new();
    all_refuse(&folder, "nowhere.npy", &["nowhere.npy", "cannot open it", "check the path"]);
    folder.refuse("info nowhere.nii.gz", 1, &["nowhere.nii.gz", "check the path"]);
    folder.refuse("info nowhere.ply", 1, &["nowhere.ply", "check the path"]);
    std::fs::create_dir(folder.path("slices.npy")).unwrap();
    all_refuse(&folder, "slices.npy", &["a folder"]);
}

#[test]
fn truncated_or_damaged_gzip() {
    let folder = Folder::new();
    let data: Vec<u8> = (0..4096u32).map(|n| (n * n % 251) as u8).collect();
    let whole = gzip(&nifti(&[16, 16, 16], AFFINE, &data));
    folder.file("cut.nii.gz", &whole[..whole.len() / 2]);
    all_refuse(&folder, "cut.nii.gz", &["cut.nii.gz", "truncated", "again"]);
    folder.file("plain.nii.gz", b"this is no gzip file, nor a volume");
    all_refuse(&folder, "plain.nii.gz", &["plain.nii.gz", "not gzip data"]);
    folder.file("short.npy", &npy("|u1", "(4, 4, 4)", &[1; 63]));
    all_refuse(&folder, "short.npy", &["expected 64 bytes", "found 63", "truncated"]);
}

#[test]
fn wrong_magic() {
    let folder = Folder::new();
    for name in ["text.npy", "text.nii", "text.nrrd"] {
        folder.file(name, &[b'x'; 400]);
        all_refuse(&folder, name, &[name, "check the extension"]);
    }
    for name in ["text.ply", "text.stl"] {
        folder.file(name, &[b'x'; 400]);
        folder.refuse(&format!("info {name}"), 1, &[name]);
        folder.refuse(&format!("render {name} -o out.png"), 1, &[name]);
    }
}

#[test]
fn absurd_dimensions() {
    let folder = Folder::new();
    folder.file("huge.npy", &npy("|u1", "(1000000, 1000000, 1000000)", &[1; 8]));
    all_refuse(&folder, "huge.npy", &["huge.npy", "truncated"]);
    folder.file("beyond.npy", &npy("|u1", "(9999999999, 1, 1)", &[1; 8]));
    all_refuse(&folder, "beyond.npy", &["beyond.npy", "each dimension must lie between"]);
    folder.file("none.npy", &npy("|u1", "(0, 4, 4)", &[]));
    all_refuse(&folder, "none.npy", &["none.npy", "each dimension must lie between 1"]);
    folder.file("negative.nii", &nifti(&[4, -4, 4], AFFINE, &[1; 64]));
    all_refuse(&folder, "negative.nii", &["negative.nii", "-4"]);
}

#[test]
fn values_that_are_not_numbers() {
    let folder = Folder::new();
    let mut values = [0f32; 27];
    [values[5], values[13]] = [f32::NAN; 2];
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    folder.file("holes.npy", &npy("<f4", "(3, 3, 3)", &bytes));
    all_refuse(&folder, "holes.npy", &["holes.npy", "[2, 1, 0]", "not a number", "1 more"]);
    let info: serde_json::Value =
        serde_json::from_str(&folder.succeed("info holes.npy --json")).unwrap();
    assert_eq!((&info["not_a_number"], info["inside"].is_null()), (&2.into(), true));
}

#[test]
fn more_than_three_dimensions() {
    let folder = Folder::new();
    folder.file("time.nii", &nifti(&[4, 4, 4, 5], AFFINE, &[1; 320]));
    all_refuse(&folder, "time.nii", &["time.nii", "frames 0 to 4", "--frame"]);
    folder.file("flat.npy", &npy("|u1", "(4, 4)", &[1; 16]));
    all_refuse(&folder, "flat.npy", &["flat.npy", "[4, 4]", "three dimensions"]);
}

#[test]
fn nothing_is_inside() {
    let folder = Folder::new();
    folder.volume("empty.npy", &volume([4; 3], |_| false));
    all_refuse(&folder, "empty.npy", &["empty.npy", "nothing is inside", "all values are 0"]);
    let mut values = [0u8; 64];
    values[21..24].copy_from_slice(&[2, 5, 9]);
    folder.file("labels.npy", &npy("|u1", "(4, 4, 4)", &values));
    let parts = ["labels.npy", "no voxel has label 3, 4;", "0, 2, 5, 9", "--label"];
    folder.refuse("mesh labels.npy -o out.ply --label 3 --label 4", 1, &parts);
    let parts = ["no value is above 9", "from 0 to 9", "--threshold"];
    folder.refuse("mesh labels.npy -o out.ply --threshold 9", 1, &parts);
}

#[test]
fn one_label_of_two_is_a_warning() {
    let folder = Folder::new();
    let mut values = [0u8; 64];
    values[21] = 2;
    folder.file("labels.npy", &npy("|u1", "(4, 4, 4)", &values));
    let done = folder.run("mesh labels.npy -o out.ply --label 2 --label 7");
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(done.err.contains("warning: labels.npy: no voxel has label 7;"), "{}", done.err);
    assert_eq!(folder.mesh("out.ply").triangles.len(), 8);
    let done = folder.run("mesh labels.npy -o out.ply --label 2 --label 7 --quiet");
    assert_eq!((done.code, done.err.as_str()), (0, ""));
}

#[test]
fn everything_is_inside() {
    let folder = Folder::new();
    folder.volume("full.npy", &volume([4, 3, 5], |_| true));
    let parts = ["no surface", "border is open", "--border closed"];
    folder.refuse("mesh full.npy -o out.ply --border open", 1, &parts);
    folder.refuse("render full.npy -o out.png --border open", 1, &parts);
    folder.succeed("mesh full.npy -o out.ply");
    let size = folder.mesh("out.ply").volume();
    assert!((3.0 * 2.0 * 4.0..5.0 * 4.0 * 6.0).contains(&size), "{size}");
    folder.volume("sheet.npy", &volume([4, 4, 1], |[i, j, _]| i * j > 0));
    folder.refuse("mesh sheet.npy -o new.ply --border open", 1, &["at least 2", "closed border"]);
}
