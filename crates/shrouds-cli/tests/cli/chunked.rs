//! `shrouds mesh --chunk`: the same surface as whole, continued where it was broken off, never half a file.

use std::fs;

use serde_json::json;
use shrouds::TriMesh;
use shrouds::volume::phantom;

use crate::common::{Folder, command};

/// A gyroid of more vertices than one tile has, in a box of no multiple of a chunk.
fn gyroid() -> Folder {
    let folder = Folder::new();
    let gyroid = phantom::gyroid(150).unwrap().crop([0..150, 3..150, 0..140]).unwrap();
    folder.volume("volume.npy", &gyroid);
    folder
}

/// The corners of all triangles, the first one first, sorted.
fn triangles(mesh: &TriMesh) -> Vec<[[u64; 3]; 3]> {
    let corners = |t: &[u32; 3]| {
        let mut corners = mesh.corners(*t).map(|corner| corner.map(f64::to_bits));
        let least = (0..3).min_by_key(|&n| corners[n]).unwrap();
        corners.rotate_left(least);
        corners
    };
    let mut all: Vec<_> = mesh.triangles.iter().map(corners).collect();
    all.sort_unstable();
    all
}

#[test]
fn chunks_write_the_surface_of_the_whole() {
    let folder = gyroid();
    assert_eq!(folder.run("mesh volume.npy -o whole.ply").code, 0);
    let done = folder.run("mesh volume.npy --chunk 128 -o joined.ply --report joined.json");
    assert_eq!((done.code, done.out.as_str()), (0, ""), "{}", done.err);
    assert!(done.err.contains("triangles from 8 chunks"), "{}", done.err);
    let (whole, joined) = (folder.mesh("whole.ply"), folder.mesh("joined.ply"));
    assert!(whole.vertices.len() > 75_000);
    let expected = triangles(&whole);
    assert!(triangles(&joined) == expected, "the triangles differ");
    let report = folder.json("joined.json");
    assert_eq!(report["vertices"], whole.vertices.len());
    assert_eq!(report["chunks"], 8);
    assert_eq!(folder.names(), ["joined.json", "joined.ply", "volume.npy", "whole.ply"]);

    let done = folder.run("mesh volume.npy --axes xyz --chunk 128 -o turned.ply");
    assert_eq!(done.code, 0, "{}", done.err);
    assert_eq!(folder.run("mesh volume.npy --axes xyz -o whole.ply").code, 0);
    let (whole, joined) = (folder.mesh("whole.ply"), folder.mesh("turned.ply"));
    assert!(triangles(&whole) == triangles(&joined), "the triangles differ along z");

    let done = folder.run("mesh volume.npy --chunk 128 -o parts");
    assert_eq!(done.code, 0, "{}", done.err);
    let mut parts = Vec::new();
    for entry in fs::read_dir(folder.path("parts")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        parts.extend(triangles(&folder.mesh(&format!("parts/{name}"))));
    }
    parts.sort_unstable();
    assert!(parts == expected, "the parts differ");
}

/// Killed three times, in another stage each, with files cut off and rests of writers; what comes out is the
/// same, byte for byte.
#[test]
fn what_was_broken_off_is_continued() {
    let folder = gyroid();
    let call = "mesh volume.npy --chunk 128 -o out.ply";
    assert_eq!(folder.run(call).code, 0);
    let expected = folder.bytes("out.ply");
    let work = folder.path("out.ply.chunks");
    assert!(!work.exists());
    for killed in 0..3 {
        let mut child = command(&folder.path(""), call).spawn().unwrap();
        let made = |prefix: &str| {
            let found = fs::read_dir(&work).map(|entries| {
                entries.flatten().any(|e| e.file_name().to_string_lossy().starts_with(prefix))
            });
            found.unwrap_or(false)
        };
        let until = ["voxels-", "pass0-1", "piece-0"][killed];
        while !made(until) && child.try_wait().unwrap().is_none() {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        fs::write(work.join(".shrouds-abc.part"), "half").unwrap();
        for entry in fs::read_dir(&work).unwrap().flatten() {
            let name = entry.file_name().into_string().unwrap();
            if name.starts_with("pass0-0-1") || name.starts_with("voxels-1-1") {
                let bytes = fs::read(entry.path()).unwrap();
                fs::write(entry.path(), &bytes[..bytes.len() / 2]).unwrap();
            }
        }
    }
    let done = folder.run(call);
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(folder.bytes("out.ply") == expected, "other bytes than without interruption");
    assert!(!work.exists());
}

#[test]
fn other_settings_begin_anew() {
    let folder = gyroid();
    assert_eq!(folder.run("mesh volume.npy --chunk 128 --preset fast -o out.ply").code, 0);
    let fast = folder.bytes("out.ply");
    // What another call left behind.
    let work = folder.path("out.ply.chunks");
    fs::create_dir(&work).unwrap();
    fs::write(work.join("identity"), "another").unwrap();
    fs::write(work.join("voxels-0-0-0.chunk"), "old").unwrap();
    fs::write(work.join("notes.txt"), "not ours").unwrap();
    let done = folder.run("mesh volume.npy --chunk 128 --preset fast -o out.ply");
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(folder.bytes("out.ply") == fast);
    assert_eq!(fs::read(work.join("notes.txt")).unwrap(), b"not ours");
    assert_eq!(fs::read_dir(&work).unwrap().count(), 1);
    // A folder of parts is one of this call alone.
    folder.file("notes.txt", b"");
    fs::create_dir(folder.path("parts")).unwrap();
    fs::write(folder.path("parts/9-9-9.ply"), "old").unwrap();
    let done = folder.run("mesh volume.npy --chunk 128 -o parts");
    assert!(done.code == 1 && done.err.contains("empty"), "{}", done.err);
    assert!(!folder.path("parts.chunks").exists());
}

#[test]
fn what_does_not_go_with_chunks_is_refused() {
    let folder = Folder::with_tori();
    for (options, word) in [
        ("--chunk 100 -o a.ply", "multiple of 128"),
        ("--chunk 128 -o a.stl", ".ply"),
        ("--chunk 128 -o a.ply --preset exact", "preset"),
        ("--chunk 128 -o a.ply --strict", "--strict"),
        ("--chunk 128 -o a.ply --surface dual", "primal"),
        ("--chunk 128 -o a.ply --volume keep", "volume"),
        ("--chunk 128 -o a.ply --crease=6", "crease"),
        ("--chunk 128 -o a.ply --start random:1", "start"),
        ("--chunk 128 -o a.ply --frame index", "--frame"),
        ("--chunk 128 -o a.ply --picture a.png", "--picture"),
    ] {
        let done = folder.run(&format!("mesh volume.npy {options}"));
        assert!(done.code == 2 && done.err.contains(word), "{options}: {}", done.err);
    }
    let done = folder.run("mesh volume.npy --chunk 128 -o a.ply --threshold 5");
    assert!(done.code == 1 && done.err.contains("no surface"), "{}", done.err);
    assert_eq!(folder.names(), ["volume.npy"]);
    let done = folder.run("mesh volume.npy --chunk 128 -o a.ply --json");
    let report: serde_json::Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!((done.code, &report["chunks"]), (0, &json!(1)));
}
