//! `shrouds check`: clean for what `mesh` writes, FAIL for what is damaged.

use serde_json::Value;
use shrouds::volume::phantom::{linked_tori, noise};
use shrouds::{Grid, Occupancy};
use shrouds_io::{MeshOptions, write_mesh};

use crate::common::{Folder, nifti};

/// Two thirds outside at random: most faces ambiguous, and parts at the border.
fn rough() -> Occupancy {
    noise(&Grid::new([9, 8, 7], [1.0; 3]).unwrap(), 0.35, 4).unwrap()
}

#[test]
fn every_kind_of_mesh_is_certified() {
    let folder = Folder::new();
    folder.volume("tori.npy", &linked_tori(20).unwrap());
    folder.volume("rough.npy", &rough());
    for volume in ["tori.npy", "rough.npy"] {
        for faces in ["separate", "join"] {
            for mesh in ["", "--triangles fixed", "--surface dual", "--border open"] {
                folder.succeed(&format!("mesh {volume} -o out.ply --quiet --faces {faces} {mesh}"));
                let border = if mesh.contains("open") { "open" } else { "closed" };
                let options = format!("--volume {volume} --faces {faces} --border {border}");
                let told = folder.succeed(&format!("check out.ply {options}"));
                assert!(!told.contains("FAIL"), "{options}: {told}");
                assert!(told.contains("note  fairness "), "{options}: {told}");
                assert!(told.contains("0 of") && told.contains("intersect"), "{told}");
                folder.succeed(&format!("check out.ply {options} --all-axes --quiet"));
            }
        }
    }
    folder.succeed("mesh tori.npy -o out.ply --quiet");
    folder.succeed("check out.ply --volume tori.npy");
}

#[test]
fn a_mirrored_frame_and_its_index() {
    let folder = Folder::new();
    let affine = [[-1.5, 0.0, 0.2, 90.0], [0.0, 0.75, 0.0, -126.0], [0.1, 0.0, 2.0, -72.0]];
    let bits = rough();
    let data: Vec<u8> = (0..504).map(|n| bits.get([n % 9, n / 9 % 8, n / 72]).into()).collect();
    folder.file("rough.nii", &nifti(&[9, 8, 7], affine, &data));
    for frame in ["world", "index"] {
        folder.succeed(&format!("mesh rough.nii -o {frame}.ply --quiet --frame {frame}"));
        folder.succeed(&format!("check {frame}.ply --volume rough.nii --frame {frame}"));
    }
    let done = folder.run("check index.ply --volume rough.nii");
    assert!(done.code == 1 && done.err.contains("--frame"), "{}", done.err);
}

#[test]
fn damage_is_found() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o good.ply --quiet");
    let good = folder.mesh("good.ply");
    let damage = |name: &str, change: &dyn Fn(&mut shrouds::TriMesh), part: &str| {
        let mut mesh = good.clone();
        change(&mut mesh);
        write_mesh(folder.path(name), &mesh, &MeshOptions::default()).unwrap();
        let done = folder.run(&format!("check {name} --volume volume.npy"));
        assert_eq!(done.code, 1, "{name}");
        let fails: Vec<&str> = done.out.lines().filter(|line| line.starts_with("FAIL")).collect();
        assert!(fails.iter().any(|line| line.contains(part)), "{name}: {}", done.out);
        assert!(done.err.starts_with(&format!("error: {name} ")), "{}", done.err);
        let json: Value = serde_json::from_str(
            &folder.run(&format!("check {name} --volume volume.npy --json")).out,
        )
        .unwrap();
        assert_eq!(json["checks"]["ok"], false);
        assert!(!json["checks"]["problems"].as_array().unwrap().is_empty());
    };
    damage(
        "torn.ply",
        &|mesh| mesh.triangles.truncate(good.triangles.len() - 1),
        "edges with one triangle",
    );
    let turn = |mesh: &mut shrouds::TriMesh| mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    damage("inverted.ply", &turn, "normals point outside");
    damage("turned.ply", &|mesh| mesh.triangles[0].swap(0, 1), "face opposite sides");
    let shift = |mesh: &mut shrouds::TriMesh| mesh.vertices.iter_mut().for_each(|v| v[0] += 1.0);
    damage("shifted.ply", &shift, "on the wrong side");
    damage("doubled.ply", &|mesh| mesh.triangles.push(mesh.triangles[0]), "more than two");
    damage("none.ply", &|mesh| mesh.triangles.clear(), "number of components 0");
}

#[test]
fn the_certificate_as_json() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o out.obj --quiet");
    let text = folder.succeed("check out.obj --volume volume.npy --json");
    let json: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["checks"]["ok"], true);
    assert_eq!(json["checks"]["self_intersections"], 0);
    assert_eq!(json["checks"]["components"], serde_json::json!({"found": 2, "expected": 2}));
    assert_eq!(json["euler"], serde_json::json!([0, 0]));
    assert!(json["fairness"]["bending"].as_f64().unwrap() > 0.0);
    assert_eq!(json["triangles"], folder.mesh("out.obj").triangles.len());
    assert_eq!(folder.succeed("check out.obj --volume volume.npy --quiet"), "");
}

#[test]
fn another_selection_is_another_volume() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o out.ply --quiet");
    folder.succeed("check out.ply --volume volume.npy --label 1");
    let done = folder.run("check out.ply --volume volume.npy --label 2");
    assert!(done.code == 1 && done.err.contains("799 lattice points"), "{}", done.err);
}
