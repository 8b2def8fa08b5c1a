//! `shrouds combine`, `offset`, `crop`, `resample`, `clean`: volumes out of volumes.

use shrouds::volume::phantom::named;
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy, Select};
use shrouds_io::{VolumeOptions, read_occupancy};

use crate::common::{Folder, npy};

fn read(folder: &Folder, name: &str) -> Occupancy {
    let selected = read_occupancy(folder.path(name), &VolumeOptions::default(), &Select::NonZero);
    selected.unwrap().occupancy
}

fn ball(centre: [f64; 3], radius: f64) -> Occupancy {
    Occupancy::from_fn(Grid::new([24, 20, 18], [1.0; 3]).unwrap(), |index| {
        let squares = (0..3).map(|d| (index[d] as f64 - centre[d]).powi(2));
        squares.sum::<f64>() <= radius * radius
    })
}

fn wrong_call(folder: &Folder, call: &str, option: &str) {
    let done = folder.run(call);
    assert!(done.code == 2 && done.err.contains(option), "{call}: {}", done.err);
}

#[test]
fn boolean_operations_on_files() {
    let folder = Folder::new();
    let (a, b) = (ball([9.0; 3], 6.0), ball([13.0, 9.0, 9.0], 6.0));
    folder.volume("a.npy", &a);
    folder.volume("b.npy", &b);
    let expected = |f: fn(bool, bool) -> bool| {
        Occupancy::from_fn(a.grid().clone(), |index| f(a.get(index), b.get(index)))
    };
    for (operation, expected) in [
        ("union", expected(|a, b| a | b)),
        ("intersect", expected(|a, b| a & b)),
        ("subtract", expected(|a, b| a & !b)),
        ("xor", expected(|a, b| a ^ b)),
    ] {
        let told = folder.succeed(&format!("combine {operation} a.npy b.npy -o c.npy --json"));
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!(told["inside"], expected.count(), "{operation}");
        assert_eq!(read(&folder, "c.npy"), expected, "{operation}");
    }
    folder.volume("other.npy", &ball([9.0; 3], 3.0).crop([0..20, 0..20, 0..18]).unwrap());
    let parts = ["a.npy and other.npy", "resample"];
    folder.refuse("combine union a.npy other.npy -o d.npy", 1, &parts);
    folder.refuse("combine union a.npy b.npy -o d.ply", 2, &["d.ply", ".nrrd"]);
    folder.refuse("combine union a.npy b.npy -o a.npy", 2, &["a.npy", "another file"]);
    assert_eq!(folder.names(), ["a.npy", "b.npy", "c.npy", "other.npy"]);
}

#[test]
fn two_labels_of_one_file() {
    let folder = Folder::new();
    let values: Vec<u8> = (0..64).map(|n| [0, 1, 2, 3][n % 4]).collect();
    folder.file("labels.npy", &npy("|u1", "(4, 4, 4)", &values));
    let call = "combine union labels.npy labels.npy --label 1 --label-b 3 -o c.npy";
    folder.succeed(call);
    let both = read(&folder, "c.npy");
    assert!((0..4).all(|i| both.get([i, 2, 1]) == (i % 2 == 1)));
    let done = folder.run("combine intersect labels.npy labels.npy --label 1 --label-b 3 -o c.npy");
    assert!(done.code == 0 && done.err.contains("nothing is inside the result"), "{}", done.err);
}

#[test]
fn offsets_grow_the_lattice_unless_told_not_to() {
    let folder = Folder::new();
    let ball = ball([9.0; 3], 6.0);
    folder.volume("a.npy", &ball);
    folder.succeed("offset a.npy --by 5 -o grown.npy --keep-lattice");
    assert_eq!(read(&folder, "grown.npy"), ball.offset(5.0, Border::Closed).unwrap());
    let done = folder.run("offset a.npy --by 5 -o grown.npy");
    assert!(done.err.contains("the lattice grew"), "{}", done.err);
    let grown = read(&folder, "grown.npy");
    let bounds = grown.bounding_box().unwrap();
    assert!(bounds.iter().all(|range| range.len() == 23), "{bounds:?}");
    folder.succeed("offset a.npy --by -2 -o shrunk.npy");
    assert_eq!(read(&folder, "shrunk.npy"), ball.offset(-2.0, Border::Closed).unwrap());
    wrong_call(&folder, "offset a.npy --by nan -o x.npy", "--by");
    wrong_call(&folder, "offset a.npy -o x.npy", "--by");
}

#[test]
fn boxes_are_cut_in_place() {
    let folder = Folder::new();
    let ball = ball([9.0; 3], 6.0);
    folder.volume("a.npy", &ball);
    folder.succeed("crop a.npy -o around.nrrd");
    let around = read(&folder, "around.nrrd");
    assert_eq!((around.grid().dims(), around.count()), ([15; 3], ball.count()));
    assert_eq!(around.grid().point([0.0; 3]), [2.0; 3], "the first voxel stays in its place");
    folder.succeed("crop a.npy --box 0:10,4:9,9:18 -o box.npy");
    assert_eq!(read(&folder, "box.npy").count(), ball.crop([0..10, 4..9, 9..18]).unwrap().count());
    folder.refuse("crop a.npy --box 0:10,4:9,9:19 -o x.npy", 1, &["a.npy", "18"]);
    wrong_call(&folder, "crop a.npy --box 0:10,4:9 -o x.npy", "--box");
    folder.volume("none.npy", &Occupancy::empty(ball.grid().clone()));
    let done = folder.run("crop none.npy -o x.npy");
    assert!(done.code == 1 && done.err.contains("none.npy: nothing is inside: give --box"));
}

#[test]
fn lattices_are_changed() {
    let folder = Folder::new();
    let ball = ball([9.0; 3], 6.0);
    folder.volume("a.npy", &ball);
    folder.succeed("resample a.npy --to 0.5 -o fine.nrrd");
    let fine = read(&folder, "fine.nrrd");
    assert_eq!(fine.grid().spacing(), [0.5; 3]);
    let ratio = fine.count() as f64 / 8.0 / ball.count() as f64;
    // New points in the middle between the sides are inside.
    assert!((1.0..1.1).contains(&ratio), "{ratio}");
    folder.succeed("resample fine.nrrd --like a.npy -o back.npy");
    let back = read(&folder, "back.npy");
    assert_eq!(back.grid().dims(), ball.grid().dims());
    let differing = back.combine(shrouds::volume::Operation::Xor, &ball).unwrap().count();
    assert!(differing * 50 < ball.count(), "{differing} of {}", ball.count());
    wrong_call(&folder, "resample a.npy -o x.npy", "--to");
    wrong_call(&folder, "resample a.npy --to 0 -o x.npy", "--to");
}

#[test]
fn parts_are_removed_and_cavities_filled() {
    let folder = Folder::new();
    let shell = ball([9.0; 3], 7.0);
    let hollow = shell.combine(shrouds::volume::Operation::Subtract, &ball([9.0; 3], 3.0)).unwrap();
    let mut dirty = hollow.clone();
    dirty.set([22, 18, 1], true);
    dirty.set([22, 18, 2], true);
    folder.volume("dirty.npy", &dirty);
    let done = folder.run("clean dirty.npy --keep-largest --fill-cavities -o clean.npy");
    assert!(done.err.contains("1 component of 2 voxels removed"), "{}", done.err);
    assert!(done.err.contains("1 cavity of 123 voxels filled"), "{}", done.err);
    assert_eq!(read(&folder, "clean.npy"), shell);
    folder.succeed("clean dirty.npy --drop-below 2 --fill-cavities=122 -o clean.npy");
    assert_eq!(read(&folder, "clean.npy"), dirty, "nothing is small enough");
    folder.succeed("clean dirty.npy --drop-below 3 -o clean.npy");
    assert_eq!(read(&folder, "clean.npy"), hollow);
    wrong_call(&folder, "clean dirty.npy -o x.npy", "--keep-largest");
    let tori = named("tori", 24).unwrap().volume;
    folder.volume("tori.npy", &tori);
    folder.succeed("clean tori.npy --keep-largest=1 --faces join -o one.npy");
    assert_eq!(read(&folder, "one.npy"), tori.keep_largest(1, FaceRule::Join).volume);
}

#[test]
fn a_mesh_becomes_a_volume() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o tori.ply");
    let told = folder.succeed("voxelize tori.ply --like volume.npy -o again.npy --json");
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert_eq!((&told["method"], &told["closed"]), (&"exact".into(), &true.into()));
    assert_eq!(read(&folder, "again.npy"), read(&folder, "volume.npy"));
    folder.succeed("voxelize tori.ply --size 40 -o fine.nii.gz");
    let fine = read(&folder, "fine.nii.gz");
    assert_eq!(fine.grid().dims().iter().max(), Some(&40));
    let volume = fine.count() as f64 * fine.grid().voxel_volume();
    let expected = told["enclosed_volume"].as_f64().unwrap();
    assert!((volume / expected - 1.0).abs() < 0.02, "{volume} and {expected}");
    // A hole is told of, and closed.
    let mut mesh = folder.mesh("tori.ply");
    mesh.triangles.pop();
    shrouds_io::write_mesh(folder.path("open.ply"), &mesh, &Default::default()).unwrap();
    let done = folder.run("voxelize open.ply --like volume.npy -o again.npy");
    assert!(done.code == 0 && done.err.contains("3 edges with one triangle"), "{}", done.err);
    assert_eq!(read(&folder, "again.npy"), read(&folder, "volume.npy"));
    folder.refuse("voxelize tori.ply --size 2 -o x.npy", 2, &["size", "margin"]);
    wrong_call(&folder, "voxelize tori.ply -o x.npy", "--size");
}
