//! `shrouds network` and `shrouds contours`: lines, their numbers, what is refused.

use serde_json::Value;

use crate::common::{Folder, nifti};

fn report(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn sum(list: &Value, key: &str) -> f64 {
    list.as_array().unwrap().iter().map(|entry| entry[key].as_f64().unwrap()).sum()
}

#[test]
fn every_vertex_lies_on_two_curves_of_the_network() {
    let folder = Folder::with_tori();
    let out = folder.succeed("network volume.npy -o network.obj --json");
    let report = report(&out);
    folder.succeed("mesh volume.npy -o mesh.ply --quiet");
    let vertices = folder.mesh("mesh.ply").vertices.len();
    assert_eq!(sum(&report["families"], "vertices"), 2.0 * vertices as f64);
    assert_eq!(sum(&report["families"], "open"), 0.0);
    let text = String::from_utf8(folder.bytes("network.obj")).unwrap();
    let lines = text.lines().filter(|line| line.starts_with("l ")).count();
    assert_eq!(lines as f64, sum(&report["families"], "curves"));
    let told = folder.run("network volume.npy -o network.vtp");
    assert_eq!((told.code, told.out.as_str()), (0, ""));
    assert!(told.err.contains("curves across k"), "{}", told.err);
    assert!(folder.bytes("network.vtp").starts_with(b"<?xml"));
}

#[test]
fn contours_of_a_mesh_add_up_to_its_volume() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o mesh.ply --quiet");
    let volume = folder.mesh("mesh.ply").volume();
    for axis in ["x", "y", "z"] {
        let out = folder
            .succeed(&format!("contours mesh.ply --axis {axis} --every 0.25 -o c.vtp --json"));
        let report = report(&out);
        assert_eq!(report["totals"]["open"], 0);
        let found = report["totals"]["volume"].as_f64().unwrap();
        assert!((found / volume - 1.0).abs() < 0.01, "{axis}: {found} against {volume}");
        let length = sum(&report["contours"], "length");
        assert!((report["totals"]["length"].as_f64().unwrap() / length - 1.0).abs() < 1e-12);
        assert!(report["fairness"]["bending"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn planes_across_lattice_axes_lie_at_voxel_indices() {
    let folder = Folder::new();
    let affine = [[0.0, 0.0, -2.0, 90.0], [1.5, 0.0, 0.0, -126.0], [0.0, 3.0, 0.0, -72.0]];
    // One voxel, at (2, 1, 1) of 4 × 3 × 2, so at (88, -123, -69).
    let mut data = [0; 24];
    data[2 + 4 * (1 + 3)] = 1;
    folder.file("one.nii", &nifti(&[4, 3, 2], affine, &data));
    for (axis, at, count) in
        [("i", "2", 1), ("j", "1", 1), ("k", "1", 1), ("k", "0", 0), ("x", "88", 1), ("y", "88", 0)]
    {
        let out =
            folder.succeed(&format!("contours one.nii --axis {axis} --at {at} -o c.obj --json"));
        let report = report(&out);
        assert_eq!(report["contours"].as_array().unwrap().len(), count, "{axis} = {at}");
        assert_eq!(report["unit"], "mm");
    }
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o mesh.ply --quiet");
    for missing in ["", "--every 0"] {
        let told = folder.run(&format!("contours mesh.ply --axis z {missing} -o c.vtp"));
        assert!(told.code == 2 && told.err.contains("--every"), "{}", told.err);
    }
    folder.refuse("contours mesh.ply --axis k --every 1 -o c.vtp", 2, &["volume"]);
    folder.refuse("contours mesh.ply --axis z --every 1e-9 -o c.vtp", 2, &["planes"]);
    folder.refuse("contours mesh.ply --axis z --every 1 -o c.ply", 2, &[".vtp"]);
    folder.refuse("network mesh.ply -o n.vtp", 2, &["mesh.ply"]);
    folder.refuse("network volume.npy -o n.vtp --surface dual", 2, &["primal"]);
    assert_eq!(folder.names(), ["mesh.ply", "volume.npy"]);
}
