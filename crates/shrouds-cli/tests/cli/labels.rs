//! Labels by name, meshes of all labels, frames of a series, numbers per vertex.

use serde_json::Value;
use shrouds_io::read_mesh;

use crate::common::{Folder, npy};

const SIZE: usize = 12;

/// Two boxes, labels 1 and 2, and one voxel of label 7.
fn label(n: usize) -> u8 {
    let [i, j, k] = [n % SIZE, n / SIZE % SIZE, n / SIZE / SIZE];
    match () {
        () if (2..6).contains(&i) && (2..9).contains(&j) && (3..8).contains(&k) => 1,
        () if (7..11).contains(&i) && (1..6).contains(&j) && (3..10).contains(&k) => 2,
        () if [i, j, k] == [5, 10, 10] => 7,
        () => 0,
    }
}

fn values() -> Vec<u8> {
    (0..SIZE.pow(3)).map(label).collect()
}

/// A segmentation as 3D Slicer writes it, in the frame of a patient.
fn segmentation() -> Vec<u8> {
    let mut file = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 12 12 12\nencoding: raw\n\
        space: left-posterior-superior\nspace directions: (2,0,0) (0,-2,0) (0,0,3)\n\
        space origin: (10,20,30)\nkinds: domain domain domain\n\
        Segment0_Name:=Liver\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n\
        Segment1_Name:=Left kidney\nSegment1_LabelValue:=2\nSegment1_Layer:=0\n\
        Segment2_Name:=Ghost\nSegment2_LabelValue:=3\nSegment2_Layer:=0\n\n"
        .to_vec();
    file.extend(values());
    file
}

#[test]
fn a_mesh_for_each_label_in_a_folder() {
    let folder = Folder::new();
    folder.file("labels.npy", &npy("|u1", "(12, 12, 12)", &values()));
    let told = folder.succeed("mesh labels.npy --labels all -o organs --json");
    let told: Vec<Value> = serde_json::from_str(&told).unwrap();
    let labels: Vec<_> = told.iter().map(|one| one["label"].as_i64().unwrap()).collect();
    assert_eq!(labels, [1, 2, 7]);
    for (label, one) in labels.iter().zip(&told) {
        let name = format!("organs/label-{label}.ply");
        folder.succeed(&format!("mesh labels.npy --label {label} -o alone.ply"));
        let (alone, one_of_all) = (folder.mesh("alone.ply"), folder.mesh(&name));
        assert_eq!(alone.triangles, one_of_all.triangles, "{label}");
        for (a, b) in alone.vertices.iter().flatten().zip(one_of_all.vertices.iter().flatten()) {
            assert!((a - b).abs() < 1e-3, "{label}: {a} and {b}");
        }
        folder.succeed(&format!("check {name} --volume labels.npy --label {label}"));
        assert_eq!(one["input"]["dims"], serde_json::json!([12, 12, 12]));
        assert_eq!(one["checks"]["wrong_side"], 0);
    }
    folder
        .succeed("mesh labels.npy --labels all -o organs --format stl --border open --frame index");
    assert!(read_mesh(folder.path("organs/label-7.stl")).unwrap().triangles.len() == 8);
}

#[test]
fn a_mesh_for_each_label_in_one_file() {
    let folder = Folder::new();
    folder.file("plan.seg.nrrd", &segmentation());
    let done = folder.run("mesh plan.seg.nrrd --labels all -o all.obj --picture all.png");
    assert!(done.code == 0 && done.err.contains("3 labels"), "{}", done.err);
    let text = String::from_utf8(folder.bytes("all.obj")).unwrap();
    for name in ["Liver", "Left", "label"] {
        assert!(text.lines().any(|line| line.starts_with(&format!("o {name}"))), "{name}");
    }
    for name in ["all.ply", "all.glb", "all.vtp", "all.3mf"] {
        folder.succeed(&format!("mesh plan.seg.nrrd --labels all -o {name}"));
    }
    let (all, ply) = (folder.mesh("all.obj"), folder.mesh("all.ply"));
    assert_eq!(all.triangles.len(), ply.triangles.len());
    folder.refuse("mesh plan.seg.nrrd --labels all -o all.stl", 2, &["all.stl", "folder"]);
    let done = folder.run("mesh plan.seg.nrrd --labels all --label 1 -o all.ply");
    assert!(done.code == 2 && done.err.contains("--label"), "{}", done.err);
    folder.file("none.npy", &npy("|u1", "(2, 2, 2)", &[0; 8]));
    folder.refuse("mesh none.npy --labels all -o all.ply", 1, &["none.npy", "no label but 0"]);
}

#[test]
fn labels_go_by_their_names() {
    let folder = Folder::new();
    folder.file("plan.seg.nrrd", &segmentation());
    let vertices = |options: &str| {
        let told = folder.succeed(&format!("mesh plan.seg.nrrd -o out.ply --json {options}"));
        let told: Value = serde_json::from_str(&told).unwrap();
        (told["topology"]["vertices"].clone(), told["input"]["selection"].clone())
    };
    assert_eq!(vertices("--label liver").0, vertices("--label 1").0);
    assert_eq!(vertices("--label liver").1, "liver (1)");
    folder.refuse("mesh plan.seg.nrrd -o x.ply --label spleen", 1, &["spleen", "Liver"]);
    folder.refuse("mesh plan.seg.nrrd -o x.ply --label Ghost", 1, &["no voxel has label 3"]);

    let told: Value =
        serde_json::from_str(&folder.succeed("info plan.seg.nrrd --json --label liver")).unwrap();
    assert_eq!(told["orientation"], "LAS");
    assert_eq!(told["inside"], 140);
    let labels = told["labels"].as_array().unwrap();
    let kidney = serde_json::json!({"label": 2, "name": "Left kidney", "voxels": 140});
    assert!(labels.contains(&kidney), "{labels:?}");
    assert!(labels.contains(&serde_json::json!({"label": 3, "name": "Ghost", "voxels": 0})));
    let told = folder.succeed("info plan.seg.nrrd");
    assert!(told.contains("2 Left kidney (140)") && told.contains("LAS"), "{told}");
}

#[test]
fn a_frame_of_a_series_goes_by_its_number() {
    let folder = Folder::new();
    let mut file = b"NRRD0004\ntype: uint8\ndimension: 4\nsizes: 12 12 12 2\nencoding: raw\n\
        kinds: domain domain domain time\n\n"
        .to_vec();
    file.extend(values());
    file.extend(values().iter().map(|v| v & 2));
    folder.file("series.nrrd", &file);
    folder.refuse("mesh series.nrrd -o a.ply", 1, &["series.nrrd", "frames 0 to 1"]);
    folder.refuse("mesh series.nrrd -o a.ply --frame 2", 1, &["frames 0 to 1"]);
    let inside = |options: &str| {
        let told = folder.succeed(&format!("mesh series.nrrd -o a.ply --json {options}"));
        serde_json::from_str::<Value>(&told).unwrap()["input"]["inside"].clone()
    };
    assert_eq!((inside("--frame 0"), inside("--frame 1 --frame index")), (281.into(), 141.into()));
    let told: Value =
        serde_json::from_str(&folder.succeed("info series.nrrd --json --frame 1")).unwrap();
    assert_eq!((&told["frames"], &told["inside"]), (&2.into(), &141.into()));
    folder.succeed("check a.ply --volume series.nrrd --frame 1 --frame index");
    let done = folder.run("render series.nrrd -o a.png --frame index");
    assert!(done.code == 2 && done.err.contains("--frame takes a number"), "{}", done.err);
}

#[test]
fn raw_voxels_need_a_layout() {
    let folder = Folder::new();
    folder.file("a.raw", &values());
    folder.refuse("mesh a.raw -o a.ply", 1, &["a.raw"]);
    folder.succeed("mesh a.raw -o a.ply --raw-dims 12,12,12 --label 1");
    let done = folder.run("mesh a.raw -o a.ply --raw-type uint8");
    assert!(done.code == 2 && done.err.contains("--raw-dims"), "{}", done.err);
}

#[test]
fn numbers_per_vertex_go_with_the_mesh() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o a.ply --attributes delta,curvature");
    let text = String::from_utf8_lossy(&folder.bytes("a.ply")[..600]).into_owned();
    for name in ["delta", "mean_curvature", "gaussian_curvature"] {
        assert!(text.contains(&format!("property float {name}\n")), "{name}");
    }
    folder.refuse("mesh volume.npy -o a.stl --attributes delta", 2, &["a.stl", ".ply"]);
    let call = "mesh volume.npy -o a.ply --attributes delta --surface dual";
    folder.refuse(call, 2, &["--attributes", "primal"]);
}
