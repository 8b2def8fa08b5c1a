//! Certificates: written, verified from the files, and refused when anything in them is not so.

use std::fs;

use serde_json::{Value, json};
use shrouds::volume::phantom::noise;
use shrouds::{Grid, TriMesh};
use shrouds_io::{MeshOptions, write_mesh};

use crate::common::{Folder, nifti};

/// The linked tori, their mesh and its certificate.
fn certified() -> Folder {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o mesh.ply --quiet");
    folder.succeed("check mesh.ply --volume volume.npy --certificate c.json --quiet");
    folder
}

/// Changes the certificate in one place.
fn forge(folder: &Folder, pointer: &str, value: Value) {
    let mut certificate = folder.json("c.json");
    let place = certificate.pointer_mut(pointer).unwrap_or_else(|| panic!("no {pointer}"));
    assert_ne!(*place, value, "{pointer}");
    *place = value;
    folder.file("forged.json", &serde_json::to_vec(&certificate).unwrap());
}

#[test]
fn a_certificate_has_its_evidence() {
    let folder = certified();
    let certificate = folder.json("c.json");
    assert_eq!(certificate["format"], "shrouds certificate");
    assert_eq!(certificate["schema"], 1);
    assert_eq!(certificate["holds"], true);
    assert_eq!(certificate["mesh"]["file"], "mesh.ply");
    assert_eq!(certificate["volume"]["file"], "volume.npy");
    assert_eq!(certificate["volume"]["dims"], json!([24, 24, 24]));
    let mesh = folder.mesh("mesh.ply");
    let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
    assert_eq!(certificate["mesh"]["vertices"], vertices);
    let properties = certificate["properties"].as_object().unwrap();
    for (name, tested) in [
        ("closed", triangles / 2 * 3),
        ("manifold_edges", triangles / 2 * 3),
        ("oriented", triangles / 2 * 3),
        ("manifold_vertices", vertices),
        ("proper_triangles", triangles),
        ("no_self_intersection", triangles),
        ("separation", 24 * 24 * 24),
        ("winding", 24 * 24 * 24),
        ("network", vertices),
    ] {
        let property = &properties[name];
        assert_eq!(property["holds"], true, "{name}");
        assert_eq!(property["tested"], tested, "{name}");
        assert_eq!((&property["wrong"], &property["first"]), (&json!(0), &json!([])), "{name}");
    }
    assert_eq!(properties["components"], json!({"holds": true, "found": 2, "expected": 2}));
    assert_eq!(properties["euler"]["of_components"], json!([0, 0]));
    // No vertex comes nearer to a lattice point than .002, and one lies on an edge to one.
    let margin = properties["separation"]["nearest"]["distance"].as_f64().unwrap();
    assert!(margin > 0.001 && margin < 0.5, "{margin}");
    let told = folder.succeed("check c.json");
    assert!(told.lines().all(|line| line.starts_with("ok  ")), "{told}");
    for part in
        ["mesh.sha256", "volume.reading", "settings.faces", "properties.separation", "holds"]
    {
        assert!(told.contains(part), "{part}: {told}");
    }
    let verdict: Value = serde_json::from_str(&folder.succeed("check c.json --json")).unwrap();
    assert_eq!((&verdict["agrees"], &verdict["holds"]), (&json!(true), &json!(true)));
}

#[test]
fn certificates_are_the_same_bytes_whoever_writes_them() {
    let folder = certified();
    let first = folder.bytes("c.json");
    let check = "check mesh.ply --volume volume.npy --quiet";
    folder.succeed(&format!("{check} --certificate c.json --threads 1"));
    assert_eq!(folder.bytes("c.json"), first);
    folder.succeed("mesh volume.npy -o mesh.ply --certificate c.json --quiet --threads 3");
    assert_eq!(folder.bytes("c.json"), first);
    let text = String::from_utf8(first).unwrap();
    assert!(!text.contains(&folder.path("").display().to_string()), "a path of this machine");
}

#[test]
fn a_forged_field_is_found() {
    let folder = certified();
    for (pointer, value) in [
        ("/mesh/sha256", json!("00")),
        ("/mesh/vertices", json!(7)),
        ("/mesh/triangles", json!(7)),
        ("/volume/sha256", json!("00")),
        ("/volume/dims/1", json!(25)),
        ("/volume/affine/0/3", json!(1e-300)),
        ("/volume/inside", json!(0)),
        ("/volume/selection", json!("label 1")),
        ("/settings/touch", json!(0.1)),
        ("/properties/closed/tested", json!(1)),
        ("/properties/closed/holds", json!(false)),
        ("/properties/separation/wrong", json!(1)),
        ("/properties/separation/axes", json!(3)),
        ("/properties/separation/nearest/distance", json!(0.5)),
        ("/properties/separation/nearest/index/0", json!(1)),
        ("/properties/euler/of_components/0", json!(2)),
        ("/properties/components/expected", Value::Null),
        ("/properties/network", Value::Null),
        ("/properties/no_self_intersection/first", json!([1])),
        ("/holds", json!(false)),
    ] {
        forge(&folder, pointer, value);
        let done = folder.run("check forged.json");
        let name = pointer[1..].replace('/', ".");
        let name = name.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.');
        assert_eq!(done.code, 1, "{pointer}");
        assert!(done.err.contains("forged.json is not true of its files"), "{}", done.err);
        assert!(done.err.contains(name), "{pointer}: {}", done.err);
        let fails = done.out.lines().filter(|line| line.starts_with("FAIL")).count();
        let parts = if pointer == "/properties/network" { 5 } else { 1 };
        assert!((1..=parts).contains(&fails), "{pointer}: {}", done.out);
    }
    // The smallest change of a number there is.
    let nearest = "/properties/separation/nearest/distance";
    let distance = folder.json("c.json").pointer(nearest).unwrap().as_f64().unwrap();
    forge(&folder, nearest, json!(distance.next_up()));
    assert_eq!(folder.run("check forged.json --quiet").code, 1);
    // Something added, something left out.
    let mut certificate = folder.json("c.json");
    certificate["mesh"]["author"] = json!("nobody");
    folder.file("forged.json", &serde_json::to_vec(&certificate).unwrap());
    assert!(folder.run("check forged.json").err.contains("mesh.author"));
    certificate["mesh"].as_object_mut().unwrap().remove("author");
    certificate["properties"].as_object_mut().unwrap().remove("oriented");
    folder.file("forged.json", &serde_json::to_vec(&certificate).unwrap());
    assert!(folder.run("check forged.json").err.contains("properties.oriented"));
    // Another version of the program is no other certificate.
    forge(&folder, "/version", json!("9.9.9"));
    folder.succeed("check forged.json");
}

#[test]
fn other_settings_give_another_verdict() {
    let folder = certified();
    forge(&folder, "/volume/reading/labels", json!(["2"]));
    let done = folder.run("check forged.json");
    assert!(
        done.code == 1 && done.out.contains("FAIL  properties.separation.wrong"),
        "{}",
        done.out
    );
    forge(&folder, "/volume/reading/spacing", json!([1.0, 1.0, 2.0]));
    assert!(folder.run("check forged.json").out.contains("FAIL  volume.affine"));
    forge(&folder, "/settings/frame", json!("index"));
    // Spacing is 1 and the origin 0: the index is the world, and nothing else is wrong.
    folder.succeed("check forged.json");
}

#[test]
fn a_changed_byte_is_found() {
    let folder = certified();
    for (name, part) in [("mesh.ply", "mesh.sha256"), ("volume.npy", "volume.sha256")] {
        let good = folder.bytes(name);
        let mut bytes = good.clone();
        // A vertex in the mesh, a voxel in the volume.
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        folder.file(name, &bytes);
        let done = folder.run("check c.json");
        assert_eq!(done.code, 1, "{name}");
        assert!(done.err.contains(part) || done.err.contains("SHA-256"), "{name}: {}", done.err);
        folder.file(name, &good[..good.len() - 3]);
        let done = folder.run("check c.json");
        assert_eq!(done.code, 1, "{name}");
        folder.file(name, &good);
        folder.succeed("check c.json --quiet");
    }
    // A change that no number shows.
    let mut longer = folder.bytes("mesh.ply");
    let at = longer.windows(7).position(|w| w == b"comment").map_or(4, |at| at);
    longer.splice(at..at, *b"comment a\n");
    folder.file("mesh.ply", &longer);
    let done = folder.run("check c.json");
    assert!(done.err.contains("mesh.sha256 differs;"), "{}", done.err);
    fs::remove_file(folder.path("mesh.ply")).unwrap();
    folder.refuse("check c.json", 1, &["mesh.ply"]);
}

#[test]
fn a_certificate_moves_with_its_files() {
    let folder = Folder::with_tori();
    for name in ["study/scans", "study/surfaces/made", "elsewhere"] {
        fs::create_dir_all(folder.path(name)).unwrap();
    }
    fs::rename(folder.path("volume.npy"), folder.path("study/scans/v.npy")).unwrap();
    folder.succeed("mesh study/scans/v.npy -o study/surfaces/made/m.stl --quiet");
    folder.succeed(
        "check study/surfaces/made/m.stl --volume study/scans/v.npy \
         --certificate study/surfaces/c.json --quiet",
    );
    let certificate = folder.json("study/surfaces/c.json");
    assert_eq!(certificate["mesh"]["file"], "made/m.stl");
    assert_eq!(certificate["volume"]["file"], "../scans/v.npy");
    folder.succeed("check study/surfaces/c.json");
    fs::rename(folder.path("study"), folder.path("elsewhere/moved")).unwrap();
    folder.succeed("check elsewhere/moved/surfaces/c.json");
    let inside = crate::common::command(&folder.path("elsewhere/moved/surfaces"), "check c.json");
    assert!({ inside }.output().unwrap().status.success());
    fs::rename(folder.path("elsewhere/moved/surfaces/c.json"), folder.path("elsewhere/c.json"))
        .unwrap();
    folder.refuse("check elsewhere/c.json", 1, &["made/m.stl"]);
}

#[test]
fn a_wrong_mesh_has_a_true_certificate_that_says_so() {
    let folder = Folder::with_tori();
    folder.succeed("mesh volume.npy -o good.ply --quiet");
    let good = folder.mesh("good.ply");
    let certify = |name: &str, mesh: &TriMesh| {
        write_mesh(folder.path(name), mesh, &MeshOptions::default()).unwrap();
        let call = format!("check {name} --volume volume.npy --certificate c.json --quiet");
        assert_eq!(folder.run(&call).code, 1, "{name}");
        let done = folder.run("check c.json");
        assert!(done.code == 1 && done.err.contains("is true, and says"), "{}", done.err);
        assert!(done.out.lines().all(|line| line.starts_with("ok  ")), "{}", done.out);
        let certificate = folder.json("c.json");
        assert_eq!(certificate["holds"], false);
        certificate["properties"].clone()
    };
    let mut shifted = good.clone();
    shifted.vertices.iter_mut().for_each(|v| v[0] += 1.0);
    let separation = &certify("shifted.ply", &shifted)["separation"];
    let wrong = separation["wrong"].as_u64().unwrap();
    // The voxels whose neighbour before them in x is on the other side.
    let volume = shrouds::volume::phantom::named("tori", 24).unwrap().volume;
    let all = || (0..24 * 24 * 24).map(|n| [n % 24, n / 24 % 24, n / 576]);
    let differs =
        |[i, j, k]: [usize; 3]| volume.get([i, j, k]) != (i > 0 && volume.get([i - 1, j, k]));
    assert_eq!(wrong, all().filter(|&index| differs(index)).count() as u64);
    let first = &separation["first"][0];
    let index: [usize; 3] = serde_json::from_value(first["of"].clone()).unwrap();
    assert!(differs(index));
    assert_eq!(first["inside"], volume.get(index));
    assert_eq!(first["at"], json!(index.map(|x| x as f64)));
    let mut torn = good.clone();
    let [a, b, _] = torn.triangles.pop().unwrap();
    let closed = &certify("torn.ply", &torn)["closed"];
    assert_eq!((&closed["holds"], &closed["wrong"]), (&json!(false), &json!(3)));
    let edges: Vec<Value> =
        closed["first"].as_array().unwrap().iter().map(|place| place["of"].clone()).collect();
    assert!(edges.contains(&json!([a.min(b), a.max(b)])), "{edges:?}");
}

#[test]
fn every_kind_of_mesh_can_be_certified() {
    let folder = Folder::new();
    let rough = noise(&Grid::new([9, 8, 7], [1.0; 3]).unwrap(), 0.35, 4).unwrap();
    folder.volume("rough.npy", &rough);
    for (mesh, check, network) in [
        ("", "", true),
        ("--faces join", "--faces join", true),
        ("--border open", "--border open", true),
        ("--triangles fixed", "--all-axes", true),
        ("--surface dual", "", false),
        ("--spacing 0.1,0.7,3.3", "--spacing 0.1,0.7,3.3", true),
        ("--threshold 0.5 --axes xyz", "--threshold 0.5 --axes xyz", true),
        ("--label 1 --frame index", "--label 1 --frame index", true),
    ] {
        folder.succeed(&format!("mesh rough.npy -o out.obj --quiet {mesh}"));
        folder.succeed(&format!(
            "check out.obj --volume rough.npy --quiet {check} --certificate c.json"
        ));
        folder.succeed("check c.json");
        let certificate = folder.json("c.json");
        assert_eq!(!certificate["properties"]["network"].is_null(), network, "{mesh}");
    }
}

#[test]
fn volumes_of_several_files() {
    let folder = Folder::new();
    let affine = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let ball = |n: usize| {
        let away = [n % 9, n / 9 % 9, n / 81].map(|x| (x as f64 - 4.0).powi(2));
        u8::from(away.iter().sum::<f64>() < 9.0)
    };
    let data: Vec<u8> = (0..729).map(ball).collect();
    // A header of MetaImage with its data, raw voxels with their layout, and one file alone.
    fs::create_dir(folder.path("data")).unwrap();
    folder.file("data/v.raw", &data);
    let header = "ObjectType = Image\nNDims = 3\nDimSize = 9 9 9\nElementType = MET_UCHAR\n\
                  ElementDataFile = data/v.raw\n";
    folder.file("v.mhd", header.as_bytes());
    folder.file("r.raw", &data);
    folder.file("r.json", br#"{"dims": [9, 9, 9], "type": "uint8"}"#);
    folder.file("v.nii", &nifti(&[9, 9, 9], affine, &data));
    for (volume, files, parts) in [
        ("v.mhd", 2, ["data/v.raw", "v.mhd"]),
        ("r.raw", 2, ["r.raw", "r.json"]),
        ("v.nii", 1, ["v.nii", "v.nii"]),
    ] {
        folder.succeed(&format!("mesh {volume} -o m.ply --certificate c.json --quiet"));
        assert_eq!(folder.json("c.json")["volume"]["files"], files, "{volume}");
        folder.succeed("check c.json --quiet");
        for part in parts {
            let good = folder.bytes(part);
            let mut changed = good.clone();
            let (at, bytes): (usize, &[u8]) = match part {
                "v.mhd" => (0, b"Comment = changed\n"),
                "r.json" => (1, b" "),
                // A voxel inside that was not.
                _ => (good.len() - 1, &[1]),
            };
            let end = if bytes == [1] { at + 1 } else { at };
            changed.splice(at..end, bytes.iter().copied());
            folder.file(part, &changed);
            let done = folder.run("check c.json");
            assert!(done.code == 1 && done.err.contains("volume.sha256"), "{part}: {}", done.err);
            folder.file(part, &good);
        }
    }
    folder.succeed("mesh r.raw -o m.ply --raw-dims 9,9,9 --certificate c.json --quiet");
    assert_eq!(folder.json("c.json")["volume"]["files"], 1);
    folder.succeed("check c.json --quiet");
}

#[test]
fn what_is_no_certificate_is_refused() {
    let folder = certified();
    let alone = ["alone"];
    for more in [
        "--volume volume.npy",
        "--faces separate",
        "--border closed",
        "--all-axes",
        "--label 1",
        "--axes xyz",
    ] {
        folder.refuse(&format!("check c.json {more}"), 2, &alone);
    }
    folder.refuse("check mesh.ply", 2, &["--volume"]);
    let done = folder.run("check mesh.ply --certificate d.json");
    assert!(done.code == 2 && done.err.contains("--volume"), "{}", done.err);
    folder.refuse("check mesh.ply --volume volume.npy --certificate mesh.ply", 2, &["mesh.ply"]);
    folder.refuse("check mesh.ply --volume volume.npy --certificate no/c.json", 1, &["no/c.json"]);
    folder.refuse("check missing.json", 1, &["missing.json"]);
    folder.refuse("mesh volume.npy -o m.glb --certificate d.json", 2, &["m.glb", "--certificate"]);
    folder.refuse("mesh volume.npy -o m.ply --certificate m.ply", 2, &["m.ply"]);
    let done = folder.run("mesh volume.npy -o d --labels all --certificate d.json");
    assert!(done.code == 2 && done.err.contains("--certificate"), "{}", done.err);
    for (text, part) in [("{", "JSON"), ("[]", "another kind"), ("{\"format\": 1}", "another kind")]
    {
        folder.file("bad.json", text.as_bytes());
        folder.refuse("check bad.json", 1, &["bad.json", part]);
    }
    for (pointer, value, part) in [
        ("/schema", json!(2), "schema 2"),
        ("/mesh/file", json!(folder.path("mesh.ply")), "relative"),
        ("/mesh/file", json!(7), "damaged"),
        ("/mesh/file", json!("mesh.glb"), "mesh.glb"),
        ("/volume/file", json!("gone.npy"), "gone.npy"),
        ("/settings/border", json!("ajar"), "damaged"),
        ("/volume/reading/level", json!(-1), "damaged"),
        ("/volume/reading/spacing", json!([1.0, -1.0, 1.0]), "as no call can"),
        (
            "/volume/reading/raw",
            json!({"dims": [1, 1, 1], "type": "word", "big_endian": false, "offset": 0}),
            "as no call can",
        ),
    ] {
        forge(&folder, pointer, value);
        folder.refuse("check forged.json", 1, &[part]);
    }
}
